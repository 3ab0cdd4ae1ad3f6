#include "limn/schemes/characteristic_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "limn/schemes/star.h"

namespace limn {
namespace {

using Complex = std::complex<double>;
using Points = std::vector<Complex>;

double cross(Complex a, Complex b) {
    return a.real() * b.imag() - a.imag() * b.real();
}

bool has_positive_corners(const Topology& t, uint32_t f, const Points& points) {
    double size = 0;
    for (const uint32_t v : t.vertices_of_face(f))
        size = std::max(size, std::abs(points[v] - points[t.vertices_of_face(f)[0]]));
    for (uint32_t c = t.face_begin(f), i = t.size_of_face(f); i-- != 0; ++c) {
        const Complex at = points[t.face_vertices[c]];
        const Complex next = points[end_vertex(t, c)] - at,
                      previous = points[t.face_vertices[t.previous_corner(c)]] - at;
        if (cross(next, previous) <= 1e-9 * size * size) return false;
    }
    return true;
}

/// Refined points, and the outermost point of the patch that each depends on.
struct RefinedMap {
    Stage stage;
    Points points;
    std::vector<uint32_t> reach;
};
RefinedMap refine_map(RefinedMap&& map, const SubdivisionScheme& scheme) {
    StageStep step = refine_stage(std::move(map.stage), scheme, {});
    RefinedMap out{std::move(step.child), Points(step.rows.size()), std::vector<uint32_t>(step.rows.size(), 0)};
    for (size_t r = 0; r < step.rows.size(); ++r)
        for (const RowEntry& entry : step.rows[r]) {
            out.points[r] += entry.weight * map.points[entry.index];
            out.reach[r] = std::max(out.reach[r], map.reach[entry.index]);
        }
    return out;
}

/// All faces that points below `limit` decide, refined twice: those near the patch's cuts depend on others, too.
bool is_regular_map(const SubdivisionScheme& scheme, const StarPatch& patch, const Points& points, uint32_t limit) {
    RefinedMap map{Stage(patch.stage), points, {}};
    for (uint32_t v = 0; v < patch.size(); ++v) map.reach.push_back(v);
    for (int i = 0; i < 2; ++i) map = refine_map(std::move(map), scheme);
    const Topology& t = map.stage.topology;
    for (uint32_t f = 0; f < t.face_count; ++f) {
        const auto vertices = t.vertices_of_face(f);
        const bool decided =
            std::all_of(vertices.begin(), vertices.end(), [&](uint32_t v) { return map.reach[v] < limit; });
        if (decided && !has_positive_corners(t, f, map.points)) return false;
    }
    return true;
}

/// Around the faces of the map, counter-clockwise.
Points outline_of(const SchemeAnalysis& map) {
    std::vector<std::pair<uint32_t, uint32_t>> edges;
    size_t begin = 0;
    for (const uint32_t n : map.face_sizes) {
        for (size_t i = 0; i < n; ++i)
            edges.emplace_back(map.face_vertices[begin + i], map.face_vertices[begin + (i + 1) % n]);
        begin += n;
    }
    std::sort(edges.begin(), edges.end());
    std::vector<uint32_t> next(map.point_count(), kInvalidIndex);
    uint32_t v = kInvalidIndex;
    for (const auto& [a, b] : edges)
        if (!std::binary_search(edges.begin(), edges.end(), std::pair(b, a))) {
            next[a] = b;
            v = a;
        }
    Points outline;
    for (; v != kInvalidIndex && next[v] != kInvalidIndex; v = std::exchange(next[v], kInvalidIndex))
        outline.emplace_back(map.points[2 * size_t{v}], map.points[2 * size_t{v} + 1]);
    return outline;
}

bool do_cross(Complex a, Complex b, Complex c, Complex d) {
    return cross(b - a, c - a) * cross(b - a, d - a) < 0 && cross(d - c, a - c) * cross(d - c, b - c) < 0;
}

/// A disk without folds whose outline turns once and crosses itself nowhere covers each point once.
bool is_simple(const Points& outline) {
    const size_t n = outline.size();
    double turn = 0;
    for (size_t i = 0; i < n; ++i) {
        const Complex a = outline[i], b = outline[(i + 1) % n], c = outline[(i + 2) % n];
        turn += std::arg((c - b) / (b - a));
        for (size_t k = i + 2; k < n; ++k)
            if ((k + 1) % n != i && do_cross(a, b, outline[k], outline[(k + 1) % n])) return false;
    }
    return n > 2 && std::abs(turn - 2 * std::numbers::pi) < 1e-6;
}

}  // namespace

uint32_t map_rings(const SubdivisionScheme& scheme, uint32_t rings) {
    return std::max(rings, scheme.rings) + 2 * scheme.rings + 1;
}

Eigen::VectorXcd extend_map(const StarChain& chain, Eigen::VectorXcd inner, std::complex<double> factor) {
    // Outer points depend on ones further in: after as many steps as there are rings nothing changes.
    for (int i = 0; i < 24; ++i) inner = chain.step(std::move(inner)) / factor;
    return inner;
}

void draw_map(const SubdivisionScheme& scheme, const StarPatch& patch, uint32_t rings, const Eigen::VectorXcd& points,
              SchemeAnalysis& out) {
    const Topology& t = patch.stage.topology;
    const uint32_t count = patch.ring_ends[rings];
    for (uint32_t v = 0; v < count; ++v) out.points.insert(out.points.end(), {points[v].real(), points[v].imag()});
    for (uint32_t f = 0; f < t.face_count; ++f) {
        const auto vertices = t.vertices_of_face(f);
        const uint32_t outermost = *std::max_element(vertices.begin(), vertices.end());
        if (outermost >= count) continue;
        uint32_t ring = 0;
        while (outermost >= patch.ring_ends[ring]) ++ring;
        out.face_sizes.push_back(static_cast<uint32_t>(vertices.size()));
        out.face_vertices.insert(out.face_vertices.end(), vertices.begin(), vertices.end());
        out.face_rings.push_back(ring);
    }
    const uint32_t limit = patch.ring_ends[std::max(rings, scheme.rings) + scheme.rings];
    out.map_is_regular = is_regular_map(scheme, patch, Points(points.begin(), points.end()), limit);
    out.map_is_injective = is_simple(outline_of(out));
}

}  // namespace limn
