// Building: refined topology and stencil tables, against OpenSubdiv's Far.
#include <algorithm>
#include <cstdio>

#include "bench.h"
#include "limn/stencil_table.h"
#include "models.h"
#include "osd.h"

namespace limn::bench {
namespace {

constexpr uint32_t kLevel = 4;

struct Setup {
    const Options& options;
    const BenchModel& model;
    Report& report;
    OsdMesh osd;
    std::string prefix;
};

std::string megabytes(uint64_t bytes) {
    char text[32];
    std::snprintf(text, sizeof text, "%.1f MB", static_cast<double>(bytes) / 1e6);
    return text;
}

/// "peak 1.05 x" of a table; n/a where the system does not tell.
std::string peak_text(uint64_t peak, uint64_t table) {
    char text[32] = "peak n/a";
    if (peak != 0 && table != 0)
        std::snprintf(text, sizeof text, "peak %.2f x",
                      static_cast<double>(peak) / static_cast<double>(table));
    return text;
}

void check(const Setup& setup, const char* what, double difference, double tolerance) {
    if (difference <= tolerance) return;
    char text[160];
    std::snprintf(text, sizeof text, "%s: the points of %s differ by %.3g from OpenSubdiv's, more than %.3g",
                  setup.model.name.c_str(), what, difference, tolerance);
    fail(setup.options, Error{ErrorCode::unsupported, text});
}

template <class Real>
std::vector<Real> points_of(const BasicStencilTable<Real>& table, const std::vector<Real>& source) {
    std::vector<Real> destination(size_t{3} * table.row_count());
    apply_stencil_table<Real>(table, source, destination, 3);
    return destination;
}

/// Tables in double and in float, composed and level by level, give the points that OpenSubdiv gives in
/// double. Returns how far composed points in double are, as a share of the mesh.
double verify(const Setup& setup, uint32_t level) {
    const Tolerance tolerance = tolerance_for(setup.model.positions);
    const OsdRefiner refiner = setup.osd.refine(level);
    if (!refiner)
        fail(setup.options,
             Error{ErrorCode::unsupported, setup.model.name + ": OpenSubdiv refuses this mesh"});
    const std::vector<double> truth = osd_points(*refiner, setup.model.positions);
    const auto refinement =
        value_or_fail(setup.options, build_refinement(setup.model.mesh, {.level = level}));
    std::vector<double> points(setup.model.positions.begin(), setup.model.positions.end());
    const double composed = largest_difference(
        points_of(value_or_fail(setup.options, build_stencil_table<double>(refinement, level)), points),
        truth);
    check(setup, "the composed table", composed, tolerance.in_double);
    check(setup, "the composed table in float",
          largest_difference(
              points_of(value_or_fail(setup.options, build_stencil_table<float>(refinement, level)),
                        setup.model.positions),
              truth),
          tolerance.in_float);
    for (uint32_t l = 1; l <= level; ++l)
        points = points_of(value_or_fail(setup.options, build_step_table<double>(refinement, l)), points);
    check(setup, "the step tables", largest_difference(points, truth), tolerance.in_double);
    return composed / tolerance.in_double * 1e-12;
}

/// Topology of all levels, from the control mesh.
void bench_topology(const Setup& setup, uint32_t level) {
    std::optional<Refinement> refinement;
    OsdRefiner refiner;
    Row row{.name = setup.prefix + "topology"};
    row.limn = measure(
        setup.options,
        [&] {
            refinement = value_or_fail(setup.options, build_refinement(setup.model.mesh, {.level = level}));
            return true;
        },
        [&] { refinement.reset(); });
    row.items = refinement->last().vertex_count;
    row.peer = measure(
        setup.options, [&] { return (refiner = setup.osd.refine(level)) != nullptr; },
        [&] { refiner.reset(); });
    row.note = "build_refinement / Create + RefineUniform";
    setup.report.add(row);
}

/// Tables of all levels, each over the one before, from refined topology.
void bench_step_tables(const Setup& setup, uint32_t level) {
    const auto refinement =
        value_or_fail(setup.options, build_refinement(setup.model.mesh, {.level = level}));
    const OsdRefiner refiner = setup.osd.refine(level);
    std::vector<StencilTable> tables;
    std::optional<OsdTable> osd;
    Row row{.name = setup.prefix + "step_tables"};
    row.limn = measure(
        setup.options,
        [&] {
            for (uint32_t l = 1; l <= level; ++l)
                tables.push_back(value_or_fail(setup.options, build_step_table<float>(refinement, l)));
            return true;
        },
        [&] { tables.clear(); });
    uint64_t bytes = 0;
    for (const StencilTable& table : tables) {
        row.items += table.row_count();
        row.entries += static_cast<double>(table.weights.size());
        bytes += table.bytes();
    }
    tables.clear();
    row.peer = measure(
        setup.options,
        [&] {
            osd = build_osd_table(*refiner, OsdTableKind::all_levels_chained);
            return true;
        },
        [&] { osd.reset(); });
    row.note = "build_step_table, " + megabytes(bytes) + " / unfactorized, " + megabytes(osd->bytes());
    setup.report.add(row);
}

/// Tables over the control points, from the control mesh: everything that a program needs.
void bench_composed(const Setup& setup, uint32_t level, OsdTableKind kind) {
    const bool all = kind == OsdTableKind::all_levels;
    std::vector<StencilTable> tables;
    OsdRefiner refiner;
    std::optional<OsdTable> osd;
    const auto build = [&] {
        const auto base = value_or_fail(setup.options, build_refinement(setup.model.mesh, {.level = 0}));
        for (uint32_t l = all ? 1 : level; l <= level; ++l)
            tables.push_back(value_or_fail(setup.options, build_stencil_table<float>(base, l)));
        return true;
    };
    const auto reset = [&] {
        tables.clear();
        osd.reset();
        refiner.reset();
    };
    const auto build_osd = [&] {
        refiner = setup.osd.refine(level);
        osd = build_osd_table(*refiner, kind);
        return true;
    };
    Row row{.name = setup.prefix + (all ? "composed_all_levels" : "composed")};
    row.limn = measure(setup.options, build, reset);
    uint64_t bytes = 0;
    for (const StencilTable& table : tables) {
        row.items += table.row_count();
        row.entries += static_cast<double>(table.weights.size());
        bytes += table.bytes();
    }
    reset();
    const uint64_t peak = peak_memory(build);
    reset();
    row.peer = measure(setup.options, build_osd, reset);
    const uint64_t osd_bytes = osd->bytes();
    reset();
    const uint64_t osd_peak = peak_memory(build_osd);
    reset();
    row.note = "table " + megabytes(bytes) + ", " + peak_text(peak, bytes) + " / " + megabytes(osd_bytes) +
               ", " + peak_text(osd_peak, osd_bytes);
    setup.report.add(row);
}

void bench_model(const Options& options, const BenchModel& model, Report& report, uint32_t level) {
    const Setup setup{options, model, report, OsdMesh(model.mesh),
                      "refine/" + model.name + "/level=" + std::to_string(level) + "/"};
    char text[160];
    std::snprintf(text, sizeof text,
                  "%s: %u faces; points verified, in double within %.1e of the bounding box",
                  model.name.c_str(), model.mesh.face_count(), verify(setup, level));
    report.add_text(text);
    bench_topology(setup, level);
    bench_step_tables(setup, level);
    bench_composed(setup, level, OsdTableKind::last_level);
    if (level > 1) bench_composed(setup, level, OsdTableKind::all_levels);
}

}  // namespace
}  // namespace limn::bench

int main(int argc, char** argv) {
    using namespace limn::bench;
    const Options options = parse_options(argc, argv, 0, 0);
    const std::vector<BenchModel> models = load_models(options);
    Report report(options, "refine", {{"peer", "OpenSubdiv Far, which uses one thread"}});
    for (const BenchModel& model : models) bench_model(options, model, report, kLevel);
    bench_model(options, make_million_quads(), report, 1);
    value_or_fail(options, report.finish());
    return 0;
}
