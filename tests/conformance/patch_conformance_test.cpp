// limn's limit surface against OpenSubdiv's: adaptive patches of Far at level 10, Bfr at level 10, and the
// limits of uniformly refined vertices, which are the truth. And against itself across borders.
//
// What is left out, by the names that the log counts it under, and why:
// - "Chaikin creasing that extrapolates": meshes on which OpenSubdiv's edge blend does (refinement_checks.h).
//   limn's compatible mode is compared, its own is not.
// - "semi-sharp features in adaptive refinement": meshes on which Far departs from OpenSubdiv's own uniform
//   refinement. With Chaikin creasing it averages sharpness over the edges around a vertex that it has
//   refined, and edges between holes are not among them; and some meshes that are not manifold it has
//   otherwise. The uniform refinement stays the oracle. Likewise where sharpness lasts too long to refine
//   uniformly, so that nobody can tell.
// - "sign of second derivatives in turned triangles": Far's is wrong, against its own first derivatives.
//   Compared with the sign turned back.
// - "limits at infinitely sharp darts", "limits at interior vertices of two faces": OpenSubdiv takes the
// smooth
//   mask there, and a corner's. The vertex itself is left out, and the end caps that begin at those of two
//   faces; the surface around them is compared.
// - "normals at irregular creases, boundaries and corners": OpenSubdiv's cross tangents are those of other
//   rules, and corners of several faces have no tangent plane.
// - "normals across sharp edges": there are two. "normals where tangents are parallel": there is none.
// - "limit normals that OpenSubdiv cannot compute": where a vertex that is not manifold is a crease.
// - "Bfr, ...": Bfr 3.5 averages Chaikin creasing in a way of its own, and reads past its arrays where the
//   mesh is not manifold or an interior vertex has two faces.
// - "limits deeper than can be refined": sharpness that outlasts the levels that there is memory for.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "conformance/neighbourhood.h"
#include "conformance/patch_checks.h"
#include "conformance/refinement_checks.h"
#include "shapes/random_mesh.h"

namespace limn::test {
namespace {

constexpr uint32_t kIsolationLevel = 10;

struct Effort {
    uint64_t max_refined_vertices = 10000;
    uint32_t max_refinement_level = 6;
};

uint32_t last_level_within(const TestMesh& mesh, uint32_t max_level, uint64_t max_vertices) {
    uint32_t level = 1;
    while (level < max_level && OsdOracle::estimate_vertex_count(mesh, level + 1) <= max_vertices) ++level;
    return level;
}

// One corner of each refined vertex: what borders have in common is compared by check_borders.
std::vector<RefinedCorner> corners_to_compare(const OsdOracle& oracle, bool triangles, uint32_t ptex_count) {
    std::vector<uint8_t> seen(oracle.vertex_count(oracle.level_count() - 1), 0);
    std::vector<RefinedCorner> result;
    for (const RefinedCorner& corner : refined_corners(oracle, triangles)) {
        if (corner.place.face % stride_of(ptex_count) != 0) continue;
        if (std::exchange(seen[corner.vertex], uint8_t{1}) == 0) result.push_back(corner);
    }
    return result;
}

struct Checker {
    const TestMesh& mesh;
    const Effort& effort;
    std::vector<double> control_points;
    bool triangles, exact;
    double tolerance;
    uint32_t sharp_levels;
    std::unique_ptr<OsdOracle> uniform, shallow;  // as deep as can be; where no finite sharpness is left
    std::vector<RefinedCorner> corners;           // of `uniform`
    std::unique_ptr<OsdPatchOracle> patches;
    std::vector<PatchSample> places;
    std::vector<OsdPlace> far, bfr;

    Checker(const TestMesh& m, const Effort& e);
    PatchCheckLog& log() const { return patch_check_log(exact); }
    bool is_chaikin() const {
        return mesh.options.creasing == CreasingMethod::chaikin && mesh.max_finite_sharpness() > 0;
    }
    std::vector<uint8_t> vertices_with_limits(const OsdOracle& oracle) const;
    bool far_is_self_consistent() const;
    bool bfr_is_safe() const;
    void check(bool compatible) const;
    void check_limits(const SurfaceUnderTest& surface) const;
    void check_limit_normals(const SurfaceUnderTest& surface) const;
};

Checker::Checker(const TestMesh& m, const Effort& e)
    : mesh(m), effort(e), control_points(m.positions_double()) {
    triangles = mesh.options.scheme == Scheme::loop;
    exact = !has_inexact_fading(mesh);
    tolerance = exact ? kSurfaceTolerance : kFadingSurfaceTolerance;
    sharp_levels = std::max(1u, static_cast<uint32_t>(std::ceil(mesh.max_finite_sharpness())));
    std::string error;
    const uint32_t level =
        std::max(last_level_within(mesh, effort.max_refinement_level, effort.max_refined_vertices),
                 last_level_within(mesh, sharp_levels, 60000));
    uniform = OsdOracle::create(mesh, level, &error);
    shallow = OsdOracle::create(mesh, std::min(level, sharp_levels), &error);
    patches = OsdPatchOracle::create(mesh, kIsolationLevel, &error);
    if (!uniform || !shallow || !patches) {
        ADD_FAILURE() << mesh.name << ": OpenSubdiv refuses it: " << error;
        return;
    }
    if (level >= sharp_levels)
        corners = corners_to_compare(*uniform, triangles, patches->ptex_face_count());
    else
        leave_out("limits deeper than can be refined");
    places = scattered_places(patches->ptex_face_count(), triangles, 5);
    if (far_is_self_consistent())
        far = patches->far_places(control_points, places);
    else
        leave_out("semi-sharp features in adaptive refinement (meshes)");
    if (!far.empty() && bfr_is_safe()) bfr = patches->bfr_places(control_points, kIsolationLevel, places);
}

// 1 where OpenSubdiv's limit is that of its refinement.
std::vector<uint8_t> Checker::vertices_with_limits(const OsdOracle& oracle) const {
    const uint32_t last = oracle.level_count() - 1;
    const std::vector<VertexRule> rules = oracle.vertex_rules(last);
    const std::vector<uint32_t> faces = oracle.vertex_face_counts(last);
    const std::vector<uint8_t> boundary = oracle.vertex_boundaries(last);
    std::vector<uint8_t> result(rules.size(), 1);
    for (size_t v = 0; v < rules.size(); ++v) {
        const bool smooth = rules[v] == VertexRule::smooth || rules[v] == VertexRule::dart;
        if (mesh.options.scheme == Scheme::bilinear) continue;
        if (rules[v] == VertexRule::dart) {
            leave_out("limits at infinitely sharp darts");
            result[v] = 0;
        } else if (smooth && faces[v] == 2 && !boundary[v]) {
            leave_out("limits at interior vertices of two faces");
            result[v] = 0;
        }
    }
    return result;
}

bool Checker::far_is_self_consistent() const {
    const std::vector<uint8_t> manifold = uniform->vertex_manifold(0);
    const bool all_manifold = std::find(manifold.begin(), manifold.end(), 0) == manifold.end();
    if (!is_chaikin() && (all_manifold || mesh.max_finite_sharpness() == 0)) return true;
    if (corners.empty()) return false;
    const OsdOracle::Limits limits = uniform->limits(control_points);
    const std::vector<uint8_t> compared = vertices_with_limits(*uniform);
    std::vector<PatchSample> samples;
    for (const RefinedCorner& corner : corners) samples.push_back(corner.place);
    const std::vector<OsdPlace> at = patches->far_places(control_points, samples);
    double worst = 0;
    for (size_t c = 0; c < corners.size(); ++c) {
        if (!at[c].valid || !compared[corners[c].vertex]) continue;
        worst = std::max(worst, length(vector_at(limits.positions, corners[c].vertex) - at[c].values[0]));
    }
    return worst <= kFadingSurfaceTolerance * mesh.size();
}

bool Checker::bfr_is_safe() const {
    if (is_chaikin()) {
        leave_out("Bfr, Chaikin creasing (meshes)");
        return false;
    }
    const std::vector<uint8_t> manifold = uniform->vertex_manifold(0),
                               boundary = uniform->vertex_boundaries(0);
    const std::vector<uint32_t> faces = uniform->vertex_face_counts(0);
    for (size_t v = 0; v < faces.size(); ++v) {
        const bool two = faces[v] == 2 && !boundary[v];
        if (manifold[v] && !two) continue;
        leave_out(two ? "Bfr, interior vertices of two faces (meshes)" : "Bfr, non-manifold (meshes)");
        return false;
    }
    return true;
}

// Both sides of borders, and 1 where normals agree across.
struct Borders {
    std::vector<PatchSample> one, other;
    std::vector<uint8_t> smooth;

    void add(const PatchSample& a, const PatchSample& b, bool is_smooth) {
        one.push_back(a);
        other.push_back(b);
        smooth.push_back(is_smooth ? 1 : 0);
    }
};

constexpr double kAlongBorders[] = {0, 0.0013, 0.3, 0.5, 0.97, 1};

// Edges of the control mesh. At their ends lie vertices that may have no normal.
void add_edges(const SurfaceUnderTest& s, Borders& borders) {
    const Topology& t = s.base;
    const bool linear = t.options.scheme == Scheme::bilinear;
    for (uint32_t e = 0; e < t.edge_count; e += stride_of(t.edge_count)) {
        const auto corners = t.corners_of_edge(e);
        if (t.edge_vertices[2 * e] == t.edge_vertices[2 * e + 1]) continue;
        const bool smooth = corners.size() == 2 && !is_infinite(t.edge_sharpness[e]) && !linear;
        if (!smooth) leave_out("normals across sharp edges (edges)");
        for (size_t i = 1; i < corners.size(); ++i) {
            const uint32_t a = corners[0], b = corners[i], f = t.face_of_corner(a), g = t.face_of_corner(b);
            const bool same_way = t.face_vertices[a] == t.face_vertices[b];
            for (const double x : kAlongBorders)
                borders.add(s.place_on_edge(f, a - t.face_begin(f), x),
                            s.place_on_edge(g, b - t.face_begin(g), same_way ? x : 1 - x),
                            smooth && x > 0 && x < 1);
        }
    }
}

// The lines along which ptex faces may be split, and those between the ptex faces of a polygon.
void add_inner_borders(const SurfaceUnderTest& s, Borders& borders) {
    const bool linear = s.mesh.options.scheme == Scheme::bilinear;
    const auto ptex_count = static_cast<uint32_t>(s.ptex_faces.size());
    for (uint32_t p = 0; p < ptex_count; p += stride_of(ptex_count)) {
        const SurfaceUnderTest::PtexFace& ptex = s.ptex_faces[p];
        for (const double line : {0.5, 0.75}) {
            const double beyond = std::nextafter(line, 1.0);
            for (const double x : kAlongBorders) {
                const double y = s.triangles ? x * (1 - beyond) : x;
                borders.add({p, line, y}, {p, beyond, y}, !linear && x > 0 && x < 1);
                borders.add({p, y, line}, {p, y, beyond}, !linear && x > 0 && x < 1);
                if (!s.triangles) continue;
                const double u = x * line, v = line - u;
                borders.add({p, u, std::max(0.0, v - 0x1p-52)}, {p, u, v + 0x1p-52}, x > 0 && x < 1);
            }
        }
        if (ptex.whole) continue;
        const uint32_t next = s.first_ptex[ptex.face] + (ptex.corner + 1) % s.base.size_of_face(ptex.face);
        for (const double x : kAlongBorders) borders.add({p, 1, x}, {next, x, 1}, !linear && x > 0 && x < 1);
    }
}

void check_borders(const SurfaceUnderTest& surface, PatchCheckLog& log) {
    Borders borders;
    add_edges(surface, borders);
    add_inner_borders(surface, borders);
    EXPECT_TRUE(same_borders(surface, surface.evaluate(borders.one, Derivatives::first),
                             surface.evaluate(borders.other, Derivatives::first), borders.smooth, log));
}

void Checker::check_limits(const SurfaceUnderTest& surface) const {
    if (corners.empty()) return;
    const OsdOracle::Limits limits = uniform->limits(control_points);
    const std::vector<uint8_t> compared = vertices_with_limits(*uniform);
    std::vector<PatchSample> samples;
    for (const RefinedCorner& corner : corners) samples.push_back(corner.place);
    const SurfaceUnderTest::Values ours = surface.evaluate(samples, Derivatives::none);
    for (size_t c = 0; c < corners.size(); ++c) {
        if (ours.statuses[c] != SampleStatus::valid || !compared[corners[c].vertex]) continue;
        const Vector off = ours.at(c, 0) - vector_at(limits.positions, corners[c].vertex);
        const double error = length(off) / surface.size;
        ++log().limit_count;
        log().limits = std::max(log().limits, error);
        if (error <= tolerance) continue;
        const PatchSample& place = corners[c].place;
        ADD_FAILURE() << "limit of refined vertex " << corners[c].vertex << ", ptex face " << place.face
                      << " (" << place.u << ", " << place.v << "), is off by " << error;
        return;
    }
}

void Checker::check_limit_normals(const SurfaceUnderTest& surface) const {
    if (corners.empty() || mesh.options.scheme == Scheme::bilinear) return;
    const uint32_t last = shallow->level_count() - 1;
    const OsdOracle::Limits limits = shallow->limits(control_points);
    if (limits.tangents1.empty()) return leave_out("limit normals that OpenSubdiv cannot compute (meshes)");
    const std::vector<RefinedCorner> at = corners_to_compare(*shallow, triangles, patches->ptex_face_count());
    std::vector<PatchSample> samples;
    for (const RefinedCorner& corner : at) samples.push_back(corner.place);
    const SurfaceUnderTest::Values ours = surface.evaluate(samples, Derivatives::first);
    const std::vector<VertexRule> rules = shallow->vertex_rules(last);
    const std::vector<uint32_t> faces = shallow->vertex_face_counts(last);
    const std::vector<uint8_t> boundary = shallow->vertex_boundaries(last),
                               manifold = shallow->vertex_manifold(last),
                               compared = vertices_with_limits(*shallow);
    for (size_t c = 0; c < at.size(); ++c) {
        const uint32_t v = at[c].vertex;
        if (ours.statuses[c] != SampleStatus::valid || !compared[v]) continue;
        const bool smooth = rules[v] == VertexRule::smooth && !boundary[v] && manifold[v];
        const bool edge =
            rules[v] == VertexRule::crease && boundary[v] && manifold[v] && faces[v] == (triangles ? 3 : 2);
        if (!smooth && !edge) {
            leave_out("normals at irregular creases, boundaries and corners (limits)");
            continue;
        }
        const Vector theirs = cross(vector_at(limits.tangents1, v), vector_at(limits.tangents2, v));
        if (ours.sine(c) < 1e-3 || length(theirs) < 1e-9 * surface.size * surface.size) {
            leave_out("normals where tangents are parallel (limits)");
            continue;
        }
        const double bound = exact ? kLimitNormalTolerance : kFadingLimitNormalTolerance;
        const double degrees = angle(ours.normal(c), theirs);
        ++log().limit_normal_count;
        log().limit_normal = std::max(log().limit_normal, degrees / bound);
        if (degrees <= bound) continue;
        ADD_FAILURE() << "normal at refined vertex " << v << " of " << faces[v] << " faces is off by "
                      << degrees << " degrees of " << bound;
        return;
    }
}

void Checker::check(bool compatible) const {
    SCOPED_TRACE(compatible ? "compatible" : "default");
    const SurfaceUnderTest surface(mesh, compatible);
    ASSERT_EQ(surface.ptex_faces.size(), patches->ptex_face_count());
    check_borders(surface, log());
    if (!compatible && is_chaikin() && extrapolates(mesh, *uniform))
        return leave_out("Chaikin creasing that extrapolates (meshes)");
    check_limits(surface);
    check_limit_normals(surface);
    const SurfaceUnderTest::Values ours = surface.evaluate(places, Derivatives::second);
    if (far.empty()) return;
    EXPECT_TRUE(same_regular_places(surface, ours, far, tolerance, log()));
    EXPECT_TRUE(near_caps(surface, places, ours, far, log()));
    if (bfr.empty()) return;
    EXPECT_TRUE(near_bfr(surface, ours, far, bfr, log()));
}

void check_patches(const TestMesh& mesh, const Effort& effort) {
    const Checker checker(mesh, effort);
    if (!checker.patches) return;
    checker.check(false);
    if (mesh.options.creasing == CreasingMethod::chaikin) return checker.check(true);
    // Nothing else depends on the mode.
    const SurfaceUnderTest surfaces[] = {{mesh, false}, {mesh, true}};
    EXPECT_TRUE(same_numbers(surfaces[0].evaluate(checker.places, Derivatives::none).numbers,
                             surfaces[1].evaluate(checker.places, Derivatives::none).numbers,
                             kDoubleTolerance * mesh.size()))
        << "compatible mode";
}

class PatchConformance : public testing::TestWithParam<size_t> {
  public:
    static const std::vector<TestMesh>& shapes() {
        static const std::vector<TestMesh> all = all_shapes();
        return all;
    }
    static void TearDownTestSuite() { print_patch_check_log(); }
};

TEST_P(PatchConformance, equals_opensubdiv) {
    check_patches(shapes()[GetParam()], {});
}

INSTANTIATE_TEST_SUITE_P(Shapes, PatchConformance,
                         testing::Range(size_t{0}, PatchConformance::shapes().size()),
                         [](const auto& info) { return PatchConformance::shapes()[info.param].name; });

// LIMN_RANDOM_COUNT and LIMN_RANDOM_SEED as in random_conformance_test.cpp.
TEST(RandomPatchConformance, equals_opensubdiv) {
    auto from_environment = [](const char* name, uint64_t otherwise) {
        const char* text = std::getenv(name);
        return text ? std::strtoull(text, nullptr, 10) : otherwise;
    };
    const uint64_t count = from_environment("LIMN_RANDOM_COUNT", 300),
                   first = from_environment("LIMN_RANDOM_SEED", 1);
    uint32_t failures = 0;
    for (uint64_t seed = first; seed < first + count; ++seed) {
        SCOPED_TRACE("LIMN_RANDOM_SEED=" + std::to_string(seed));
        const auto* result = testing::UnitTest::GetInstance()->current_test_info()->result();
        const int before = result->total_part_count();
        check_patches(random_mesh(seed), {.max_refined_vertices = 3000, .max_refinement_level = 5});
        if (result->total_part_count() > before && ++failures == 20) break;  // enough to see what is wrong
    }
    print_patch_check_log();
}

}  // namespace
}  // namespace limn::test
