#include "conformance/patch_checks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "conformance/refinement_checks.h"
#include "shapes/random_mesh.h"

namespace limn::test {
namespace {

// Below these, tangents have no normal worth comparing: their sine, and their length in sizes of the mesh.
constexpr double kDegenerateSine = 1e-3, kDegenerateLength = 1e-9;

ControlMesh control_mesh(const TestMesh& mesh, bool compatible) {
    TestMesh copy = mesh;
    copy.options.opensubdiv_compatible = compatible;
    auto control = ControlMesh::create(copy.description());
    EXPECT_TRUE(control) << mesh.name;
    return control ? std::move(control).value() : ControlMesh{};
}

// Makes tables of hundreds of meshes fast; the result does not depend on it.
const PlanCache& shared_plans() {
    static const PlanCache cache;
    return cache;
}

std::map<std::string, uint64_t>& left_out() {
    static std::map<std::string, uint64_t> counts;
    return counts;
}

double length_of(const Vector& a, const std::array<double, 3>& b) {
    return length(a - b);
}

// What rings around a smooth vertex shrink by in a level: the eigenvalue of the waves that go around
// `frequency` times.
double ring_eigenvalue(bool triangles, uint32_t valence, uint32_t frequency) {
    const double c = std::cos(2 * std::numbers::pi * frequency / valence);
    return triangles ? 3.0 / 8 + c / 4 : (5 + c + std::sqrt((c + 9) * (c + 1))) / 16;
}

// How much faster than the tangent plane the bending around a smooth vertex fades from level to level.
double bending_ratio(bool triangles, uint32_t valence) {
    const double saddle = valence > 3 ? ring_eigenvalue(triangles, valence, 2) : 0;
    return std::max(0.25, saddle) / ring_eigenvalue(triangles, valence, 1);
}

// Degrees by which the normal of an end cap may be off that is `levels` levels above a smooth vertex: 40 for
// none (up to 8 are seen at the first levels of ordinary meshes, 22 at poles of 64 faces), and less by the
// ratio of the bending to the tangents for each.
double normal_bound(bool triangles, uint32_t valence, double levels) {
    return std::max(0.1, 40 * std::pow(bending_ratio(triangles, valence), std::max(levels, 0.0)));
}

// The vertex at the corner of its ptex face that a place is closest to, or kInvalidIndex within polygons.
uint32_t closest_vertex(const SurfaceUnderTest& s, const PatchSample& place) {
    const SurfaceUnderTest::PtexFace& ptex = s.ptex_faces[place.face];
    const bool right = place.u > 0.5, upper = place.v > 0.5;
    uint32_t corner = ptex.corner;
    if (!ptex.whole && (right || upper)) return kInvalidIndex;
    if (right || upper) corner = s.triangles ? (right ? 1 : 2) : (right ? (upper ? 2 : 1) : 3);
    return s.base.vertices_of_face(ptex.face)[corner];
}

bool is_interior(const Topology& t, uint32_t v) {
    return t.vertex_manifold[v] != 0 && t.edges_of_vertex(v).size() == t.corners_of_vertex(v).size();
}

// The valence of the smooth interior vertex that a place is closest to; zero where that is anything else.
uint32_t smooth_valence(const SurfaceUnderTest& s, const PatchSample& place) {
    const Topology& t = s.base;
    const uint32_t v = closest_vertex(s, place);
    if (v == kInvalidIndex)
        return place.u > 0.5 && place.v > 0.5 ? t.size_of_face(s.ptex_faces[place.face].face) : 0;
    if (!is_interior(t, v) || is_infinite(t.vertex_sharpness[v])) return 0;
    const auto edges = t.edges_of_vertex(v);
    for (const uint32_t e : edges)
        if (is_infinite(t.edge_sharpness[e])) return 0;
    return edges.size() > 2 ? static_cast<uint32_t>(edges.size()) : 0;
}

// OpenSubdiv's end caps begin at the limit of a corner there.
bool is_at_two_faces(const SurfaceUnderTest& s, const PatchSample& place) {
    const uint32_t v = closest_vertex(s, place);
    return v != kInvalidIndex && is_interior(s.base, v) && s.base.corners_of_vertex(v).size() == 2;
}

}  // namespace

SurfaceUnderTest::SurfaceUnderTest(const TestMesh& m, bool compatible)
    : mesh(m), control_points(m.positions_double()), size(m.size()) {
    const ControlMesh control = control_mesh(m, compatible);
    auto built = build_patch_table<double>(control, {}, &shared_plans());
    EXPECT_TRUE(built) << m.name;
    if (!built) return;
    table = std::move(built).value();
    base = build_topology(control);
    triangles = m.options.scheme == Scheme::loop;
    points.resize(size_t{table.point_count()} * 3);
    build_patch_points(table, control_points, 3, points);
    for (uint32_t f = 0; f < base.face_count; ++f) {
        first_ptex.push_back(static_cast<uint32_t>(ptex_faces.size()));
        const uint32_t face_size = base.size_of_face(f);
        const bool whole = face_size == (triangles ? 3u : 4u);
        for (uint32_t c = 0; c < (whole ? 1 : face_size); ++c) ptex_faces.push_back({f, c, whole});
    }
}

double SurfaceUnderTest::Values::sine(size_t sample) const {
    const double product = length(at(sample, 1)) * length(at(sample, 2));
    return product > 0 ? length(normal(sample)) / product : 0;
}

SurfaceUnderTest::Values SurfaceUnderTest::evaluate(std::span<const PatchSample> samples,
                                                    Derivatives derivatives) const {
    const uint32_t count = value_count(derivatives);
    Values values{count, std::vector<double>(samples.size() * count * 3),
                  std::vector<SampleStatus>(samples.size())};
    evaluate_patches(table, samples, points, 3, derivatives, values.numbers, values.statuses);
    return values;
}

PatchSample SurfaceUnderTest::place_on_edge(uint32_t f, uint32_t c, double t) const {
    const uint32_t first = first_ptex[f], face_size = base.size_of_face(f);
    if (!ptex_faces[first].whole) {
        if (t <= 0.5) return {first + c, 2 * t, 0};
        return {first + (c + 1) % face_size, 0, 2 * (1 - t)};
    }
    if (c == 0) return {first, t, 0};
    if (triangles) return c == 1 ? PatchSample{first, 1 - t, t} : PatchSample{first, 0, 1 - t};
    return c == 1   ? PatchSample{first, 1, t}
           : c == 2 ? PatchSample{first, 1 - t, 1}
                    : PatchSample{first, 0, 1 - t};
}

std::vector<PatchSample> scattered_places(uint32_t ptex_face_count, bool triangles, uint64_t seed) {
    RandomNumbers random(seed);
    std::vector<PatchSample> places;
    for (uint32_t f = 0; f < ptex_face_count; f += stride_of(ptex_face_count)) {
        for (uint32_t i = 0; i < 12; ++i) {
            double u = random.uniform(0, 1), v = random.uniform(0, 1);
            if (triangles && u + v > 1) {
                u = 1 - u;
                v = 1 - v;
            }
            const double scale = i % 2 == 0 ? 1 : std::exp2(-static_cast<double>(random.below(14)));
            u *= scale;
            v *= scale;
            for (uint32_t turn = random.below(triangles ? 3 : 4); turn > 0; --turn)
                v = std::exchange(u, 1 - v - (triangles ? u : 0));
            places.push_back({f, std::clamp(u, 0.0, 1.0), std::clamp(v, 0.0, 1.0)});
        }
    }
    return places;
}

namespace {

// Refined faces are visited in their order; a negative size means turned by 180 degrees.
struct Walk {
    std::vector<uint32_t> vertices;
    bool triangles;
    std::vector<RefinedCorner> corners;

    void visit(uint32_t ptex, double u, double v, double size, uint32_t levels) {
        if (levels == 0) {
            constexpr double us[2][4] = {{0, 1, 1, 0}, {0, 1, 0, 0}}, vs[2][4] = {{0, 0, 1, 1}, {0, 0, 1, 0}};
            for (size_t k = 0; k < (triangles ? 3u : 4u); ++k)
                corners.push_back({vertices[corners.size()],
                                   {ptex, u + size * us[triangles][k], v + size * vs[triangles][k]}});
            return;
        }
        const double h = size / 2;
        visit(ptex, u, v, h, levels - 1);
        visit(ptex, u + h, v, h, levels - 1);
        visit(ptex, triangles ? u : u + h, v + h, h, levels - 1);
        visit(ptex, triangles ? u + h : u, v + h, triangles ? -h : h, levels - 1);
    }
};

}  // namespace

std::vector<RefinedCorner> refined_corners(const OsdOracle& oracle, bool triangles) {
    const uint32_t level = oracle.level_count() - 1;
    Walk walk{oracle.face_vertices(level), triangles, {}};
    uint32_t ptex = 0;
    for (const uint32_t size : oracle.face_sizes(0)) {
        const bool whole = size == (triangles ? 3u : 4u);
        for (uint32_t c = 0; c < (whole ? 1 : size); ++c)
            walk.visit(ptex++, 0, 0, 1, level - (whole ? 0 : 1));
    }
    return walk.corners;
}

PatchCheckLog& patch_check_log(bool exact) {
    static PatchCheckLog logs[2];
    return logs[exact];
}

void leave_out(const std::string& name, uint64_t count) {
    if (count > 0) left_out()[name] += count;
}

void print_patch_check_log() {
    for (bool exact : {true, false}) {
        const PatchCheckLog& w = patch_check_log(exact);
        std::printf(
            "worst differences%s: P %.1e, du %.1e, dv %.1e, duu %.1e, duv %.1e, dvv %.1e (%zu regular "
            "places); "
            "end caps %.2f of their size, %.4f off the surface (%zu), normals %.2f of the bound (%zu); "
            "Bfr %.1e of its bound (%zu); limits %.1e (%zu), their normals %.2f of the bound (%zu); "
            "borders %.1e (%zu), normals %.1e degrees (%zu)\n",
            exact ? "" : " where sharpness fades", w.regular[0], w.regular[1], w.regular[2], w.regular[3],
            w.regular[4], w.regular[5], size_t{w.regular_count}, w.cap_position, w.cap_off_surface,
            size_t{w.cap_count}, w.cap_normal, size_t{w.cap_normal_count}, w.bfr, size_t{w.bfr_count},
            w.limits, size_t{w.limit_count}, w.limit_normal, size_t{w.limit_normal_count}, w.border,
            size_t{w.border_count}, w.border_normal, size_t{w.border_normal_count});
    }
    for (const auto& [name, count] : left_out())
        std::printf("left out, %s: %zu\n", name.c_str(), size_t{count});
}

testing::AssertionResult same_regular_places(const SurfaceUnderTest& surface,
                                             const SurfaceUnderTest::Values& ours,
                                             std::span<const OsdPlace> theirs, double tolerance,
                                             PatchCheckLog& log) {
    for (size_t s = 0; s < theirs.size(); ++s) {
        const OsdPlace& place = theirs[s];
        if ((ours.statuses[s] == SampleStatus::valid) != place.valid)
            return testing::AssertionFailure() << "sample " << s << " has a surface on one side only";
        if (!place.valid || !place.regular) continue;
        ++log.regular_count;
        for (size_t k = 0; k < 6; ++k) {
            std::array<double, 3> expected = place.values[k];
            if (k > 2 && place.turned)
                for (double& x : expected) x = -x;
            const double unit = surface.size * std::exp2((k > 2 ? 2.0 : k > 0 ? 1.0 : 0.0) * place.depth);
            const double error = length_of(ours.at(s, k), expected) / unit;
            log.regular[k] = std::max(log.regular[k], error);
            if (!(error <= tolerance))
                return testing::AssertionFailure() << "value " << k << " at sample " << s << ", depth "
                                                   << place.depth << ", is off by " << error;
        }
        if (place.turned) leave_out("sign of second derivatives in turned triangles");
    }
    return testing::AssertionSuccess();
}

testing::AssertionResult near_caps(const SurfaceUnderTest& surface, std::span<const PatchSample> samples,
                                   const SurfaceUnderTest::Values& ours, std::span<const OsdPlace> theirs,
                                   PatchCheckLog& log) {
    const double sharp_levels = std::ceil(surface.mesh.max_finite_sharpness());
    for (size_t s = 0; s < theirs.size(); ++s) {
        const OsdPlace& place = theirs[s];
        if (!place.valid || place.regular || ours.statuses[s] != SampleStatus::valid) continue;
        if (is_at_two_faces(surface, samples[s])) {
            leave_out("end caps at interior vertices of two faces");
            continue;
        }
        ++log.cap_count;
        const Vector off = ours.at(s, 0) - place.values[0], normal = ours.normal(s);
        // Points far from the origin carry more rounding than the smallest caps measure.
        const double rounding = 1e-13 * surface.size;
        const double error = std::max(0.0, length(off) - rounding) / place.cap_size;
        log.cap_position = std::max(log.cap_position, error);
        if (!(error <= kCapTolerance))
            return testing::AssertionFailure()
                   << "sample " << s << " is off by " << error << " of the end cap";
        const Vector their_normal = cross(place.values[1], place.values[2]);
        const double their_sine = length(their_normal) / (length(place.values[1]) * length(place.values[2]));
        if (ours.sine(s) < kDegenerateSine || !(their_sine >= kDegenerateSine)) {
            leave_out("normals where tangents are parallel (end caps)");
            continue;
        }
        const double off_surface =
            std::max(0.0, std::abs(dot(off, normal)) / length(normal) - rounding) / place.cap_size;
        log.cap_off_surface = std::max(log.cap_off_surface, off_surface);
        if (!(off_surface <= kCapNormalTolerance))
            return testing::AssertionFailure()
                   << "sample " << s << " is off the surface by " << off_surface << " of the end cap";
        const uint32_t valence = smooth_valence(surface, samples[s]);
        if (valence == 0) {
            leave_out("normals at irregular creases, boundaries and corners (end caps)");
            continue;
        }
        // Caps of polygons begin at level 1, and what is sharp delays them.
        const double bound = normal_bound(surface.triangles, valence, place.depth - 1.0 - sharp_levels);
        const double degrees = angle(normal, their_normal);
        ++log.cap_normal_count;
        log.cap_normal = std::max(log.cap_normal, degrees / bound);
        if (!(degrees <= bound))
            return testing::AssertionFailure() << "normal at sample " << s << ", valence " << valence
                                               << ", is off by " << degrees << " degrees of " << bound;
    }
    return testing::AssertionSuccess();
}

testing::AssertionResult near_bfr(const SurfaceUnderTest& surface, const SurfaceUnderTest::Values& ours,
                                  std::span<const OsdPlace> far, std::span<const OsdPlace> bfr,
                                  PatchCheckLog& log) {
    for (size_t s = 0; s < bfr.size(); ++s) {
        if ((ours.statuses[s] == SampleStatus::valid) != bfr[s].valid)
            return testing::AssertionFailure() << "sample " << s << " has a surface on one side only";
        if (!bfr[s].valid) continue;
        ++log.bfr_count;
        const double cap = kCapTolerance * far[s].cap_size, bound = kBfrTolerance * surface.size + cap;
        const double error = length_of(ours.at(s, 0), bfr[s].values[0]);
        log.bfr = std::max(log.bfr, error / bound);
        if (!(error <= bound))
            return testing::AssertionFailure() << "sample " << s << " is off by " << error / surface.size;
        if (!far[s].regular) continue;
        for (size_t k = 1; k < 3; ++k) {
            const double derivative = length_of(ours.at(s, k), bfr[s].values[k]);
            if (!(derivative <= 5 * kBfrTolerance * surface.size * std::exp2(far[s].depth)))
                return testing::AssertionFailure()
                       << "value " << k << " at sample " << s << " is off by " << derivative;
        }
    }
    return testing::AssertionSuccess();
}

testing::AssertionResult same_borders(const SurfaceUnderTest& surface, const SurfaceUnderTest::Values& one,
                                      const SurfaceUnderTest::Values& other, std::span<const uint8_t> smooth,
                                      PatchCheckLog& log) {
    for (size_t s = 0; s < smooth.size(); ++s) {
        if (one.statuses[s] == SampleStatus::out_of_range || other.statuses[s] == SampleStatus::out_of_range)
            return testing::AssertionFailure() << "border place " << s << " is not on its face";
        if (one.statuses[s] != SampleStatus::valid || other.statuses[s] != SampleStatus::valid) continue;
        ++log.border_count;
        const double gap = length(one.at(s, 0) - other.at(s, 0)) / surface.size;
        log.border = std::max(log.border, gap);
        if (!(gap <= kBorderTolerance))
            return testing::AssertionFailure() << "border place " << s << " gapes by " << gap;
        if (smooth[s] == 0) continue;
        auto degenerate = [&](const SurfaceUnderTest::Values& v) {
            return v.sine(s) < kDegenerateSine ||
                   std::min(length(v.at(s, 1)), length(v.at(s, 2))) < kDegenerateLength * surface.size;
        };
        if (degenerate(one) || degenerate(other)) {
            leave_out("normals where tangents are parallel (borders)");
            continue;
        }
        const double bent = angle(one.normal(s), other.normal(s));
        ++log.border_normal_count;
        log.border_normal = std::max(log.border_normal, bent);
        if (!(bent <= kBorderAngle))
            return testing::AssertionFailure()
                   << "border place " << s << " is bent by " << bent << " degrees";
    }
    return testing::AssertionSuccess();
}

}  // namespace limn::test
