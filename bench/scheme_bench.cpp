// Uniform refinement by every scheme to about a million faces: building its tables, a frame, and all from the control
// mesh to points on the device; CGAL and OpenMesh refine the same mesh where they have the scheme.
#include <algorithm>
#include <cmath>
#include <optional>

#include "limn/schemes/scheme_refinement.h"
#include "limn_stencils.h"
#include "session.h"
#ifdef LIMN_HAVE_SCHEME_PEERS
#include "scheme_peers.h"
#endif

namespace limn::bench {
namespace {

constexpr uint32_t kFaces = 1'000'000, kQuickFaces = 20'000, kModelFaces = 1000;
constexpr Repetitions kRepetitions{3, 100, 0.5};
constexpr uint32_t kWidth = 3;

struct Setup {
    const Session& session;
    const vk::Evaluator& evaluator;
    const SubdivisionScheme& scheme;
    const BenchModel& model;
    uint32_t level = 0;
    double face_count = 0;  ///< of that level

    const Options& options() const { return session.options; }
    SchemeRefinement build() const {
        return value_or_fail(options(), build_scheme_refinement<float>(model.mesh, scheme, {level}));
    }
    Row row_of(const char* task, const char* evaluator_name, Side side, const Timing& timing) const {
        return {.scenario = "schemes",
                .model = model.name,
                .faces = model.mesh.face_count(),
                .parameters = {{"level", level}},
                .task = std::string(scheme.name) + "/" + task,
                .evaluator = evaluator_name,
                .side = side,
                .timing = timing,
                .items = face_count,
                .unit = "faces"};
    }
    [[noreturn]] void fail_verification(const char* what, double difference) const {
        fail(options(), {ErrorCode::unsupported,
                         format("schemes/%s: the points of %s are %.3g off", scheme.name, what, difference)});
    }
};

/// Each quad becomes two triangles.
BenchModel triangulated(const BenchModel& quads) {
    std::vector<uint32_t> vertices;
    for (uint32_t f = 0; f < quads.mesh.face_count(); ++f)
        for (uint32_t c = quads.mesh.face_offsets[f] + 2; c < quads.mesh.face_offsets[f + 1]; ++c)
            for (const uint32_t corner : {quads.mesh.face_offsets[f], c - 1, c})
                vertices.push_back(quads.mesh.face_vertices[corner]);
    BenchModel triangles{quads.name + "_triangles", quads.mesh, quads.positions};
    triangles.mesh.face_offsets.clear();
    for (uint32_t c = 0; c <= vertices.size(); c += 3) triangles.mesh.face_offsets.push_back(c);
    triangles.mesh.face_vertices = std::move(vertices);
    return triangles;
}

/// The level whose number of faces is nearest to `target`, and that number: it grows by the same factor each step.
void choose_level(Setup& setup, uint32_t target) {
    double faces[2];
    for (uint32_t i = 0; i < 2; ++i) {
        const auto refined =
            value_or_fail(setup.options(), build_scheme_refinement<float>(setup.model.mesh, setup.scheme, {i + 1}));
        faces[i] = refined.mesh().face_count;
    }
    const double steps = std::log(target / faces[0]) / std::log(faces[1] / faces[0]);
    setup.level = 1 + static_cast<uint32_t>(std::max(0.0, std::round(steps)));
}

std::vector<double> points_in_double(const Setup& setup) {
    const auto refined =
        value_or_fail(setup.options(), build_scheme_refinement<double>(setup.model.mesh, setup.scheme, {setup.level}));
    std::vector<double> points(setup.model.positions.begin(), setup.model.positions.end());
    for (const StencilTableDouble& table : refined.tables) {
        std::vector<double> next(size_t{3} * table.row_count());
        apply_stencil_table<double>(table, points, next, 3);
        points = std::move(next);
    }
    return points;
}

#ifdef LIMN_HAVE_SCHEME_PEERS
/// How far two sets of points are apart at least, whatever their order: by coordinates, and across them.
double set_difference(const std::vector<double>& a, const std::vector<double>& b) {
    constexpr double directions[][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.48, 0.6, 0.64}, {0.64, -0.48, 0.6}};
    const auto along = [](const std::vector<double>& points, const double* d) {
        std::vector<double> values;
        for (size_t i = 0; i < points.size(); i += 3)
            values.push_back(points[i] * d[0] + points[i + 1] * d[1] + points[i + 2] * d[2]);
        std::sort(values.begin(), values.end());
        return values;
    };
    double worst = 0;
    for (const auto& d : directions) worst = std::max(worst, largest_difference(along(a, d), along(b, d)));
    return worst;
}

/// The time of the library's whole refinement, once its points are known to be limn's.
Timing time_peer(const Setup& setup, const peers::PeerScheme& peer, const std::vector<double>& truth) {
    peers::PolygonMesh mesh;
    mesh.points.assign(setup.model.positions.begin(), setup.model.positions.end());
    mesh.face_vertices = setup.model.mesh.face_vertices;
    for (uint32_t f = 0; f < setup.model.mesh.face_count(); ++f)
        mesh.face_sizes.push_back(setup.model.mesh.face_offsets[f + 1] - setup.model.mesh.face_offsets[f]);
    double milliseconds = 0;
    const double difference = set_difference(peer.refine(mesh, setup.level, &milliseconds).points, truth);
    if (!(difference <= tolerance_for(setup.model.positions).in_double))
        setup.fail_verification(peer.method, difference);
    setup.session.report.add_finding(format("schemes/%s: %s makes the same points, within %.1e of the size",
                                            setup.scheme.name, peer.method,
                                            difference / tolerance_for(setup.model.positions).size));
    std::vector<double> times;
    for (uint32_t i = 0; i < (setup.options().quick ? 1 : kRepetitions.min); ++i) {
        peer.refine(mesh, setup.level, &milliseconds);
        times.push_back(milliseconds);
    }
    return timing_of(std::move(times));
}

void add_peers(const Setup& setup, const std::vector<double>& truth) {
    for (const peers::Library& library : {peers::cgal_schemes(), peers::openmesh_schemes()}) {
        std::optional<Timing> best;
        std::string method;
        for (const peers::PeerScheme& peer : library.schemes) {
            if (std::string_view(peer.name) != setup.scheme.name) continue;
            const Timing timing = time_peer(setup, peer, truth);
            if (best && best->median <= timing.median) continue;
            best = timing;
            method = peer.method;
        }
        if (!best) continue;
        for (const char* task : {"whole", "frame"}) {
            Row row = setup.row_of(task, library.name, Side::peer, *best);
            row.note = method + ": topology and points, each time, in double, on one core";
            setup.session.report.add(std::move(row));
        }
    }
}
#else
void add_peers(const Setup&, const std::vector<double>&) {}
#endif

Candidate make_candidate(const Setup& setup, const SchemeRefinement& refined) {
    return value_or_fail(setup.options(), make_limn_candidate(setup.session.machines.device(), setup.evaluator,
                                                              refined.tables, setup.model.positions, kWidth));
}

void add_build(const Setup& setup) {
    std::optional<SchemeRefinement> refined;
    const Timing timing = measure(
        setup.options(), [&] { return refined.emplace(setup.build()), true; }, [&] { refined.reset(); }, kRepetitions);
    Row row = setup.row_of("build", "limn", Side::limn, timing);
    uint64_t bytes = 0;
    for (const StencilTable& table : refined->tables) bytes += table.bytes();
    row.note = std::to_string(refined->tables.size()) + " tables, " + megabytes(bytes);
    setup.session.report.add(std::move(row));
}

void add_frame(const Setup& setup, const std::vector<double>& truth) {
    const Candidate candidate = make_candidate(setup, setup.build());
    if (!candidate.frame()) fail(setup.options(), {ErrorCode::vulkan_failure, "a frame failed"});
    const double difference = largest_difference(candidate.points(), truth);
    if (!(difference <= tolerance_for(setup.model.positions).in_float))
        setup.fail_verification("the frame", difference);
    setup.session.report.add_finding(format(
        "schemes/%s: %.0f faces at level %u; the frame is within %.1e of the size of its rows in double",
        setup.scheme.name, setup.face_count, setup.level, difference / tolerance_for(setup.model.positions).size));
    Row row = setup.row_of("frame", "limn", Side::limn, measure(setup.options(), candidate.frame, {}, kRepetitions));
    row.bytes = static_cast<double>(candidate.bytes);
    row.flops = candidate.flops;
    row.copy_rate = setup.session.machines.copy.device;
    setup.session.report.add(std::move(row));
}

/// From the control mesh to points on the device: built, uploaded and evaluated once.
void add_whole(const Setup& setup) {
    std::optional<Candidate> candidate;
    const auto step = [&] {
        candidate.emplace(make_candidate(setup, setup.build()));
        return candidate->frame();
    };
    Row row = setup.row_of("whole", "limn", Side::limn,
                           measure(
                               setup.options(), step, [&] { candidate.reset(); }, kRepetitions));
    row.note = "built, uploaded, one frame";
    setup.session.report.add(std::move(row));
}

void bench_scheme(Setup setup) {
    show_progress(setup.options(), std::string("schemes ") + setup.scheme.name);
    choose_level(setup, setup.options().quick ? kQuickFaces : kFaces);
    setup.face_count = setup.build().mesh().face_count;
    const std::vector<double> truth = points_in_double(setup);
    add_build(setup);
    add_frame(setup, truth);
    add_whole(setup);
    add_peers(setup, truth);
}

}  // namespace

void bench_schemes(const Session& session) {
    const auto evaluator = value_or_fail(session.options, vk::Evaluator::create(session.machines.device()));
    const BenchModel quads = make_smooth_torus("torus_1k", kModelFaces),
                     triangles = triangulated(make_smooth_torus("torus_1k", kModelFaces / 2));
    for (const SubdivisionScheme& scheme : subdivision_schemes())
        bench_scheme({session, evaluator, scheme, scheme.faces == FaceKind::triangles ? triangles : quads});
}

}  // namespace limn::bench
