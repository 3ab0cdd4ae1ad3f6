#include <vector>

#include "limn/schemes/schemes.h"

namespace limn {
namespace {

using namespace schemes;

std::vector<SubdivisionScheme> list_schemes() {
    return {
        {.name = "catmark",
         .title = "Catmull-Clark",
         .source = "Catmull and Clark 1978",
         .passes = catmull_clark_passes(),
         .creases = CreaseRules::semi_sharp,
         .patch_rings = 2},
        {.name = "loop",
         .title = "Loop",
         .source = "Loop 1987",
         .passes = loop_passes(),
         .faces = FaceKind::triangles,
         .creases = CreaseRules::semi_sharp,
         .patch_rings = 2},
        {.name = "bilinear",
         .title = "Bilinear",
         .source = "",
         .passes = bilinear_passes(),
         .interpolates = true,
         .creases = CreaseRules::semi_sharp,
         .rings = 1},
        {.name = "linear",
         .title = "Linear",
         .source = "",
         .passes = linear_passes(),
         .faces = FaceKind::triangles,
         .interpolates = true,
         .rings = 1},
        {.name = "doo-sabin",
         .title = "Doo-Sabin",
         .source = "Doo and Sabin 1978",
         .passes = doo_sabin_passes(),
         .dual = true},
        {.name = "sqrt3",
         .title = "sqrt(3)",
         .source = "Kobbelt 2000",
         .passes = sqrt3_passes(),
         .faces = FaceKind::triangles,
         .period = 2},
        {.name = "averaging-2",
         .title = "Averaging, degree 2",
         .source = "Zorin and Schroeder 2001",
         .passes = averaging_passes(2),
         .dual = true},
        {.name = "averaging-3",
         .title = "Averaging, degree 3",
         .source = "Zorin and Schroeder 2001",
         .passes = averaging_passes(3)},
    };
}

}  // namespace

std::span<const SubdivisionScheme> subdivision_schemes() {
    static const std::vector<SubdivisionScheme> schemes = list_schemes();
    return schemes;
}

const SubdivisionScheme* find_subdivision_scheme(std::string_view name) {
    for (const SubdivisionScheme& scheme : subdivision_schemes())
        if (name == scheme.name) return &scheme;
    return nullptr;
}

}  // namespace limn
