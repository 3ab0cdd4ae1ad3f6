// Stam 2001, "On subdivision schemes generalizing uniform B-spline surfaces of arbitrary degree": faces are
// split linearly, then vertices are smoothed m times. Quads: degree 2 m + 1, and one dual averaging for the
// even degrees; triangles: box splines of degree 3 m + 1. One smoothing is Catmull-Clark (of quads), or Loop.
// Boundaries are smoothed like curves, from their own points alone.
#include <array>
#include <cassert>

#include "limn/scheme.h"
#include "limn/schemes/schemes.h"
#include "limn/schemes/star.h"

namespace limn::schemes {
namespace {

constexpr uint32_t kMostSmoothings = 4;

/// Boundary vertices of a smoothing pass. False: v lies inside.
bool smooth_boundary(const Topology& t, uint32_t v, Row& row) {
    if (face_valence(t, v) == 0 || (is_boundary_vertex(t, v) && is_fixed_corner(t, v))) {
        add(row, v, 1);
        return true;
    }
    if (!is_boundary_vertex(t, v)) return false;
    const auto [previous, next] = boundary_neighbors(t, v);
    add(row, v, 0.5);
    add(row, previous, 0.25);
    add(row, next, 0.25);
    return true;
}

void smooth_quads(const Stage& p, uint32_t v, Row& row) {
    const Topology& t = p.topology;
    if (smooth_boundary(t, v, row)) return;
    const double n = face_valence(t, v);
    add(row, v, (n - 3) / n);
    for (const uint32_t c : t.corners_of_vertex(v)) {
        add(row, end_vertex(t, c), 2 / (n * n));
        add(row, end_vertex(t, t.next_corner(c)), 1 / (n * n));
    }
}

void smooth_triangles(const Stage& p, uint32_t v, Row& row) {
    const Topology& t = p.topology;
    if (smooth_boundary(t, v, row)) return;
    const uint32_t n = face_valence(t, v);
    const double beta = smooth_vertex_mask(Scheme::loop, n).edge;
    add(row, v, 1 - 2 * n * beta);
    for (uint32_t i = 0; i < n; ++i) add(row, neighbor(t, v, i), 2 * beta);
}

/// A split, smoothings and, last, the dual.
using Passes = std::array<Pass, kMostSmoothings + 2>;

constexpr Passes make_passes(SplitKind kind, RowFunction face, RowFunction smooth, uint32_t smoothings) {
    Passes passes = {};
    passes[0] = {kind, {keep_vertex, face, edge_midpoint}};
    for (uint32_t i = 1; i <= smoothings; ++i) passes[i] = {SplitKind::none, {smooth}};
    passes[smoothings + 1] = {SplitKind::dual, {nullptr, face_centroid, edge_midpoint}};
    return passes;
}

template <uint32_t smoothings>
constexpr Passes kQuads = make_passes(SplitKind::quads, face_centroid, smooth_quads, smoothings);
template <uint32_t smoothings>
constexpr Passes kTriangles = make_passes(SplitKind::triangles, nullptr, smooth_triangles, smoothings);

constexpr const Passes* kQuadPasses[] = {&kQuads<1>, &kQuads<2>, &kQuads<3>, &kQuads<4>};
constexpr const Passes* kTrianglePasses[] = {&kTriangles<1>, &kTriangles<2>, &kTriangles<3>};

}  // namespace

std::span<const Pass> stam_passes(uint32_t degree) {
    assert(degree >= 4 && degree <= 2 * kMostSmoothings + 1);
    const uint32_t smoothings = (degree - 1) / 2;
    return {kQuadPasses[smoothings - 1]->data(), smoothings + (degree % 2 == 0 ? 2 : 1)};
}

std::span<const Pass> stam_triangle_passes(uint32_t degree) {
    assert(degree == 4 || degree == 7 || degree == 10);
    const uint32_t smoothings = (degree - 1) / 3;
    return {kTrianglePasses[smoothings - 1]->data(), smoothings + 1};
}

}  // namespace limn::schemes
