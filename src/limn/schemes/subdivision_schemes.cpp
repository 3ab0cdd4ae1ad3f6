#include <vector>

#include "limn/schemes/schemes.h"

namespace limn {
namespace {

using namespace schemes;

SubdivisionScheme averaging(const char* name, const char* title, uint32_t degree) {
    return {.name = name,
            .title = title,
            .source = "Zorin and Schroeder 2001; boundaries: Lane and Riesenfeld 1980",
            .passes = averaging_passes(degree),
            .dual = degree % 2 == 0,
            .rings = degree / 2 + 1};
}

SubdivisionScheme stam(const char* name, const char* title, uint32_t degree) {
    return {.name = name,
            .title = title,
            .source = "Stam 2001; rules at irregular vertices and boundaries are a reconstruction",
            .passes = stam_passes(degree),
            .dual = degree % 2 == 0,
            .reconstructed = true,
            .rings = degree / 2 + 1};
}

SubdivisionScheme stam_triangles(const char* name, const char* title, uint32_t degree) {
    return {.name = name,
            .title = title,
            .source = "Stam 2001; rules at irregular vertices and boundaries are a reconstruction",
            .passes = stam_triangle_passes(degree),
            .faces = FaceKind::triangles,
            .reconstructed = degree != 4,
            .rings = (degree + 2) / 3};
}

std::vector<SubdivisionScheme> list_schemes() {
    return {
        {.name = "catmark",
         .title = "Catmull-Clark",
         .source = "Catmull and Clark 1978",
         .passes = catmull_clark_passes(),
         .creases = CreaseRules::semi_sharp},
        {.name = "loop",
         .title = "Loop",
         .source = "Loop 1987",
         .passes = loop_passes(),
         .faces = FaceKind::triangles,
         .creases = CreaseRules::semi_sharp},
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
        averaging("averaging-2", "Averaging, degree 2", 2),
        averaging("averaging-3", "Averaging, degree 3", 3),
        averaging("averaging-4", "Averaging, degree 4", 4),
        averaging("averaging-5", "Averaging, degree 5", 5),
        averaging("averaging-6", "Averaging, degree 6", 6),
        averaging("averaging-7", "Averaging, degree 7", 7),
        averaging("averaging-8", "Averaging, degree 8", 8),
        averaging("averaging-9", "Averaging, degree 9", 9),
        stam("stam-4", "Stam, degree 4", 4),
        stam("stam-5", "Stam, degree 5", 5),
        stam("stam-6", "Stam, degree 6", 6),
        stam("stam-7", "Stam, degree 7", 7),
        stam("stam-8", "Stam, degree 8", 8),
        stam("stam-9", "Stam, degree 9", 9),
        stam_triangles("stam-triangles-4", "Stam, triangles, degree 4", 4),
        stam_triangles("stam-triangles-7", "Stam, triangles, degree 7", 7),
        stam_triangles("stam-triangles-10", "Stam, triangles, degree 10", 10),
        {.name = "kobbelt",
         .title = "Kobbelt, interpolatory",
         .source = "Kobbelt 1996; boundaries and which direction's face point counts are a reconstruction",
         .passes = kobbelt_passes(),
         .faces = FaceKind::quads,
         .interpolates = true,
         .reconstructed = true,
         .rings = 4},
        {.name = "sabin",
         .title = "Sabin, bounded curvature",
         .source = "Sabin 1991; Levin 2000",
         .passes = sabin_passes()},
        {.name = "push-back-catmark",
         .title = "Catmull-Clark, pushed back",
         .source = "Maillot and Stam 2001; Lin, Luo, You and Li 2008, whose reading is a reconstruction",
         .passes = push_back_catmull_clark_passes(),
         .interpolates = true,
         .reconstructed = true,
         .rings = 4},
        {.name = "push-back-loop",
         .title = "Loop, pushed back",
         .source = "Maillot and Stam 2001; Lin, Luo, You and Li 2008, whose reading is a reconstruction",
         .passes = push_back_loop_passes(),
         .faces = FaceKind::triangles,
         .interpolates = true,
         .reconstructed = true,
         .rings = 4},
        {.name = "catmark-blz",
         .title = "Catmull-Clark, smooth up to boundaries",
         .source =
             "Biermann, Levin and Zorin 2000; concave corners' flatness is a reconstruction, normals are left out",
         .passes = catmull_clark_blz_passes(),
         .reconstructed = true,
         .creases = CreaseRules::semi_sharp},
        {.name = "loop-blz",
         .title = "Loop, smooth up to boundaries",
         .source =
             "Biermann, Levin and Zorin 2000; concave corners' flatness is a reconstruction, normals are left out",
         .passes = loop_blz_passes(),
         .faces = FaceKind::triangles,
         .reconstructed = true,
         .creases = CreaseRules::semi_sharp},
        {.name = "catmark-g2",
         .title = "Catmull-Clark, G2",
         .source = "Prautzsch and Umlauf 1998, by construction: coefficients are not theirs",
         .passes = catmull_clark_g2_passes(),
         .reconstructed = true,
         .rings = 3},
        {.name = "loop-g2",
         .title = "Loop, G2",
         .source = "Prautzsch and Umlauf 1998, 2000, by construction: coefficients are not theirs",
         .passes = loop_g2_passes(),
         .faces = FaceKind::triangles,
         .reconstructed = true,
         .rings = 3},
        {.name = "butterfly-g1",
         .title = "Butterfly, eight points, G1",
         .source =
             "Dyn, Levin and Gregory 1990; Prautzsch and Umlauf 2000, by construction: coefficients are not theirs",
         .passes = butterfly_g1_passes(),
         .faces = FaceKind::triangles,
         .interpolates = true,
         .reconstructed = true,
         .rings = 4},
        {.name = "nurss",
         .title = "NURSS, cubic",
         .source = "Sederberg, Zheng, Sewell and Sabin 1998; boundaries and unlike intervals of opposite edges are a "
                   "reconstruction",
         .passes = nurss_passes(),
         .reconstructed = true},
        {.name = "nurss-quadratic",
         .title = "NURSS, quadratic",
         .source =
             "Sederberg, Zheng, Sewell and Sabin 1998; faces that are no quads and boundaries are a reconstruction",
         .passes = nurss_quadratic_passes(),
         .dual = true,
         .reconstructed = true},
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
