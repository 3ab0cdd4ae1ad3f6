#include "limn/schemes/adaptive.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "limn/compose.h"
#include "limn/parallel.h"
#include "limn/schemes/adaptive_faces.h"
#include "limn/schemes/scheme_limit.h"
#include "limn/schemes/scheme_pass.h"
#include "limn/schemes/star.h"
#include "limn/schemes/star_limit.h"

namespace limn {
namespace {

using Point = Eigen::Vector3d;
using Points = std::vector<Point>;

/// What rows are made of: tables to a level from the one before, and limits of its vertices.
struct LevelTables {
    std::vector<StencilTableDouble> steps;
    StencilTableDouble limit;
};

struct Levels {
    explicit Levels(const SubdivisionScheme& scheme)
        : kind(scheme.passes[0].split), masks(std::make_unique<StarLimits>(scheme, patch_rings(scheme))) {}

    SplitKind kind;
    std::unique_ptr<StarLimits> masks;  ///< which levels share
    std::vector<AdaptiveLevel> levels;
    std::vector<LevelTables> tables;
    Points points;  ///< of the last level
    Points limits;  ///< of all vertices, which keep their numbers
};

Points apply_rows(const StencilTableDouble& table, const Points& from, uint32_t first_row = 0) {
    Points out(table.row_count() - first_row, Point::Zero());
    for_each_index(table.row_count() - first_row, [&](uint32_t i) {
        for (uint32_t k = table.offsets[first_row + i]; k < table.offsets[first_row + i + 1]; ++k)
            out[i] += table.weights[k] * from[table.indices[k]];
    });
    return out;
}

double distance_to_edge(const Point& p, const Point& a, const Point& b) {
    const Point along = b - a;
    const double length2 = along.squaredNorm();
    const double t = length2 > 0 ? std::clamp((p - a).dot(along) / length2, 0.0, 1.0) : 0;
    return (p - a - t * along).norm();
}

double distance_to_triangle(const Point& p, const Point& a, const Point& b, const Point& c) {
    const Point n = (b - a).cross(c - a);
    const bool over =
        n.dot((b - a).cross(p - a)) > 0 && n.dot((c - b).cross(p - b)) > 0 && n.dot((a - c).cross(p - c)) > 0;
    if (over) return std::abs(n.dot(p - a)) / n.norm();
    return std::min({distance_to_edge(p, a, b), distance_to_edge(p, b, c), distance_to_edge(p, c, a)});
}

/// By how much face f misses the limits of the points of the next level that split it.
double face_error(const AdaptiveLevel& level, SplitKind kind, const Points& limits, uint32_t f) {
    const Topology& t = level.stage.topology;
    if (t.face_holes[f] != 0) return 0;
    const auto vertices = t.vertices_of_face(f);
    const bool in_four = kind == SplitKind::quads || kind == SplitKind::triangles;
    double most = 0;
    for (uint32_t c = t.face_begin(f), last = kInvalidIndex; c < t.face_begin(f) + t.size_of_face(f); ++c) {
        if (in_four)
            most = std::max(most, distance_to_edge(limits[level.first_edge_point + t.face_edges[c]],
                                                   limits[t.face_vertices[c]], limits[end_vertex(t, c)]));
        const uint32_t point = kind == SplitKind::triangles ? kInvalidIndex : level.corner_points[c];
        if (point == kInvalidIndex || point == last) continue;
        last = point;
        double least = INFINITY;
        for (size_t i = 2; i < vertices.size(); ++i)
            least = std::min(least, distance_to_triangle(limits[point], limits[vertices[0]],
                                                         limits[vertices[i - 1]], limits[vertices[i]]));
        most = std::max(most, least);
    }
    return most;
}

/// Limits of the vertices that the last level adds.
Result<void> add_limits(const SubdivisionScheme& scheme, Levels& out, const BuildPart& part) {
    SchemeRefinementDouble last;
    last.scheme = &scheme;
    last.last = std::move(out.levels.back().stage);
    auto limit = build_scheme_limit_table(last, true, *out.masks, part);
    out.levels.back().stage = std::move(last.last);
    if (!limit) return limit.error();
    const Points added = apply_rows(*limit, out.points, static_cast<uint32_t>(out.limits.size()));
    out.limits.insert(out.limits.end(), added.begin(), added.end());
    out.tables.back().limit = std::move(*limit);
    return {};
}

Result<void> add_level(const SubdivisionScheme& scheme, Levels& out, const BuildPart& part) {
    if (uint64_t{4} * out.levels.back().stage.topology.corner_count() > 0x7fffffff)
        return Error{ErrorCode::too_large, "step " + std::to_string(out.levels.size()) +
                                               " would have more than 2^31 - 1 face corners"};
    AdaptiveLevel& parent = out.levels.back();
    out.tables.emplace_back();
    Stage stage;
    for (size_t i = 0; i < scheme.passes.size(); ++i) {
        const Pass& pass = scheme.passes[i];
        Stage& from = i == 0 ? parent.stage : stage;
        SplitMesh split = split_mesh(from, pass.split, true, part.part(0, 0.3f));
        if (auto ok = part.check(); !ok) return ok.error();
        auto table = build_pass_table<double>(from, pass, split, part.part(0.3f, 0.5f));
        if (!table) return table.error();
        out.points = apply_rows(*table, out.points);
        out.tables.back().steps.push_back(std::move(*table));
        if (i == 0) note_split(split, pass.split, parent);
        stage = advance_stage(std::move(from), pass, std::move(split), i + 1 == scheme.passes.size());
    }
    out.levels.emplace_back().stage =
        std::move(stage);  // `parent` keeps what it had: a split takes nothing from it
    if (auto ok = add_limits(scheme, out, part.part(0.5f, 1)); !ok) return ok;
    AdaptiveLevel& before = out.levels[out.levels.size() - 2];
    before.errors.allocate(before.stage.topology.face_count);
    for_each_index(before.stage.topology.face_count,
                   [&](uint32_t f) { before.errors[f] = face_error(before, out.kind, out.limits, f); });
    return {};
}

/// Evenly, until no face misses by more than the tolerance, or to max_level.
Result<Levels> refine_levels(Stage&& first, const SubdivisionScheme& scheme,
                             std::span<const double> positions, const AdaptiveSurfaceOptions& options) {
    Levels out(scheme);
    for (size_t i = 0; i + 2 < positions.size(); i += 3)
        out.points.push_back({positions[i], positions[i + 1], positions[i + 2]});
    out.levels.emplace_back().stage = std::move(first);
    out.tables.emplace_back();
    if (auto ok = add_limits(scheme, out, options.control.part(0, 0.05f)); !ok) return ok.error();
    bool flat = false;
    for (uint32_t level = 0; level < options.max_level && !flat; ++level) {
        // Each level costs as much as four of those before.
        const auto from = static_cast<float>(std::pow(0.25, options.max_level - level));
        if (auto ok = add_level(scheme, out, options.control.part(0.05f, 0.8f).part(from, 4 * from)); !ok)
            return ok.error();
        const Array<double>& errors = out.levels[level].errors;
        flat = std::none_of(errors.begin(), errors.end(), [&](double e) { return e > options.tolerance; });
    }
    return out;
}

AdaptiveFaces faces_for(Levels& levels, double tolerance) {
    choose_split_faces(levels.levels, levels.kind, tolerance);
    return collect_faces(levels.levels, levels.kind);
}

/// Raises `tolerance` by the least that leaves no more than max_triangles. Errors: too_large.
Result<AdaptiveFaces> limited_faces(Levels& levels, uint32_t max_triangles, double& tolerance) {
    AdaptiveFaces faces = faces_for(levels, tolerance);
    if (faces.triangle_count() <= max_triangles) return faces;
    // What is split with one tolerance is split with any smaller one, so that counts fall as it rises past
    // errors.
    std::vector<double> errors;
    for (const AdaptiveLevel& level : levels.levels)
        std::copy_if(level.errors.begin(), level.errors.end(), std::back_inserter(errors),
                     [&](double e) { return e > tolerance; });
    std::sort(errors.begin(), errors.end());
    const auto fits = std::partition_point(errors.begin(), errors.end(), [&](double e) {
        return faces_for(levels, e).triangle_count() > max_triangles;
    });
    if (fits == errors.end())
        return Error{ErrorCode::too_large, "the control mesh itself has more than " +
                                               std::to_string(max_triangles) +
                                               (max_triangles == 1 ? " triangle" : " triangles")};
    tolerance = *fits;
    return faces_for(levels, tolerance);
}

/// An entry of a row in the making.
struct Weights {
    uint32_t index;
    double position, tangent1, tangent2;
};

/// Adds up repeated indices; they ascend then.
void merge(std::vector<Weights>& row) {
    std::stable_sort(row.begin(), row.end(),
                     [](const Weights& a, const Weights& b) { return a.index < b.index; });
    size_t out = 0;
    for (const Weights& entry : row) {
        if (out == 0 || row[out - 1].index != entry.index) {
            row[out++] = entry;
            continue;
        }
        row[out - 1].position += entry.position;
        row[out - 1].tangent1 += entry.tangent1;
        row[out - 1].tangent2 += entry.tangent2;
    }
    row.resize(out);
}

/// The limit row of a vertex over the control points, from the level in which it appears.
void make_row(const Levels& levels, uint32_t v, std::vector<Weights>& row, std::vector<Weights>& scratch) {
    size_t level = 0;
    while (levels.levels[level].stage.topology.vertex_count <= v) ++level;
    const StencilTableDouble& limit = levels.tables[level].limit;
    row.clear();
    for (uint32_t k = limit.offsets[v]; k < limit.offsets[v + 1]; ++k)
        row.push_back(
            {limit.indices[k], limit.weights[k], limit.tangent1_weights[k], limit.tangent2_weights[k]});
    for (; level > 0; --level) {
        const auto& steps = levels.tables[level].steps;
        for (size_t i = steps.size(); i-- > 0;) {
            scratch.clear();
            for (const Weights& entry : row)
                for (uint32_t k = steps[i].offsets[entry.index]; k < steps[i].offsets[entry.index + 1]; ++k) {
                    const double w = steps[i].weights[k];
                    scratch.push_back(
                        {steps[i].indices[k], w * entry.position, w * entry.tangent1, w * entry.tangent2});
                }
            std::swap(row, scratch);
            merge(row);
        }
    }
}

/// Errors: too_large, cancelled.
template <class Real>
Result<BasicStencilTable<Real>> build_rows(const Levels& levels, const Array<uint32_t>& vertices,
                                           const BuildPart& part) {
    constexpr uint32_t kBlock = 512;
    const auto count = static_cast<uint32_t>(vertices.size());
    BasicStencilTable<Real> table;
    table.source_count = levels.levels[0].stage.topology.vertex_count;
    table.offsets.allocate(size_t{count} + 1);
    table.offsets.back() = 0;
    std::vector<std::vector<Weights>> blocks(count / kBlock + 1);
    for_each_block(count, part.part(0, 0.9f), kBlock, [&](uint32_t begin, uint32_t end) {
        std::vector<Weights> row, scratch;
        for (uint32_t i = begin; i != end; ++i) {
            make_row(levels, vertices[i], row, scratch);
            table.offsets[i] = static_cast<uint32_t>(row.size());
            blocks[begin / kBlock].insert(blocks[begin / kBlock].end(), row.begin(), row.end());
        }
    });
    if (auto ok = part.check(); !ok) return ok.error();
    if (auto ok = offsets_from_sizes(table.offsets); !ok) return ok.error();
    table.indices.allocate(table.offsets.back());
    for (Array<Real>* weights : {&table.weights, &table.tangent1_weights, &table.tangent2_weights})
        weights->allocate(table.offsets.back());
    size_t at = 0;
    for (const auto& block : blocks)
        for (const Weights& entry : block) {
            table.indices[at] = entry.index;
            table.weights[at] = static_cast<Real>(entry.position);
            table.tangent1_weights[at] = static_cast<Real>(entry.tangent1);
            table.tangent2_weights[at++] = static_cast<Real>(entry.tangent2);
        }
    return table;
}

template <class T>
Array<T> copy_of(const std::vector<T>& from) {
    Array<T> out;
    out.allocate(from.size());
    std::copy(from.begin(), from.end(), out.begin());
    return out;
}

/// Faces and triangles; their vertices numbered without gaps, uniform_vertices.
template <class Real>
void set_faces(const AdaptiveFaces& faces, BasicAdaptiveSurface<Real>& out) {
    std::vector<uint32_t> used = faces.vertices;
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    out.uniform_vertices = copy_of(used);
    out.face_vertices.allocate(faces.vertices.size());
    for_each_index(static_cast<uint32_t>(faces.vertices.size()), [&](uint32_t i) {
        const auto found = std::lower_bound(used.begin(), used.end(), faces.vertices[i]);
        out.face_vertices[i] = static_cast<uint32_t>(found - used.begin());
    });
    out.face_levels = copy_of(faces.levels);
    out.level = faces.levels.empty() ? 0 : *std::max_element(faces.levels.begin(), faces.levels.end());
    out.face_offsets.allocate(faces.sizes.size() + 1);
    out.face_offsets[0] = 0;
    out.triangles.allocate(3 * faces.triangle_count());
    size_t at = 0;
    for (size_t f = 0; f < faces.sizes.size(); ++f) {
        const uint32_t begin = out.face_offsets[f], end = out.face_offsets[f + 1] = begin + faces.sizes[f];
        for (uint32_t i = begin + 2; i < end; ++i)
            for (const uint32_t corner : {begin, i - 1, i}) out.triangles[at++] = out.face_vertices[corner];
    }
}

Result<void> check_options(const ControlMesh& mesh, const SubdivisionScheme& scheme,
                           std::span<const double> positions, const AdaptiveSurfaceOptions& options) {
    if (!is_adaptive(scheme))
        return Error{ErrorCode::unsupported,
                     std::string(scheme.title) + " is not refined adaptively: its vertices turn into faces"};
    if (positions.size() != size_t{3} * mesh.vertex_count)
        return Error{ErrorCode::invalid_argument, "positions are not three numbers for each vertex"};
    if (!(options.tolerance >= 0))
        return Error{ErrorCode::invalid_argument, "the tolerance is negative or no number"};
    return {};
}

}  // namespace

bool is_adaptive(const SubdivisionScheme& scheme) {
    const SplitKind first = scheme.passes[0].split;
    return (first == SplitKind::quads || first == SplitKind::triangles || first == SplitKind::sqrt3 ||
            first == SplitKind::sqrt2) &&
           std::all_of(scheme.passes.begin() + 1, scheme.passes.end(),
                       [](const Pass& pass) { return pass.split == SplitKind::none; });
}

template <class Real>
Result<BasicAdaptiveSurface<Real>> build_adaptive_surface(const ControlMesh& mesh,
                                                          const SubdivisionScheme& scheme,
                                                          std::span<const double> positions,
                                                          const AdaptiveSurfaceOptions& options,
                                                          std::span<const double> intervals) {
    if (auto ok = options.control.start(); !ok) return ok.error();
    if (auto ok = check_options(mesh, scheme, positions, options); !ok) return ok.error();
    auto stage = build_first_stage(mesh, scheme, intervals);
    if (!stage) return stage.error();
    BasicAdaptiveSurface<Real> out;
    out.control_count = mesh.vertex_count;
    out.edges = stage->topology.edge_vertices;
    auto levels = refine_levels(std::move(*stage), scheme, positions, options);
    if (!levels) return levels.error();
    out.tolerance = options.tolerance;
    auto faces = limited_faces(*levels, options.max_triangles, out.tolerance);
    if (!faces) return faces.error();
    set_faces(*faces, out);
    out.reached = out.level + 1 < levels->levels.size();  // all but faces of the last level are known
    auto rows = build_rows<Real>(*levels, out.uniform_vertices, options.control.part(0.8f, 1));
    if (!rows) return rows.error();
    out.limit = std::move(*rows);
    if (auto ok = options.control.reach(1); !ok) return ok.error();
    return out;
}

template Result<AdaptiveSurface> build_adaptive_surface(const ControlMesh&, const SubdivisionScheme&,
                                                        std::span<const double>,
                                                        const AdaptiveSurfaceOptions&,
                                                        std::span<const double>);
template Result<AdaptiveSurfaceDouble> build_adaptive_surface(const ControlMesh&, const SubdivisionScheme&,
                                                              std::span<const double>,
                                                              const AdaptiveSurfaceOptions&,
                                                              std::span<const double>);

SchemeSurface make_scheme_surface(AdaptiveSurface&& surface) {
    SchemeSurface out;
    out.control_count = surface.control_count;
    out.vertex_count = surface.limit.row_count();
    out.limit = std::move(surface.limit);
    out.face_offsets = std::move(surface.face_offsets);
    out.face_vertices = std::move(surface.face_vertices);
    out.triangles = std::move(surface.triangles);
    out.edges = std::move(surface.edges);
    return out;
}

}  // namespace limn
