#include "conformance/refinement_checks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "shapes/refined_grid_rows.h"

namespace limn::test {
namespace {

using Levels = std::vector<std::vector<double>>;

template <class Real>
std::vector<SparseRow> rows_of_table(const BasicStencilTable<Real>& table) {
    std::vector<SparseRow> rows(table.row_count());
    for (uint32_t r = 0; r < rows.size(); ++r) {
        for (uint32_t k = table.offsets[r]; k < table.offsets[r + 1]; ++k) {
            if (table.weights[k] != 0)
                rows[r].push_back({table.indices[k], static_cast<double>(table.weights[k])});
        }
        std::sort(rows[r].begin(), rows[r].end());
    }
    return rows;
}

template <class Real>
testing::AssertionResult check_form(const BasicStencilTable<Real>& table, double tolerance) {
    if (table.offsets.empty() || table.offsets[0] != 0 || table.offsets.back() != table.indices.size() ||
        table.weights.size() != table.indices.size()) {
        return testing::AssertionFailure() << "array sizes do not agree";
    }
    std::vector<uint32_t> row;
    for (uint32_t r = 0; r < table.row_count(); ++r) {
        double sum = 0;
        row.clear();
        for (uint32_t k = table.offsets[r]; k < table.offsets[r + 1]; ++k) {
            if (table.indices[k] >= table.source_count) {
                return testing::AssertionFailure() << "row " << r << " refers to source " << table.indices[k];
            }
            row.push_back(table.indices[k]);
            sum += static_cast<double>(table.weights[k]);
        }
        std::sort(row.begin(), row.end());
        if (std::adjacent_find(row.begin(), row.end()) != row.end()) {
            return testing::AssertionFailure() << "row " << r << " repeats an index";
        }
        if (!(std::abs(sum - 1) <= tolerance)) {
            return testing::AssertionFailure() << "weights of row " << r << " sum to 1 + " << sum - 1;
        }
    }
    return testing::AssertionSuccess();
}

template <class Number>
testing::AssertionResult sizes_differ(const char* what, Number ours, Number theirs) {
    return testing::AssertionFailure() << what << ": " << ours << ", OpenSubdiv has " << theirs;
}

std::array<double, 3> cross(const double* a, const double* b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

double length(const std::array<double, 3>& v) {
    return std::hypot(v[0], v[1], v[2]);
}

ControlMesh make_control_mesh(const TestMesh& mesh, bool compatible) {
    ControlMeshDescription description = mesh.description();
    description.options.opensubdiv_compatible = compatible;
    auto result = ControlMesh::create(description);
    if (!result) {
        ADD_FAILURE() << mesh.name << ": " << result.error().message;
        return {};
    }
    return std::move(result).value();
}

uint32_t last_level_within(const TestMesh& mesh, uint32_t max_level, uint64_t max_vertices) {
    uint32_t level = 0;
    while (level < max_level && OsdOracle::estimate_vertex_count(mesh, level + 1) <= max_vertices) ++level;
    return level;
}

// Values at face corners from values at the vertices of a channel's refinement.
std::vector<double> at_corners(const Topology& topology, const std::vector<double>& values) {
    std::vector<double> result;
    for (uint32_t v : topology.face_vertices) result.insert(result.end(), {values[2 * v], values[2 * v + 1]});
    return result;
}

struct Checker {
    const TestMesh& mesh;
    const CheckLimits& limits;
    std::vector<double> control_points;
    double scale = 1;
    double tolerance = kDoubleTolerance;

    Checker(const TestMesh& m, const CheckLimits& l)
        : mesh(m), limits(l), control_points(m.positions_double()) {
        scale = mesh.size();
        if (has_inexact_fading(mesh)) tolerance = kFadingTolerance;
    }

    bool exact() const { return tolerance == kDoubleTolerance; }

    std::unique_ptr<OsdOracle> oracle(uint32_t level) const {
        std::string error;
        auto result = OsdOracle::create(mesh, level, &error);
        if (!result) ADD_FAILURE() << mesh.name << ": OpenSubdiv refuses it: " << error;
        return result;
    }

    void compare_levels(const Levels& ours, const Levels& theirs, const char* what, double& worst) const {
        ASSERT_EQ(ours.size(), theirs.size()) << what;
        for (size_t level = 0; level < ours.size(); ++level) {
            EXPECT_TRUE(same_numbers(ours[level], theirs[level], tolerance * scale))
                << what << ", level " << level;
            for (size_t i = 0; i < std::min(ours[level].size(), theirs[level].size()); ++i) {
                worst = std::max(worst, std::abs(ours[level][i] - theirs[level][i]) / scale);
            }
        }
    }

    // `same` is false when topology differs: points in another order say nothing more.
    void check_topology_and_points(const ControlMesh& control, bool compare_points, bool& same) const {
        same = false;
        const uint32_t level = last_level_within(mesh, limits.max_level, limits.max_vertices);
        const auto theirs = oracle(level);
        const auto ours = build_refinement(control, {level, true});
        ASSERT_TRUE(theirs && ours) << mesh.name;
        ASSERT_EQ(ours->level_count(), level + 1);
        for (uint32_t l = 0; l <= level; ++l) {
            const testing::AssertionResult equal = same_topology(ours->levels[l], *theirs, l);
            ASSERT_TRUE(equal) << "level " << l;
            const Array<uint32_t> base_faces = build_base_faces(*ours, l);
            EXPECT_TRUE(same_indices(base_faces, theirs->base_faces(l))) << "base faces, level " << l;
        }
        same = true;
        if (compare_points) {
            const Levels points = refine_by_steps(*ours, control_points, 3, Interpolation::vertex);
            compare_levels(points, theirs->refine(control_points, 3), "points", worst_errors(exact()).points);
            const auto table = build_stencil_table<double>(*ours, level);
            ASSERT_TRUE(table);
            EXPECT_TRUE(
                same_numbers(apply(*table, control_points, 3), points.back(), kDoubleTolerance * scale))
                << "stencil table against step tables";
        }
        compare_levels(refine_by_steps(*ours, control_points, 3, Interpolation::varying),
                       theirs->refine_varying(control_points, 3), "varying", worst_errors(exact()).points);
    }

    void check_rows(const ControlMesh& control) const {
        const uint32_t level = last_level_within(mesh, limits.max_level, limits.max_stencil_rows);
        const auto theirs = oracle(level);
        const auto ours = build_refinement(control, {level, false});
        ASSERT_TRUE(theirs && ours) << mesh.name;
        const std::vector<SparseRow> all = theirs->stencils_of_all_levels();
        size_t begin = 0;
        for (uint32_t l = 1; l <= level; ++l) {
            const auto table = build_stencil_table<double>(*ours, l);
            const auto float_table = build_stencil_table<float>(*ours, l);
            ASSERT_TRUE(table && float_table);
            EXPECT_TRUE(well_formed(*table)) << "table of level " << l;
            EXPECT_TRUE(well_formed(*float_table)) << "float table of level " << l;
            const std::vector<SparseRow> rows = rows_of(*table);
            ASSERT_LE(begin + rows.size(), all.size());
            const std::span<const SparseRow> expected = std::span(all).subspan(begin, rows.size());
            EXPECT_TRUE(same_rows(rows, expected, tolerance, &worst_errors(exact()).rows))
                << "rows of level " << l;
            EXPECT_TRUE(same_rows(rows_of(*float_table), expected, kFloatWeightTolerance))
                << "float, level " << l;
            const auto grid = build_refined_grid_table(*ours, {.level = l});
            ASSERT_TRUE(grid);
            std::vector<SparseRow> grid_rows;
            for (const auto& row : rows_of_refined_grid(*grid)) grid_rows.emplace_back(row.begin(), row.end());
            EXPECT_TRUE(same_rows(grid_rows, expected, kFloatWeightTolerance)) << "refined grid, level " << l;
            begin += rows.size();
        }
        EXPECT_EQ(begin, all.size());
        const auto varying = build_stencil_table<double>(*ours, level, Interpolation::varying);
        ASSERT_TRUE(varying);
        EXPECT_TRUE(same_rows(rows_of(*varying), theirs->stencils(true), kDoubleTolerance)) << "varying rows";
    }

    void check_channels(const ControlMesh& control, bool with_limits) const {
        if (mesh.channels.empty()) return;
        const uint32_t level =
            last_level_within(mesh, limits.max_face_varying_level, limits.max_vertices / 4);
        const auto theirs = oracle(level);
        ASSERT_TRUE(theirs);
        for (uint32_t c = 0; c < mesh.channels.size(); ++c) {
            SCOPED_TRACE(std::string("channel ") + name_of(mesh.channels[c].interpolation));
            const auto ours = build_face_varying_refinement(control, c, {level, true});
            ASSERT_TRUE(ours) << ours.error().message;
            const std::vector<double> values(mesh.channels[c].values.begin(), mesh.channels[c].values.end());
            const Levels steps = refine_by_steps(*ours, values, 2, Interpolation::vertex);
            Levels corners;
            for (uint32_t l = 0; l <= level; ++l) corners.push_back(at_corners(ours->levels[l], steps[l]));
            compare_levels(corners, theirs->refine_face_varying(c, values), "face-varying",
                           worst_errors(exact()).face_varying);
            const auto table = build_stencil_table<double>(*ours, level);
            ASSERT_TRUE(table);
            EXPECT_TRUE(same_numbers(apply(*table, values, 2), steps.back(), kDoubleTolerance * scale));
            if (!with_limits) continue;
            const auto limit_table = build_limit_table<double>(*ours, level);
            ASSERT_TRUE(limit_table);
            const auto ours_limit = at_corners(ours->last(), apply(*limit_table, values, 2));
            // OpenSubdiv smooths the limits of bilinear channels along seams, though not the channels
            // themselves.
            const auto theirs_limit = mesh.options.scheme == Scheme::bilinear
                                          ? corners.back()
                                          : theirs->face_varying_limits(c, values);
            EXPECT_TRUE(same_numbers(ours_limit, theirs_limit, kFaceVaryingLimitTolerance * scale))
                << "face-varying limits";
            for (size_t i = 0; i < std::min(ours_limit.size(), theirs_limit.size()); ++i) {
                worst_errors(exact()).face_varying_limits =
                    std::max(worst_errors(exact()).face_varying_limits,
                             std::abs(ours_limit[i] - theirs_limit[i]) / scale);
            }
        }
    }

    // Limits are those of the surface from the level where no finite sharpness is left.
    void check_limits(bool compatible, const ControlMesh& control) const {
        const uint32_t needed = std::max(1u, static_cast<uint32_t>(std::ceil(mesh.max_finite_sharpness())));
        const uint32_t level = last_level_within(mesh, needed, limits.max_vertices / 4);
        // limn's limits are exact at any level; compatible ones are those of the level, as OpenSubdiv's.
        if (level < needed && !compatible) return;
        const auto theirs = oracle(level);
        const auto ours = build_refinement(control, {level, true});
        ASSERT_TRUE(theirs && ours);
        const auto table = build_limit_table<double>(*ours, level, true);
        ASSERT_TRUE(table);
        EXPECT_TRUE(well_formed(*table)) << "limit table";
        OsdOracle::Limits our_limits = apply_limit_table(*table, control_points);
        OsdOracle::Limits their_limits = theirs->limits(control_points);
        const std::vector<VertexRule> rules = theirs->vertex_rules(level);
        const std::vector<uint8_t> manifold = theirs->vertex_manifold(level);
        const std::vector<uint32_t> faces = theirs->vertex_face_counts(level);
        const std::vector<uint8_t> boundary = theirs->vertex_boundaries(level);
        std::vector<uint8_t> compared(manifold);
        const bool quads = mesh.options.scheme == Scheme::catmull_clark;
        for (size_t v = 0; v < compared.size(); ++v) {
            const VertexRule rule = rules[v];
            // Inside the surface, creases and corners have a normal for each of their sides, and bilinear
            // vertices for each of their faces: which one is given is a matter of taste.
            const bool smooth = rule == VertexRule::smooth || rule == VertexRule::dart;
            if (!boundary[v] && (!smooth || mesh.options.scheme == Scheme::bilinear)) compared[v] = 0;
            if (compatible) continue;
            // The named deviations.
            const bool valence_two = quads && faces[v] == 2 && smooth;
            if (rule == VertexRule::dart || valence_two) {
                compared[v] = 0;
                for (size_t i = 3 * v; i < 3 * v + 3; ++i)
                    our_limits.positions[i] = their_limits.positions[i];
            }
            if (rule == VertexRule::corner && faces[v] > 1) compared[v] = 0;
            if (rule == VertexRule::crease && faces[v] > (quads ? 2u : 3u)) compared[v] = 0;
        }
        EXPECT_TRUE(same_numbers(our_limits.positions, their_limits.positions, tolerance * scale))
            << "limits";
        const double angle = exact() ? kNormalTolerance : kFadingNormalTolerance;
        EXPECT_TRUE(same_normals(our_limits, their_limits, compared, angle, &worst_errors(exact()).normals))
            << "normals";
        const size_t count = std::min(our_limits.positions.size(), their_limits.positions.size());
        for (size_t i = 0; i < count; ++i) {
            const double error = std::abs(our_limits.positions[i] - their_limits.positions[i]) / scale;
            worst_errors(exact()).limits = std::max(worst_errors(exact()).limits, error);
        }
    }
};

}  // namespace

bool extrapolates(const TestMesh& mesh, const OsdOracle& oracle) {
    if (mesh.options.creasing != CreasingMethod::chaikin) return false;
    for (uint32_t level = 0; level + 1 < oracle.level_count(); ++level) {
        const std::vector<float> sharpness = oracle.edge_sharpness(level);
        const std::vector<uint32_t> ends = oracle.edge_vertices(level);
        std::vector<std::vector<float>> around(oracle.vertex_count(level));
        for (size_t i = 0; i < ends.size(); ++i) around[ends[i]].push_back(sharpness[i / 2]);
        for (size_t e = 0; e < sharpness.size(); ++e) {
            if (sharpness[e] <= 1 || is_infinite(sharpness[e])) continue;
            bool smooth[2];
            for (size_t i = 0; i < 2; ++i) {
                float sum = 0, count = 0;
                for (float s : around[ends[2 * e + i]]) {
                    if (s <= 0 || is_infinite(s)) continue;
                    sum += s;
                    count += 1;
                }
                const float others = count > 1 ? (sum - sharpness[e]) / (count - 1) : sharpness[e];
                smooth[i] = 0.75f * sharpness[e] + 0.25f * others <= 1;
            }
            if (smooth[0] || smooth[1]) return true;
        }
    }
    return false;
}

// Sums and halves of small multiples of 1/16 are exact.
bool has_inexact_fading(const TestMesh& mesh) {
    if (mesh.max_finite_sharpness() == 0) return false;
    if (mesh.options.creasing == CreasingMethod::chaikin) return true;
    auto rounds = [](float sharpness) { return std::floor(sharpness * 16) != sharpness * 16; };
    return std::any_of(mesh.crease_sharpness.begin(), mesh.crease_sharpness.end(), rounds) ||
           std::any_of(mesh.corner_sharpness.begin(), mesh.corner_sharpness.end(), rounds);
}

testing::AssertionResult well_formed(const StencilTable& table) {
    return check_form(table, 1e-5);
}
testing::AssertionResult well_formed(const StencilTableDouble& table) {
    return check_form(table, 1e-13);
}

std::vector<SparseRow> rows_of(const StencilTable& table) {
    return rows_of_table(table);
}
std::vector<SparseRow> rows_of(const StencilTableDouble& table) {
    return rows_of_table(table);
}

testing::AssertionResult same_numbers(std::span<const double> ours, std::span<const double> theirs,
                                      double tolerance) {
    if (ours.size() != theirs.size()) return sizes_differ("numbers", ours.size(), theirs.size());
    size_t first = ours.size(), worst = 0, count = 0;
    double worst_error = 0;
    for (size_t i = 0; i < ours.size(); ++i) {
        const double error = std::abs(ours[i] - theirs[i]);
        if (error <= tolerance) continue;  // false for NaN
        first = std::min(first, i);
        ++count;
        if (!(error <= worst_error)) {
            worst_error = error;
            worst = i;
        }
    }
    if (count == 0) return testing::AssertionSuccess();
    return testing::AssertionFailure()
           << count << " of " << ours.size() << " numbers differ, first " << first << ", worst " << worst
           << " by " << worst_error << ": " << ours[worst] << ", OpenSubdiv has " << theirs[worst];
}

testing::AssertionResult same_indices(std::span<const uint32_t> ours, std::span<const uint32_t> theirs) {
    if (ours.size() != theirs.size()) return sizes_differ("indices", ours.size(), theirs.size());
    for (size_t i = 0; i < ours.size(); ++i) {
        if (ours[i] == theirs[i]) continue;
        return testing::AssertionFailure() << "index " << i << " of " << ours.size() << " is " << ours[i]
                                           << ", OpenSubdiv has " << theirs[i];
    }
    return testing::AssertionSuccess();
}

testing::AssertionResult same_rows(std::span<const SparseRow> ours, std::span<const SparseRow> theirs,
                                   double tolerance, double* worst_seen) {
    if (ours.size() != theirs.size()) return sizes_differ("rows", ours.size(), theirs.size());
    double worst = 0;
    size_t worst_row = 0;
    uint32_t worst_column = 0;
    for (size_t r = 0; r < ours.size(); ++r) {
        auto a = ours[r].begin(), b = theirs[r].begin();
        while (a != ours[r].end() || b != theirs[r].end()) {
            const bool take_a = b == theirs[r].end() || (a != ours[r].end() && a->first <= b->first);
            const bool take_b = a == ours[r].end() || (b != theirs[r].end() && b->first <= a->first);
            const uint32_t column = take_a ? a->first : b->first;
            const double error = std::abs((take_a ? a->second : 0.0) - (take_b ? b->second : 0.0));
            if (!(error <= worst)) {
                worst = error;
                worst_row = r;
                worst_column = column;
            }
            if (take_a) ++a;
            if (take_b) ++b;
        }
    }
    if (worst_seen) *worst_seen = std::max(*worst_seen, worst);
    if (worst <= tolerance) return testing::AssertionSuccess();
    return testing::AssertionFailure()
           << "weight of control point " << worst_column << " in row " << worst_row << " is off by " << worst;
}

testing::AssertionResult same_normals(const OsdOracle::Limits& ours, const OsdOracle::Limits& theirs,
                                      std::span<const uint8_t> compared, double tolerance,
                                      double* worst_seen) {
    if (theirs.tangents1.empty()) return testing::AssertionSuccess();
    if (ours.tangents1.size() != theirs.tangents1.size()) {
        return sizes_differ("tangents", ours.tangents1.size(), theirs.tangents1.size());
    }
    // Sine of the angle between the tangents, and their unit normal.
    auto normal = [](const OsdOracle::Limits& limits, size_t v, std::array<double, 3>& n) {
        const double *a = &limits.tangents1[3 * v], *b = &limits.tangents2[3 * v];
        const double length_a = std::hypot(a[0], a[1], a[2]), length_b = std::hypot(b[0], b[1], b[2]);
        n = cross(a, b);
        const double size = length(n);
        if (!(length_a > 1e-9 && length_b > 1e-9 && size > 0)) return 0.0;
        for (double& x : n) x /= size;
        return size / (length_a * length_b);
    };
    for (size_t v = 0; v < compared.size(); ++v) {
        if (!compared[v]) continue;
        std::array<double, 3> a, b;
        const double our_sine = normal(ours, v, a), their_sine = normal(theirs, v, b);
        if (std::min(our_sine, their_sine) < 1e-4) {  // nearly parallel tangents have no normal to compare
            if (std::max(our_sine, their_sine) < 1e-2) continue;
            return testing::AssertionFailure()
                   << "vertex " << v
                   << " has a normal on one side only: sines of the angle between its tangents are "
                   << our_sine << ", OpenSubdiv has " << their_sine;
        }
        const double cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        const double sine = length(cross(a.data(), b.data()));
        if (cosine > 0 && worst_seen) *worst_seen = std::max(*worst_seen, sine);
        if (cosine > 0 && sine <= tolerance) continue;
        return testing::AssertionFailure()
               << "normal of vertex " << v << " is off: sine " << sine << ", cosine " << cosine;
    }
    return testing::AssertionSuccess();
}

testing::AssertionResult same_topology(const Topology& ours, const OsdOracle& theirs, uint32_t level) {
    if (ours.vertex_count != theirs.vertex_count(level)) {
        return sizes_differ("vertices", ours.vertex_count, theirs.vertex_count(level));
    }
    if (ours.edge_count != theirs.edge_count(level)) {
        return sizes_differ("edges", ours.edge_count, theirs.edge_count(level));
    }
    if (ours.face_count != theirs.face_count(level)) {
        return sizes_differ("faces", ours.face_count, theirs.face_count(level));
    }
    std::vector<uint32_t> sizes;
    for (uint32_t f = 0; f < ours.face_count; ++f) sizes.push_back(ours.size_of_face(f));
    if (auto ok = same_indices(sizes, theirs.face_sizes(level)); !ok) return ok << " (face sizes)";
    if (auto ok = same_indices(ours.face_vertices, theirs.face_vertices(level)); !ok)
        return ok << " (face vertices)";
    const std::vector<uint8_t> holes = theirs.face_holes(level);
    for (size_t f = 0; f < holes.size(); ++f) {
        if (ours.face_holes[f] != holes[f]) {
            return testing::AssertionFailure() << "face " << f << " hole: " << int{ours.face_holes[f]};
        }
    }
    // OpenSubdiv calls what descends from an edge from a vertex to itself non-manifold, though its faces form
    // one fan.
    const std::vector<uint32_t> base_edges = theirs.edge_vertices(0);
    bool degenerate = false;
    for (size_t e = 0; e < base_edges.size(); e += 2) degenerate |= base_edges[e] == base_edges[e + 1];
    const std::vector<VertexRule> rules = theirs.vertex_rules(level);
    const std::vector<float> vertex_sharpness = theirs.vertex_sharpness(level);
    const std::vector<uint8_t> manifold = theirs.vertex_manifold(level);
    for (size_t v = 0; v < rules.size(); ++v) {
        if (ours.vertex_rules[v] != rules[v]) {
            return testing::AssertionFailure()
                   << "rule of vertex " << v << " is " << int(ours.vertex_rules[v]) << ", OpenSubdiv has "
                   << int(rules[v]);
        }
        if (ours.vertex_manifold[v] != manifold[v] && !(degenerate && ours.vertex_manifold[v])) {
            return testing::AssertionFailure()
                   << "vertex " << v << " manifold: " << int{ours.vertex_manifold[v]};
        }
        if (std::abs(ours.vertex_sharpness[v] - vertex_sharpness[v]) > 1e-6f) {
            return testing::AssertionFailure()
                   << "sharpness of vertex " << v << " is " << ours.vertex_sharpness[v] << ", OpenSubdiv has "
                   << vertex_sharpness[v];
        }
    }
    const std::vector<float> edge_sharpness = theirs.edge_sharpness(level);
    const std::vector<uint32_t> edge_vertices = theirs.edge_vertices(level);
    for (size_t e = 0; e < edge_sharpness.size(); ++e) {
        const auto ends = std::minmax(ours.edge_vertices[2 * e], ours.edge_vertices[2 * e + 1]);
        if (ends != std::minmax(edge_vertices[2 * e], edge_vertices[2 * e + 1])) {
            return testing::AssertionFailure() << "edge " << e << " joins other vertices";
        }
        if (std::abs(ours.edge_sharpness[e] - edge_sharpness[e]) > 1e-6f) {
            return testing::AssertionFailure()
                   << "sharpness of edge " << e << " is " << ours.edge_sharpness[e] << ", OpenSubdiv has "
                   << edge_sharpness[e];
        }
    }
    return testing::AssertionSuccess();
}

std::vector<double> apply(const StencilTableDouble& table, std::span<const double> source, uint32_t width) {
    std::vector<double> result(size_t{table.row_count()} * width);
    apply_stencil_table<double>(table, source, result, width);
    return result;
}

std::vector<std::vector<double>> refine_by_steps(const Refinement& refinement,
                                                 std::span<const double> control_values, uint32_t width,
                                                 Interpolation interpolation) {
    std::vector<std::vector<double>> levels(1);
    if (refinement.control_indices.empty()) {
        levels[0].assign(control_values.begin(), control_values.end());
    } else {
        for (uint32_t i : refinement.control_indices) {
            for (uint32_t k = 0; k < width; ++k) levels[0].push_back(control_values[size_t{i} * width + k]);
        }
    }
    for (uint32_t level = 1; level < refinement.level_count(); ++level) {
        const auto table = build_step_table<double>(refinement, level, interpolation);
        if (!table) {
            ADD_FAILURE() << "level " << level << ": " << table.error().message;
            return levels;
        }
        levels.push_back(apply(*table, levels.back(), width));
    }
    return levels;
}

OsdOracle::Limits apply_limit_table(const StencilTableDouble& table, std::span<const double> control_points) {
    OsdOracle::Limits limits;
    limits.positions = apply(table, control_points, 3);
    if (table.tangent1_weights.empty()) return limits;
    StencilTableDouble tangents = table;
    tangents.weights = table.tangent1_weights;
    limits.tangents1 = apply(tangents, control_points, 3);
    tangents.weights = table.tangent2_weights;
    limits.tangents2 = apply(tangents, control_points, 3);
    return limits;
}

WorstErrors& worst_errors(bool exact) {
    static WorstErrors errors[2];
    return errors[exact];
}

void print_worst_errors() {
    for (bool exact : {true, false}) {
        const WorstErrors& e = worst_errors(exact);
        std::printf(
            "worst differences%s: points %.1e, rows %.1e, face-varying %.1e, limits %.1e, "
            "face-varying limits %.1e, sine of normals %.1e\n",
            exact ? "" : " where sharpness fades", e.points, e.rows, e.face_varying, e.limits,
            e.face_varying_limits, e.normals);
    }
}

void check_against_oracle(const TestMesh& mesh, const CheckLimits& limits) {
    const Checker checker(mesh, limits);
    {
        SCOPED_TRACE("compatible");
        const ControlMesh control = make_control_mesh(mesh, true);
        if (control.face_offsets.empty()) return;
        bool same = false;
        checker.check_topology_and_points(control, true, same);
        if (!same) return;
        checker.check_rows(control);
        checker.check_channels(control, true);
        checker.check_limits(true, control);
    }
    SCOPED_TRACE("default");
    const ControlMesh control = make_control_mesh(mesh, false);
    bool deviates = false;
    if (mesh.options.creasing == CreasingMethod::chaikin) {
        // Limits look as deep as sharpness reaches.
        const auto depth = std::max(3u, static_cast<uint32_t>(std::ceil(mesh.max_finite_sharpness())));
        const auto oracle =
            OsdOracle::create(mesh, last_level_within(mesh, depth, limits.max_vertices), nullptr);
        deviates = oracle && extrapolates(mesh, *oracle);
    }
    CheckLimits shallow = limits;  // the two modes differ in rules, not in depth
    shallow.max_level = std::min(limits.max_level, 3u);
    const Checker shallow_checker(mesh, shallow);
    bool same = false;
    shallow_checker.check_topology_and_points(control, !deviates, same);
    if (same && !deviates) shallow_checker.check_limits(false, control);
}

}  // namespace limn::test
