#include "conformance/osd_patch_oracle.h"

#include <opensubdiv/bfr/refinerSurfaceFactory.h>
#include <opensubdiv/bfr/surface.h>
#include <opensubdiv/far/patchMap.h>
#include <opensubdiv/far/patchTableFactory.h>
#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/ptexIndices.h>
#include <opensubdiv/far/stencilTable.h>

#include <algorithm>
#include <cmath>

#include "conformance/osd_refiner.h"

namespace osd = OpenSubdiv;

namespace limn::test {
namespace {

using Refiner = osd::Far::TopologyRefiner;
using Values = std::array<std::array<double, 3>, 6>;

// The element type that OpenSubdiv's templates want.
struct Point {
    std::array<double, 3> x{};
    void Clear() { x = {}; }
    void AddWithWeight(const Point& other, double weight) {
        for (size_t i = 0; i < 3; ++i) x[i] += weight * other.x[i];
    }
};

// In a face that is not a quad, OpenSubdiv's u and v go from 0 to 1/2 over a ptex face, as they do over a
// level-1 quadrant of a quad.
void halve_parameters(Values& values) {
    for (size_t k = 1; k < 6; ++k)
        for (double& x : values[k]) x *= k < 3 ? 0.5 : 0.25;
}

double distance(const std::array<double, 3>& a, const std::array<double, 3>& b) {
    return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

}  // namespace

struct OsdPatchOracle::Data {
    std::unique_ptr<Refiner> base, refiner;  // as it came, and refined adaptively
    std::unique_ptr<osd::Far::PatchTable> patches;
    std::unique_ptr<osd::Far::PatchMap> map;
    bool triangles = false;
    // Of each ptex face: the base face, and which of its sub-faces.
    std::vector<std::pair<int, int>> ptex_faces;

    std::vector<Point> patch_points(std::span<const double> control_points) const;
    Values evaluate(const osd::Far::PatchTable::PatchHandle& handle, double u, double v,
                    std::span<const Point> points) const;
    double cap_size(const osd::Far::PatchTable::PatchHandle& handle, std::span<const Point> points) const;
};

std::vector<Point> OsdPatchOracle::Data::patch_points(std::span<const double> control_points) const {
    const osd::Far::PrimvarRefinerReal<double> primvar(*refiner);
    const auto total = static_cast<size_t>(refiner->GetNumVerticesTotal());
    std::vector<Point> points(total + static_cast<size_t>(patches->GetNumLocalPoints()));
    for (size_t i = 0; i < control_points.size(); ++i) points[i / 3].x[i % 3] = control_points[i];
    Point* source = points.data();
    for (int level = 1; level <= refiner->GetMaxLevel(); ++level) {
        Point* target = source + refiner->GetLevel(level - 1).GetNumVertices();
        primvar.Interpolate(level, source, target);
        source = target;
    }
    if (const auto* local = patches->GetLocalPointStencilTable<double>())
        local->UpdateValues(points.data(), points.data() + total);
    return points;
}

Values OsdPatchOracle::Data::evaluate(const osd::Far::PatchTable::PatchHandle& handle, double u, double v,
                                      std::span<const Point> points) const {
    double weights[6][20];
    patches->EvaluateBasis(handle, u, v, weights[0], weights[1], weights[2], weights[3], weights[4],
                           weights[5]);
    const osd::Far::ConstIndexArray indices = patches->GetPatchVertices(handle);
    Values values{};
    for (size_t k = 0; k < 6; ++k)
        for (int i = 0; i < indices.size(); ++i)
            for (size_t axis = 0; axis < 3; ++axis)
                values[k][axis] += weights[k][i] * points[static_cast<size_t>(indices[i])].x[axis];
    return values;
}

double OsdPatchOracle::Data::cap_size(const osd::Far::PatchTable::PatchHandle& handle,
                                      std::span<const Point> points) const {
    const osd::Far::PatchParam param = patches->GetPatchParam(handle);
    constexpr double kCorners[4][2] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}};
    std::vector<std::array<double, 3>> corners;
    for (size_t k = 0; k < (triangles ? 3u : 4u); ++k) {
        double u = kCorners[k][0], v = kCorners[k][1];
        if (triangles)
            param.UnnormalizeTriangle(u, v);
        else
            param.Unnormalize(u, v);
        corners.push_back(evaluate(handle, u, v, points)[0]);
    }
    double size = 0;
    for (const auto& a : corners)
        for (const auto& b : corners) size = std::max(size, distance(a, b));
    return size;
}

OsdPatchOracle::OsdPatchOracle(std::unique_ptr<Data> data) : data_(std::move(data)) {}
OsdPatchOracle::~OsdPatchOracle() = default;

std::unique_ptr<OsdPatchOracle> OsdPatchOracle::create(const TestMesh& mesh, uint32_t level,
                                                       std::string* error) {
    auto data = std::make_unique<Data>();
    data->base = make_osd_refiner(mesh, error);
    data->refiner = make_osd_refiner(mesh, error);
    if (!data->base || !data->refiner) return nullptr;
    data->triangles = mesh.options.scheme == Scheme::loop;
    osd::Far::PatchTableFactory::Options options(level);
    options.useInfSharpPatch = true;
    options.generateLegacySharpCornerPatches = false;
    options.SetEndCapType(osd::Far::PatchTableFactory::Options::ENDCAP_GREGORY_BASIS);
    options.SetPatchPrecision<double>();
    data->refiner->RefineAdaptive(options.GetRefineAdaptiveOptions());
    data->patches.reset(osd::Far::PatchTableFactory::Create(*data->refiner, options));
    if (!data->patches || !osd_is_content(error)) return nullptr;
    data->map = std::make_unique<osd::Far::PatchMap>(*data->patches);
    const osd::Far::TopologyLevel& base = data->base->GetLevel(0);
    for (int f = 0; f < base.GetNumFaces(); ++f) {
        const int size = base.GetFaceVertices(f).size(), own_size = data->triangles ? 3 : 4;
        for (int i = 0; i < (size == own_size ? 1 : size); ++i) data->ptex_faces.push_back({f, i});
    }
    return std::unique_ptr<OsdPatchOracle>(new OsdPatchOracle(std::move(data)));
}

uint32_t OsdPatchOracle::ptex_face_count() const {
    return static_cast<uint32_t>(osd::Far::PtexIndices(*data_->base).GetNumFaces());
}

std::vector<OsdPlace> OsdPatchOracle::far_places(std::span<const double> control_points,
                                                 std::span<const PatchSample> samples) const {
    using Descriptor = osd::Far::PatchDescriptor;
    const std::vector<Point> points = data_->patch_points(control_points);
    std::vector<OsdPlace> places(samples.size());
    for (size_t s = 0; s < samples.size(); ++s) {
        const auto& [face, u, v] = samples[s];
        const auto* handle = data_->map->FindPatch(static_cast<int>(face), u, v);
        if (handle == nullptr) continue;
        OsdPlace& place = places[s];
        const Descriptor::Type type = data_->patches->GetPatchDescriptor(*handle).GetType();
        const osd::Far::PatchParam param = data_->patches->GetPatchParam(*handle);
        place.valid = true;
        place.regular = type != Descriptor::GREGORY_BASIS && type != Descriptor::GREGORY_TRIANGLE;
        place.depth = param.GetDepth() - (param.NonQuadRoot() ? 1u : 0u);
        place.values = data_->evaluate(*handle, u, v, points);
        if (param.NonQuadRoot()) halve_parameters(place.values);
        place.turned = data_->triangles && param.IsTriangleRotated();
        if (!place.regular) place.cap_size = data_->cap_size(*handle, points);
    }
    return places;
}

std::vector<OsdPlace> OsdPatchOracle::bfr_places(std::span<const double> control_points, uint32_t level,
                                                 std::span<const PatchSample> samples) const {
    osd::Bfr::SurfaceFactory::Options options;
    options.SetApproxLevelSmooth(static_cast<int>(level)).SetApproxLevelSharp(static_cast<int>(level));
    const osd::Bfr::RefinerSurfaceFactory<> factory(*data_->base, options);
    osd::Bfr::Surface<double> surface;
    std::vector<double> points;
    int prepared = -1;
    std::vector<OsdPlace> places(samples.size());
    for (size_t s = 0; s < samples.size(); ++s) {
        if (samples[s].face >= data_->ptex_faces.size()) continue;
        const auto [face, sub_face] = data_->ptex_faces[samples[s].face];
        if (face != prepared) {
            factory.InitVertexSurface(face, &surface);
            prepared = face;
            if (surface.IsValid()) {
                points.resize(3 * static_cast<size_t>(surface.GetNumPatchPoints()));
                surface.PreparePatchPoints(control_points.data(), 3, points.data(), 3);
            }
        }
        if (!surface.IsValid()) continue;
        OsdPlace& place = places[s];
        place.valid = true;
        place.regular = surface.IsRegular();
        const osd::Bfr::Parameterization parameterization = surface.GetParameterization();
        double uv[2] = {samples[s].u, samples[s].v};
        const bool has_sub_faces = parameterization.HasSubFaces();
        if (has_sub_faces) {
            const double within[2] = {samples[s].u, samples[s].v};
            parameterization.ConvertNormalizedSubFaceToCoord(sub_face, within, uv);
        }
        surface.Evaluate(uv, points.data(), 3, place.values[0].data(), place.values[1].data(),
                         place.values[2].data());
        if (has_sub_faces) halve_parameters(place.values);
    }
    return places;
}

}  // namespace limn::test
