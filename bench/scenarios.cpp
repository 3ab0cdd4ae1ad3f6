#include "scenarios.h"

#include <algorithm>

namespace limn::bench {

// clang-format off
#define LIMN_BENCH_SCENARIOS(X) \
    X(refine,       "building refined topology and stencil tables") \
    X(patch_table,  "building the limit surface's tables, cold, from a warm cache, and uploaded") \
    X(stencil_eval, "a frame: control points to the points of levels 2 to 6") \
    X(grid_eval,    "a frame: control points to grids of 4x4, 8x8 and 16x16 samples of each face") \
    X(patch_eval,   "a frame: control points to random samples") \
    X(osd_interop,  "a frame: OpenSubdiv's own stencils and patches, by limn::osd and by OpenSubdiv") \
    X(tessellate,   "a frame: control points to vertices, triangles and the draw command") \
    X(latency,      "a cube: control points to a grid of 8x8 samples, from submission to fence") \
    X(edit,         "a crease gets another sharpness: from there to the first frame; tables edited in place") \
    X(load,         "a file, OBJ or baked, to its first frame: opened, built, uploaded, tessellated") \
    X(crowd,        "a thousand different meshes in one batch, beside one mesh as large") \
    X(schemes,      "uniform refinement by every scheme, beside CGAL and OpenMesh") \
    X(crowd_change, "one mesh of a thousand goes and another comes: tables, upload, and a frame after many changes") \
    X(scaling,      "time per face from a thousand faces to four million")
// clang-format on

#define LIMN_BENCH_DECLARE(name, summary) void bench_##name(const Session& session);
LIMN_BENCH_SCENARIOS(LIMN_BENCH_DECLARE)

std::span<const Scenario> scenarios() {
#define LIMN_BENCH_ENTRY(name, summary) {#name, summary, bench_##name},
    static constexpr Scenario kScenarios[] = {LIMN_BENCH_SCENARIOS(LIMN_BENCH_ENTRY)};
    return kScenarios;
}

Result<std::vector<Scenario>> select_scenarios(const std::vector<std::string>& names) {
    for (const std::string& name : names)
        if (std::none_of(scenarios().begin(), scenarios().end(),
                         [&](const Scenario& s) { return s.name == name; }))
            return Error{ErrorCode::invalid_argument,
                         "there is no scenario '" + name + "'; see limn bench --list"};
    std::vector<Scenario> selected;
    for (const Scenario& scenario : scenarios())
        if (names.empty() || std::find(names.begin(), names.end(), scenario.name) != names.end())
            selected.push_back(scenario);
    return selected;
}

}  // namespace limn::bench
