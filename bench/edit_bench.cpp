// From an edit of the topology to its first frame: one crease gets another sharpness, tables are made again
// (limn: with a warm cache of plans), uploaded, and a grid is evaluated. OpenSubdiv's evaluators run on the
// host: nothing is uploaded. And what the tables alone take, edited in place or made again.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "limn/mesh_edit.h"
#include "limn_patches.h"
#include "osd_samples.h"
#include "patch_samples.h"
#include "session.h"

namespace limn::bench {
namespace {

constexpr uint32_t kRate = 7, kIsolationLevel = 3;

/// A mesh whose crease 0 can be edited; one along the first edge where there is none.
BenchModel with_crease(const BenchModel& model) {
    BenchModel edited = model;
    if (edited.mesh.crease_sharpness.empty()) {
        edited.mesh.crease_edges = {edited.mesh.face_vertices[0], edited.mesh.face_vertices[1]};
        edited.mesh.crease_sharpness = {1};
    }
    return edited;
}

Row row_of(const BenchModel& model, const char* task, const char* evaluator, Side side) {
    return {.scenario = "edit",
            .model = model.name,
            .faces = model.mesh.face_count(),
            .parameters = {{"rate", kRate}},
            .task = task,
            .evaluator = evaluator,
            .side = side,
            .items = static_cast<double>(model.mesh.face_count()),
            .unit = "faces"};
}

struct Setup {
    const Session& session;
    const LimnDevice& limn;
    BenchModel model;

    /// The edit itself. `known`: between two values that have been seen before.
    void edit(uint32_t step, bool known) {
        model.mesh.crease_sharpness[0] =
            known ? (step % 2 == 0 ? 1.5f : 2.25f) : 1 + 0.001f * static_cast<float>(step);
    }
};

PatchCandidate make_limn(const Setup& s, const PlanCache& cache) {
    const Options& options = s.session.options;
    const auto table = value_or_fail(options, build_patch_table<float>(s.model.mesh, {}, &cache));
    return value_or_fail(
        options, make_limn_grid_candidate(s.limn, table, s.model.positions, kRate, PatchTask::derivatives));
}

PatchCandidate make_osd(const Setup& s, OsdEvaluator evaluator, std::span<const PatchSample> samples) {
    return make_osd_patch_candidate(evaluator, PatchTask::derivatives,
                                    find_osd_places(s.model.mesh, kIsolationLevel, samples), s.model.positions, 3, 0);
}

void verify(const Setup& s, const Row& row, const PatchCandidate& candidate, const std::vector<double>& points) {
    if (!candidate.frame())
        fail(s.session.options, {ErrorCode::unsupported, row_name(row) + ": cannot be evaluated"});
    const double difference = largest_difference(candidate.values().positions, points);
    const double tolerance = tolerance_for(s.model.positions).in_float;
    if (!(difference <= tolerance))
        fail(s.session.options,
             {ErrorCode::unsupported,
              row_name(row) + format(": positions are %.3g off, more than %.3g", difference, tolerance)});
}

void bench_limn(Setup& s, const char* task, bool known) {
    const Options& options = s.session.options;
    const PlanCache cache;
    Row row = row_of(s.model, task, "limn", Side::limn);
    for (uint32_t step = 0; step < 2; ++step) {  // both values get known
        s.edit(step, true);
        const auto truth = value_or_fail(options, build_patch_table<double>(s.model.mesh, {}));
        verify(s, row, make_limn(s, cache),
               evaluate_samples(truth, grid_samples(truth, kRate), s.model.positions, Derivatives::none));
    }
    uint32_t step = 0;
    row.timing = measure(options, [&] {
        s.edit(step++, known);
        return make_limn(s, cache).frame();
    });
    row.note = "tables, upload, buffers, commands, first frame";
    s.session.report.add(row);
}

void bench_osd(Setup& s, const char* task, OsdEvaluator evaluator, bool known) {
    const Options& options = s.session.options;
    Row row = row_of(s.model, task, evaluator == OsdEvaluator::cpu ? "osd_cpu" : "osd_omp", Side::peer);
    s.edit(0, true);
    const auto truth = value_or_fail(options, build_patch_table<double>(s.model.mesh, {}));
    const auto samples = grid_samples(truth, kRate);
    verify(s, row, make_osd(s, evaluator, samples),
           find_osd_samples(options, s.model, kIsolationLevel, samples).points());
    uint32_t step = 0;
    row.timing = measure(options, [&] {
        s.edit(step++, known);
        return make_osd(s, evaluator, samples).frame();
    });
    row.note = "refiner, patches at level 3, stencils, places, first frame";
    s.session.report.add(row);
}

using Bytes = std::span<const std::byte>;

template <class T>
Bytes bytes_of(const Array<T>& array) {
    return std::as_bytes(std::span(array.data(), array.size()));
}
/// All that is uploaded.
std::vector<Bytes> bytes_of(const PatchTable& p, const TessellationTable& t) {
    return {bytes_of(p.point_runs),
            bytes_of(p.point_indices.words),
            bytes_of(p.point_weights),
            bytes_of(p.surfaces),
            bytes_of(p.ring_points.words),
            bytes_of(p.plans),
            bytes_of(p.plan_nodes),
            bytes_of(p.plan_points),
            bytes_of(p.plan_weights),
            bytes_of(p.ptex_surfaces),
            bytes_of(t.faces),
            bytes_of(t.rows),
            bytes_of(t.corners),
            bytes_of(t.rate_edges),
            bytes_of(t.corner_copies),
            bytes_of(t.row_copies)};
}
/// Of words that are others, or new.
uint64_t changed_bytes(const std::vector<Bytes>& before, const std::vector<Bytes>& after) {
    uint64_t changed = 0;
    for (size_t i = 0; i < after.size(); ++i)
        for (size_t at = 0; at < after[i].size(); at += 4)
            if (at >= before[i].size() || std::memcmp(&before[i][at], &after[i][at], 4) != 0) changed += 4;
    return changed;
}

struct Tables {
    PatchTable patches;
    TessellationTable tessellation;
};
Tables build_tables(const Options& options, const ControlMesh& mesh, const PlanCache& cache) {
    return {value_or_fail(options, build_patch_table<float>(mesh, {}, &cache)),
            value_or_fail(options, build_tessellation_table(mesh, {}))};
}

/// An edit and one that takes it back, by turns.
struct TableEdit {
    const char* task;
    std::function<Result<EditWork>(EditableMesh&, bool back)> apply;
};

/// A smaller face within another, and quads around it; back, they are gone, and the new vertices of no use.
Result<EditWork> edit_inset(EditableMesh& edited, uint32_t face, const std::vector<uint32_t>& outer,
                            uint32_t first_face, uint32_t first_vertex, bool back) {
    const auto size = static_cast<uint32_t>(outer.size());
    std::vector<uint32_t> faces(1, face), sizes(1, size), vertices = outer;
    for (uint32_t i = 0; i < size; ++i) {
        faces.push_back(first_face + i);
        sizes.push_back(back ? 0 : 4);
        if (back) continue;
        const uint32_t next = (i + 1) % size;
        vertices[i] = first_vertex + i;
        vertices.insert(vertices.end(), {outer[i], outer[next], first_vertex + next, first_vertex + i});
    }
    const uint32_t new_vertex_count = first_vertex + size - edited.mesh().vertex_count;
    return edited.edit({.faces = faces,
                        .face_sizes = sizes,
                        .face_vertices = vertices,
                        .new_vertex_count = new_vertex_count});
}

/// In the middle of the mesh.
std::vector<TableEdit> table_edits(const ControlMesh& mesh) {
    const uint32_t face = mesh.face_count() / 2, begin = mesh.face_offsets[face];
    const std::array<uint32_t, 2> edge = {mesh.face_vertices[begin], mesh.face_vertices[begin + 1]};
    const auto crease = [=](const char* task, float from, float to) {
        return TableEdit{
            task, [=](EditableMesh& edited, bool back) {
                const float sharpness = back ? from : to;
                return edited.edit({.crease_vertices = edge, .crease_sharpness = {&sharpness, 1}});
            }};
    };
    const std::vector<uint32_t> outer(mesh.face_vertices.begin() + begin,
                                      mesh.face_vertices.begin() + mesh.face_offsets[face + 1]);
    return {crease("crease_sharpness", 1.5f, 2.25f),
            crease("crease_on_off", 0, 2),
            crease("crease_infinite", 0, kInfiniteSharpness),
            {"face_inset", [=, first_face = mesh.face_count(), first_vertex = mesh.vertex_count](
                               EditableMesh& edited, bool back) {
                 return edit_inset(edited, face, outer, first_face, first_vertex, back);
             }}};
}

/// Makes the edit and takes it back, compared with fresh builds. What it takes, as text.
std::string verify_edit(const Options& options, const Row& row, const TableEdit& edit, const PlanCache& cache,
                        EditableMesh& edited) {
    std::string note;
    for (const bool back : {false, true}) {
        const Tables before = {edited.patches(), edited.tessellation()};
        const EditWork work = value_or_fail(options, edit.apply(edited, back));
        const Tables fresh = build_tables(options, edited.mesh(), cache);
        const auto bytes = bytes_of(edited.patches(), edited.tessellation());
        const auto expected = bytes_of(fresh.patches, fresh.tessellation);
        if (!std::ranges::equal(bytes, expected, [](Bytes a, Bytes b) { return std::ranges::equal(a, b); }))
            fail(options, {ErrorCode::unsupported, row_name(row) + ": not what a fresh build makes"});
        const uint64_t total = fresh.patches.bytes() + fresh.tessellation.bytes();
        note = format("%u faces walked, ", work.face_count) +
               megabytes(changed_bytes(bytes_of(before.patches, before.tessellation), bytes)) + " of " +
               megabytes(total) + " changed";
    }
    return note;
}

void bench_tables(const Session& session, const BenchModel& model, const TableEdit& edit) {
    const Options& options = session.options;
    show_progress(options, "edit " + model.name + " " + edit.task);
    const PlanCache cache;
    EditableMesh edited = value_or_fail(options, EditableMesh::create(model.mesh, {}, &cache));
    Row row = row_of(model, edit.task, "limn", Side::limn);
    row.parameters.clear();
    row.items *= 2;
    row.note = verify_edit(options, row, edit, cache, edited) + "; there and back";
    row.timing = measure(options, [&] { return edit.apply(edited, false) && edit.apply(edited, true); });
    session.report.add(row);
    row.evaluator = "limn_rebuilt";
    row.note = "tables made again, plans known";
    row.timing = measure(options, [&] {
        for (int i = 0; i < 2; ++i) build_tables(options, edited.mesh(), cache);
        return true;
    });
    session.report.add(row);
}

}  // namespace

void bench_edit(const Session& session) {
    const auto evaluator =
        value_or_fail(session.options, vk::SurfaceEvaluator::create(session.machines.device()));
    const LimnDevice limn{session.machines.device(), evaluator, session.machines.copy.device};
    for (const BenchModel& model : session.models)
        for (const auto& [task, known] :
             {std::pair{"known_sharpness", true}, std::pair{"new_sharpness", false}}) {
            show_progress(session.options, "edit " + model.name + " " + task);
            Setup s{session, limn, with_crease(model)};
            bench_limn(s, task, known);
            bench_osd(s, task, OsdEvaluator::cpu, known);
            bench_osd(s, task, OsdEvaluator::omp, known);
        }
    std::vector<BenchModel> models = session.models;
    if (!session.options.quick) {
        models.push_back(make_random_torus(320, 250, 1));
        models.back().name = "torus_105k";
    }
    for (const BenchModel& model : models)
        for (const TableEdit& edit : table_edits(model.mesh)) bench_tables(session, model, edit);
}

}  // namespace limn::bench
