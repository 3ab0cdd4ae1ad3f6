// The eight-point butterfly scheme of Dyn, Levin and Gregory 1990, made G1 at all valences after the principle of
// Prautzsch and Umlauf 2000 (their coefficients were not at hand): in each frequency of the discrete Fourier transform
// around an irregular vertex an eigenvalue that is too large is moved, and lambda raised where it is too small. Only
// the masks of edges that leave the vertex change, so that all points stay interpolated; valences 4 to 7 need nothing.
// Vertices with an irregular neighbour keep the ordinary masks: one step tells them apart. Boundaries: four-point
// curves; wings that are missing are reflections.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "limn/schemes/schemes.h"
#include "limn/schemes/star.h"

namespace limn::schemes {
namespace {

constexpr double kShare = 0.9;        ///< of lambda that other eigenvalues have at most
constexpr double kLeastLambda = 0.4;  ///< well above 1/4, which the next ring has

/// The step's matrix for one frequency of the points around a vertex: its neighbours, the points opposite in the next
/// triangles, and those straight behind the neighbours:
/// (near_near, near_far, 0; far_near, 1/8, far_behind; 1, 0, 0).
struct Block {
    double near_near, near_far, far_near, far_behind;
};
Block block_of(uint32_t n, uint32_t k) {
    auto c = [&](double sectors) { return std::cos(2 * std::numbers::pi * k / n * sectors); };
    return {0.5 + c(1) / 4 - c(2) / 8, -c(0.5) / 8, c(0.5) - c(1.5) / 8, -c(0.5) / 8};
}

/// The left eigenvector (1, far, behind) of eigenvalue x, and what x lacks of being one.
struct LeftVector {
    double far, behind, rest;
};
LeftVector left_vector(const Block& b, double x) {
    const double far = b.near_far / (x - 0.125), behind = far * b.far_behind / x;
    return {far, behind, b.near_near + far * b.far_near + behind - x};
}

/// The largest eigenvalue from `least` on; `least` itself where there is none.
double largest_eigenvalue(const Block& b, double least) {
    double low = least, high = 1;
    if (left_vector(b, low).rest <= 0) return least;
    for (int i = 0; i < 60; ++i) {
        const double middle = (low + high) / 2;
        (left_vector(b, middle).rest > 0 ? low : high) = middle;
    }
    return (low + high) / 2;
}

double lambda_of(uint32_t n) {
    return std::max(kLeastLambda, largest_eigenvalue(block_of(n, 1), 0.25));
}

/// What is added to the row of a vertex's edge: to each of its three kinds of points in the sector `turn` further on.
struct Change {
    double near = 0, far = 0, behind = 0;
};
Change change_of(uint32_t n, double lambda, uint32_t turn) {
    Change sum;
    for (uint32_t k = 1; k < n; ++k) {
        const bool leads = k == 1 || k == n - 1;
        const Block block = block_of(n, k);
        const double most = kShare * lambda, from = largest_eigenvalue(block, leads ? 0.25 : most);
        // Moves this eigenvalue, no other one: the vector times a column that is 1 in its first row.
        const LeftVector left = left_vector(block, from);
        const double move = ((leads ? lambda : most) - from) / n, angle = 2 * std::numbers::pi * k / n;
        sum.near += move * std::cos(angle * turn);
        sum.far += move * left.far * std::cos(angle * (turn + 0.5));
        sum.behind += move * left.behind * std::cos(angle * turn);
    }
    return sum;
}

bool is_tuned(const Topology& t, uint32_t v) {
    auto is_regular = [&](uint32_t u) { return !is_boundary_vertex(t, u) && face_valence(t, u) == 6; };
    const uint32_t n = face_valence(t, v);
    if (is_boundary_vertex(t, v) || n < 3 || (n >= 4 && n <= 7)) return false;
    for (uint32_t i = 0; i < n; ++i)
        if (!is_regular(neighbor(t, v, i))) return false;
    return true;
}

void edge_row(const Stage& p, uint32_t e, Row& row) {
    const Topology& t = p.topology;
    if (is_boundary_edge(t, e)) return four_point_boundary_edge(p, e, row);
    eight_point_edge(p, e, row);
    for (uint32_t end = 0; end < 2; ++end) {
        const uint32_t v = t.edge_vertices[2 * e + end], n = face_valence(t, v);
        if (!is_tuned(t, v)) continue;
        const double lambda = lambda_of(n);
        for (uint32_t turn = 0; turn < n; ++turn) {
            const uint32_t i = (edge_position(t, v, e) + turn) % n, near = t.edges_of_vertex(v)[i];
            const uint32_t u = t.other_vertex(near, v);
            const Change change = change_of(n, lambda, turn);
            add(row, u, change.near);
            add_apex_across(t, t.next_corner(t.corners_of_vertex(v)[i]), change.far, row);
            add(row, neighbor(t, u, (edge_position(t, u, near) + 3) % 6), change.behind);
        }
    }
}

}  // namespace

std::span<const Pass> butterfly_g1_passes() {
    static constexpr Pass passes[] = {{SplitKind::triangles, {keep_vertex, nullptr, edge_row}}};
    return passes;
}

}  // namespace limn::schemes
