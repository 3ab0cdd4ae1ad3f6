// Catmull-Clark and Loop with curvature that is continuous, and zero, at irregular vertices: Prautzsch and Umlauf 1998
// to 2000. Their principle, not their coefficients: around an irregular vertex, where the step's matrix falls into one
// small block for each frequency of the discrete Fourier transform, all eigenvalues but 1 and the double subdominant
// one, lambda, are brought below lambda^2; eigenvectors stay. Vertices whose faces have another irregular vertex keep
// the ordinary masks: one step tells them apart. Semi-sharp creases are not defined in the literature.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "limn/scheme.h"
#include "limn/schemes/schemes.h"
#include "limn/schemes/star.h"

namespace limn::schemes {
namespace {

constexpr double kShare = 0.9;        ///< of lambda^2 that other eigenvalues have at most
constexpr double kLeastLambda = 0.4;  ///< its square is more than 1/8, which the next ring has

/// Points of a star: the vertex, its neighbours, the vertices opposite in its quads.
enum Point : uint32_t { kCenter, kEdge, kFace, kPointCount };

/// What a step does to one frequency of a star's points, phases counted from each point's own direction.
using Block = std::array<std::array<double, kPointCount>, kPointCount>;
using Eigenvalues = std::array<double, kPointCount>;

/// The matrix with the block's eigenvectors that has `to` for eigenvalues `from` (Newton's interpolation).
Block replace_eigenvalues(const Block& block, const Eigenvalues& from, const Eigenvalues& to) {
    auto slope = [](double a, double b, double dx) { return std::abs(dx) < 1e-12 ? 0 : (b - a) / dx; };
    const double first = slope(to[0], to[1], from[1] - from[0]), second = slope(to[1], to[2], from[2] - from[1]);
    const double both = slope(first, second, from[2] - from[0]);
    Block out;
    for (uint32_t i = 0; i < kPointCount; ++i)
        for (uint32_t j = 0; j < kPointCount; ++j) {
            double product = 0;  // of block - from[0] and block - from[1]
            for (uint32_t k = 0; k < kPointCount; ++k)
                product += (block[i][k] - (i == k ? from[0] : 0)) * (block[k][j] - (k == j ? from[1] : 0));
            out[i][j] = (i == j ? to[0] : 0) + first * (block[i][j] - (i == j ? from[0] : 0)) + both * product;
        }
    return out;
}

struct Frequency {
    Block block;
    Eigenvalues eigenvalues;  ///< the largest first; 0 for points that do not take part
};

Frequency catmull_clark_frequency(uint32_t n, uint32_t k) {
    const double angle = 2 * std::numbers::pi * k / n, c = std::cos(angle), half = std::cos(angle / 2);
    Frequency out = {{{{0, 0, 0}, {0, (3 + c) / 8, half / 8}, {0, half / 2, 0.25}}}, {}};
    if (k != 0) {
        const double root = std::sqrt(std::max(0.0, (c + 9) * (c + 1)));
        out.eigenvalues = {(5 + c + root) / 16, (5 + c - root) / 16, 0};
        return out;
    }
    const double root = std::sqrt(5.0 * n * n - 30.0 * n + 49);
    out.eigenvalues = {1, (3.0 * n - 7 + root) / (8 * n), (3.0 * n - 7 - root) / (8 * n)};
    out.block[kCenter] = {1 - 7.0 / (4 * n), 3.0 / (2 * n), 1.0 / (4 * n)};
    out.block[kEdge][kCenter] = 0.375;
    out.block[kFace][kCenter] = 0.25;
    return out;
}

Frequency loop_frequency(uint32_t n, uint32_t k) {
    const double ring = 0.375 + std::cos(2 * std::numbers::pi * k / n) / 4;
    if (k != 0) return {{{{0, 0, 0}, {0, ring, 0}, {0, 0, 0}}}, {ring, 0, 0}};
    const double beta = smooth_vertex_mask(Scheme::loop, n).edge;
    return {{{{1 - n * beta, n * beta, 0}, {0.375, ring, 0}, {0, 0, 0}}}, {1, ring - n * beta, 0}};
}

Block tuned_block(Scheme scheme, uint32_t n, uint32_t k) {
    auto frequency = [&](uint32_t i) {
        return scheme == Scheme::loop ? loop_frequency(n, i) : catmull_clark_frequency(n, i);
    };
    const Frequency ordinary = frequency(k);
    const double lambda = std::max(kLeastLambda, frequency(1).eigenvalues[0]), most = kShare * lambda * lambda;
    Eigenvalues tuned;
    for (uint32_t i = 0; i < kPointCount; ++i) tuned[i] = std::clamp(ordinary.eigenvalues[i], -most, most);
    if (k == 0) tuned[0] = 1;
    if (k == 1 || k == n - 1) tuned[0] = lambda;
    return replace_eigenvalues(ordinary.block, ordinary.eigenvalues, tuned);
}

bool is_irregular(const Topology& t, uint32_t v) {
    return !is_boundary_vertex(t, v) && face_valence(t, v) > 2 &&
           face_valence(t, v) != (t.options.scheme == Scheme::loop ? 6u : 4u);
}

/// An irregular vertex whose faces have the scheme's own size and no other irregular vertex.
bool is_tuned(const Topology& t, uint32_t v) {
    if (!is_irregular(t, v)) return false;
    const uint32_t size = t.options.scheme == Scheme::loop ? 3 : 4;
    for (const uint32_t c : t.corners_of_vertex(v)) {
        const uint32_t f = t.face_of_corner(c);
        if (t.size_of_face(f) != size) return false;
        for (const uint32_t other : t.vertices_of_face(f))
            if (other != v && is_irregular(t, other)) return false;
    }
    return true;
}

/// The point of kind `point` in the sector of v's edge `at`, after the step: the inverse transform of the blocks.
void add_tuned(const Topology& t, uint32_t v, Point point, uint32_t at, Row& row) {
    const Scheme scheme = t.options.scheme;
    const uint32_t n = face_valence(t, v), kinds = scheme == Scheme::loop ? kFace : kPointCount;
    std::vector<double> edge(n), face(n);
    for (uint32_t k = 0; k < n; ++k) {
        const Block block = tuned_block(scheme, n, k);
        if (k == 0) add(row, v, block[point][kCenter]);
        for (uint32_t s = 0; s < n; ++s) {
            const double turn = 2 * std::numbers::pi * k / n, own = point == kFace ? 0.5 : 0;
            edge[s] += block[point][kEdge] * std::cos(turn * (s - own)) / n;
            face[s] += block[point][kFace] * std::cos(turn * (s + 0.5 - own)) / n;
        }
    }
    for (uint32_t s = 0; s < n; ++s) {
        add(row, neighbor(t, v, (at + s) % n), edge[s]);
        if (kinds == kPointCount) add(row, end_vertex(t, t.next_corner(t.corners_of_vertex(v)[(at + s) % n])), face[s]);
    }
}

void vertex_row(const Stage& p, uint32_t v, Row& row) {
    if (is_tuned(p.topology, v))
        add_tuned(p.topology, v, kCenter, 0, row);
    else
        refined_vertex(p, v, row);
}

void edge_row(const Stage& p, uint32_t e, Row& row) {
    const Topology& t = p.topology;
    for (uint32_t end = 0; end < 2; ++end) {
        const uint32_t v = t.edge_vertices[2 * e + end];
        if (is_tuned(t, v)) return add_tuned(t, v, kEdge, edge_position(t, v, e), row);
    }
    refined_edge(p, e, row);
}

void face_row(const Stage& p, uint32_t f, Row& row) {
    const Topology& t = p.topology;
    for (uint32_t c = t.face_begin(f); c < t.face_begin(f) + t.size_of_face(f); ++c) {
        const uint32_t v = t.face_vertices[c];
        if (is_tuned(t, v)) return add_tuned(t, v, kFace, edge_position(t, v, t.face_edges[c]), row);
    }
    face_centroid(p, f, row);
}

}  // namespace

std::span<const Pass> catmull_clark_g2_passes() {
    static constexpr Pass passes[] = {{SplitKind::quads, {vertex_row, face_row, edge_row}}};
    return passes;
}
std::span<const Pass> loop_g2_passes() {
    static constexpr Pass passes[] = {{SplitKind::triangles, {vertex_row, nullptr, edge_row}}};
    return passes;
}

}  // namespace limn::schemes
