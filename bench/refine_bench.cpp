// Building: refined topology and stencil tables, against OpenSubdiv's Far.
#include "limn/refined_grid.h"
#include "limn/stencil_table.h"
#include "osd.h"
#include "session.h"

namespace limn::bench {
namespace {

constexpr uint32_t kLevel = 4;

struct Setup {
    const Options& options;
    const BenchModel& model;
    Report& report;
    OsdMesh osd;
    uint32_t level;
};

/// A row of this model: building takes one thread of OpenSubdiv's.
Row row_of(const Setup& setup, const char* task, Side side) {
    return {.scenario = "refine",
            .model = setup.model.name,
            .faces = setup.model.mesh.face_count(),
            .parameters = {{"level", setup.level}},
            .task = task,
            .evaluator = side == Side::limn ? "limn" : "osd_far",
            .side = side,
            .unit = "rows"};
}

/// "peak 1.05 x" of a table; n/a where the system does not tell.
std::string peak_text(uint64_t peak, uint64_t table) {
    if (peak == 0 || table == 0) return "peak n/a";
    return format("peak %.2f x", static_cast<double>(peak) / static_cast<double>(table));
}

void check(const Setup& setup, const char* what, double difference, double tolerance) {
    if (difference <= tolerance) return;
    fail(setup.options, Error{ErrorCode::unsupported,
                              format("%s: the points of %s differ by %.3g from OpenSubdiv's, more than %.3g",
                                     setup.model.name.c_str(), what, difference, tolerance)});
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
void bench_topology(const Setup& setup) {
    std::optional<Refinement> refinement;
    OsdRefiner refiner;
    Row limn = row_of(setup, "topology", Side::limn), osd = row_of(setup, "topology", Side::peer);
    limn.timing = measure(
        setup.options,
        [&] {
            refinement =
                value_or_fail(setup.options, build_refinement(setup.model.mesh, {.level = setup.level}));
            return true;
        },
        [&] { refinement.reset(); });
    limn.items = osd.items = refinement->last().vertex_count;
    limn.note = "build_refinement";
    setup.report.add(limn);
    osd.timing = measure(
        setup.options, [&] { return (refiner = setup.osd.refine(setup.level)) != nullptr; },
        [&] { refiner.reset(); });
    osd.note = "Create + RefineUniform";
    setup.report.add(osd);
}

/// Adds up rows and bytes of what was built.
uint64_t count_tables(const std::vector<StencilTable>& tables, Row& row) {
    uint64_t bytes = 0;
    for (const StencilTable& table : tables) {
        row.items += table.row_count();
        bytes += table.bytes();
    }
    return bytes;
}

/// Tables of all levels, each over the one before, from refined topology.
void bench_step_tables(const Setup& setup) {
    const auto refinement =
        value_or_fail(setup.options, build_refinement(setup.model.mesh, {.level = setup.level}));
    const OsdRefiner refiner = setup.osd.refine(setup.level);
    std::vector<StencilTable> tables;
    std::optional<OsdTable> table;
    Row limn = row_of(setup, "step_tables", Side::limn), osd = row_of(setup, "step_tables", Side::peer);
    limn.timing = measure(
        setup.options,
        [&] {
            for (uint32_t l = 1; l <= setup.level; ++l)
                tables.push_back(value_or_fail(setup.options, build_step_table<float>(refinement, l)));
            return true;
        },
        [&] { tables.clear(); });
    limn.note = megabytes(count_tables(tables, limn));
    setup.report.add(limn);
    tables.clear();
    osd.timing = measure(
        setup.options,
        [&] { return table = build_osd_table(*refiner, OsdTableKind::all_levels_chained), true; },
        [&] { table.reset(); });
    osd.items = limn.items;
    osd.note = "unfactorized, " + megabytes(table->bytes());
    setup.report.add(osd);
}

/// Tables over the control points, from the control mesh: everything that a program needs.
void bench_composed(const Setup& setup, OsdTableKind kind) {
    const bool all = kind == OsdTableKind::all_levels;
    const char* task = all ? "composed_all_levels" : "composed";
    std::vector<StencilTable> tables;
    OsdRefiner refiner;
    std::optional<OsdTable> table;
    const auto build = [&] {
        const auto base = value_or_fail(setup.options, build_refinement(setup.model.mesh, {.level = 0}));
        for (uint32_t l = all ? 1 : setup.level; l <= setup.level; ++l)
            tables.push_back(value_or_fail(setup.options, build_stencil_table<float>(base, l)));
        return true;
    };
    const auto build_osd = [&] {
        refiner = setup.osd.refine(setup.level);
        table = build_osd_table(*refiner, kind);
        return true;
    };
    const auto reset = [&] {
        tables.clear();
        table.reset();
        refiner.reset();
    };
    Row limn = row_of(setup, task, Side::limn), osd = row_of(setup, task, Side::peer);
    limn.timing = measure(setup.options, build, reset);
    const uint64_t bytes = count_tables(tables, limn);
    reset();
    limn.note = "table " + megabytes(bytes) + ", " + peak_text(peak_memory(build), bytes);
    setup.report.add(limn);
    reset();
    osd.timing = measure(setup.options, build_osd, reset);
    osd.items = limn.items;
    const uint64_t osd_bytes = table->bytes();
    reset();
    osd.note = "table " + megabytes(osd_bytes) + ", " + peak_text(peak_memory(build_osd), osd_bytes);
    setup.report.add(osd);
}

/// The same points without a row for each: what prepare_refined takes, from the control mesh, too.
void bench_refined_grid(const Setup& setup) {
    std::optional<RefinedGridTable> table;
    const auto build = [&] {
        const auto base = value_or_fail(setup.options, build_refinement(setup.model.mesh, {.level = 0}));
        table = value_or_fail(setup.options, build_refined_grid_table(base, {.level = setup.level}));
        return true;
    };
    const auto reset = [&] { table.reset(); };
    Row row = row_of(setup, "composed", Side::limn);
    row.evaluator = "limn_refined_grid";
    row.timing = measure(setup.options, build, reset);
    row.items = table->point_count();
    const uint64_t bytes = table->bytes();
    reset();
    row.note = "table " + megabytes(bytes) + ", " + peak_text(peak_memory(build), bytes);
    setup.report.add(row);
}

void bench_model(const Session& session, const BenchModel& model, uint32_t level) {
    show_progress(session.options, "refine " + model.name);
    const Setup setup{session.options, model, session.report, OsdMesh(model.mesh), level};
    const double difference = verify(setup, level);
    setup.report.add_finding(
        format("refine/%s: %u faces; points at level %u verified, in double within %.1e of the bounding box",
               model.name.c_str(), model.mesh.face_count(), level, difference));
    bench_topology(setup);
    bench_step_tables(setup);
    bench_refined_grid(setup);
    bench_composed(setup, OsdTableKind::last_level);
    if (level > 1) bench_composed(setup, OsdTableKind::all_levels);
}

}  // namespace

void bench_refine(const Session& session) {
    for (const BenchModel& model : session.models) bench_model(session, model, kLevel);
    const bool quick = session.options.quick;
    bench_model(session, make_quads(quick ? "quads_62k" : "quads_1M", quick ? 250 : 1000), 1);
}

}  // namespace limn::bench
