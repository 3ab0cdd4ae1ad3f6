// limn/shared/osd_patch.h against OpenSubdiv's own basis functions, in double: every patch of every shape.
#include <gtest/gtest.h>
#include <opensubdiv/far/patchTableFactory.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>

#include "conformance/osd_refiner.h"
#include "limn/shared/osd_patch.h"
#include "shapes/shapes.h"

namespace limn::test {
namespace {

namespace far = OpenSubdiv::Far;
using EndCap = far::PatchTableFactory::Options::EndCapType;

using shared::Jet;

// The functions of a patch, one for each control vertex; derivatives by the coordinates of the ptex face.
void patch_basis(uint32_t type, uint32_t param, double s, double t, Jet (&basis)[20]) {
    const shared::OsdPlace place = shared::osd_place(shared::osd_is_triangle(type), param, s, t);
    const double u = place.u, v = place.v;
    const uint32_t boundary = shared::osd_param_boundary(param);
    for (int i = 0; i < 16 && type == shared::kOsdRegular; ++i)
        basis[i] = shared::osd_bicubic_jet(shared::osd_bicubic(boundary, u, v), i % 4, i / 4);
    if (type == shared::kOsdLoop) shared::osd_box_spline_basis(boundary, u, v, basis);
    if (type == shared::kOsdQuads || type == shared::kOsdTriangles)
        shared::linear_basis(u, v, type == shared::kOsdTriangles, basis);
    for (int k = 0; k < 4 && type == shared::kOsdGregoryBasis; ++k) {
        Jet corner[5];
        shared::osd_gregory_corner(k, u, v, corner);
        std::copy(corner, corner + 5, basis + 5 * k);
    }
    for (int k = 0; k < 3 && type == shared::kOsdGregoryTriangle; ++k) {
        Jet corner[6];
        shared::osd_gregory_triangle_corner(k, u, v, corner);
        std::copy(corner, corner + 5, basis + 5 * k);
        basis[15 + k] = corner[5];
    }
    for (Jet& j : basis)
        j = {j.f,
             place.first * j.u,
             place.first * j.v,
             place.second * j.uu,
             place.second * j.uv,
             place.second * j.vv};
}

// The largest difference of a weight, derivatives over 2^depth and 4^depth; counts the patches of each type.
double worst_difference(const far::PatchTable& table, bool triangles, std::map<int, size_t>& patches) {
    constexpr double kPlaces[][2] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}, {0.5, 0}, {0.25, 0.375}, {0.125, 0.75}};
    double worst = 0;
    int first = 0;
    for (int array = 0; array < table.GetNumPatchArrays(); ++array) {
        for (int p = 0; p < table.GetNumPatches(array); ++p) {
            far::PatchTable::PatchHandle handle;
            handle.arrayIndex = array;
            handle.patchIndex = first + p;
            const far::PatchParam param = table.GetPatchParam(array, p);
            const int type = table.GetPatchArrayDescriptor(array).GetType();
            ++patches[type];
            for (const auto& place : kPlaces) {
                if (triangles && place[0] + place[1] > 1) continue;
                double s = place[0], t = place[1], theirs[6][20] = {};
                if (triangles)
                    param.UnnormalizeTriangle(s, t);
                else
                    param.Unnormalize(s, t);
                table.EvaluateBasis(handle, s, t, theirs[0], theirs[1], theirs[2], theirs[3], theirs[4],
                                    theirs[5]);
                Jet ours[20] = {};
                patch_basis(static_cast<uint32_t>(type), param.field1, s, t, ours);
                const double d = std::exp2(param.GetDepth()), dd = d * d, units[6] = {1, d, d, dd, dd, dd};
                for (int k = 0; k < 20; ++k) {
                    const double values[6] = {ours[k].f,  ours[k].u,  ours[k].v,
                                              ours[k].uu, ours[k].uv, ours[k].vv};
                    for (int i = 0; i < 6; ++i)
                        worst = std::max(worst, std::abs(values[i] - theirs[i][k]) / units[i]);
                }
            }
        }
        first += table.GetNumPatches(array);
    }
    return worst;
}

TEST(OsdPatch, basis_functions_equal_opensubdivs) {
    std::map<int, size_t> patches;
    for (const TestMesh& mesh : all_shapes()) {
        for (const EndCap cap : {EndCap::ENDCAP_BSPLINE_BASIS, EndCap::ENDCAP_GREGORY_BASIS}) {
            std::string error;
            const auto refiner = make_osd_refiner(mesh, &error);
            ASSERT_NE(refiner, nullptr) << mesh.name << ": " << error;
            far::PatchTableFactory::Options options(3);
            options.SetEndCapType(cap);
            options.SetPatchPrecision<double>();
            if (mesh.options.scheme == Scheme::bilinear)
                refiner->RefineUniform(far::TopologyRefiner::UniformOptions(2));
            else
                refiner->RefineAdaptive(options.GetRefineAdaptiveOptions());
            const std::unique_ptr<far::PatchTable> table(far::PatchTableFactory::Create(*refiner, options));
            ASSERT_NE(table, nullptr) << mesh.name;
            EXPECT_LE(worst_difference(*table, mesh.options.scheme == Scheme::loop, patches), 1e-12)
                << mesh.name;
        }
    }
    for (const int type : {3, 5, 6, 9, 10}) EXPECT_GT(patches[type], 0u) << "patches of type " << type;
    for (const auto& [type, count] : patches) std::printf("type %d: %zu patches\n", type, count);
}

}  // namespace
}  // namespace limn::test
