#include "limn/curvature.h"

#include <cassert>

#include "limn/shared/curvature.h"

namespace limn {
namespace {

using shared::Jet;
using shared::SurfaceVector;

Curvature curvature_of(const Jet (&p)[3]) {
    const auto vector = [&](double Jet::*part) {
        return shared::make_vector(p[0].*part, p[1].*part, p[2].*part);
    };
    const shared::PointCurvature at = shared::curvature_of(vector(&Jet::u), vector(&Jet::v), vector(&Jet::uu),
                                                           vector(&Jet::uv), vector(&Jet::vv));
    const SurfaceVector &a = at.first_direction, &b = at.second_direction;
    return {at.gaussian, at.mean, at.first, at.second, {a.x, a.y, a.z}, {b.x, b.y, b.z}};
}

}  // namespace

void evaluate_curvature(std::span<const double> values, uint32_t width, std::span<Curvature> curvatures) {
    assert((width == 3 || width == 4) && values.size() >= curvatures.size() * 6 * width);
    for (size_t s = 0; s < curvatures.size(); ++s) {
        const double* v = values.data() + s * 6 * width;
        const auto jet = [&](uint32_t i) {
            return shared::make_jet(v[i], v[width + i], v[2 * width + i], v[3 * width + i], v[4 * width + i],
                                    v[5 * width + i]);
        };
        Jet point[3] = {jet(0), jet(1), jet(2)};
        for (Jet& component : point)
            if (width == 4) component = v[3] != 0 ? shared::jet_div(component, jet(3)) : Jet{};
        curvatures[s] = curvature_of(point);
    }
}

}  // namespace limn
