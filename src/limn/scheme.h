// The subdivision rules: every mask that limn uses, as pure functions of a neighbourhood. Nothing else knows
// a weight.
//
// Catmull and Clark 1978; Loop 1987; DeRose, Kass and Truong 1998 (semi-sharp features, Chaikin creasing);
// limit masks from the left eigenvectors of these rules (Halstead, Kass and DeRose 1993 for the smooth ones).
// Options are those of OpenSubdiv 3.6 and mean the same.
#pragma once

#include <cstdint>
#include <span>

namespace limn {

/// Schemes whose surfaces are patches. Doo-Sabin (generalised biquadratic B-splines) takes any faces and knows no
/// sharpness; refinement is by schemes/scheme_refinement.h, not by refinement.h.
enum class Scheme : uint8_t { catmull_clark, loop, bilinear, doo_sabin };

/// What happens where the control mesh ends.
enum class BoundaryInterpolation : uint8_t {
    none,             ///< faces that touch an unsharpened boundary are not part of the surface
    edge_only,        ///< boundary edges are infinitely sharp
    edge_and_corner,  ///< and so are vertices of a single face
};

enum class CreasingMethod : uint8_t { uniform, chaikin };

/// Catmull-Clark edge weights next to triangles: the ordinary ones, or 0.47 a triangle.
enum class TriangleSubdivision : uint8_t { catmark, smooth };

/// Where a face-varying channel is interpolated linearly.
enum class FaceVaryingInterpolation : uint8_t {
    none,           ///< nowhere: smooth along its boundaries
    corners_only,   ///< at corners
    corners_plus1,  ///< at corners and where three or more regions meet
    corners_plus2,  ///< and at darts and on both sides of a corner
    boundaries,     ///< along all boundaries
    all,            ///< everywhere: bilinear
};

struct SchemeOptions {
    Scheme scheme = Scheme::catmull_clark;
    BoundaryInterpolation boundary = BoundaryInterpolation::edge_only;
    CreasingMethod creasing = CreasingMethod::uniform;
    TriangleSubdivision triangles = TriangleSubdivision::catmark;
    /// Give OpenSubdiv's results where it departs from the limit of its own rules: Chaikin edge blends that
    /// extrapolate, smooth limits at infinitely sharp darts, cross tangents at irregular boundaries and
    /// creases.
    bool opensubdiv_compatible = false;

    bool operator==(const SchemeOptions&) const = default;
};

/// Sharpness of edges and vertices is 0 (smooth) to 10 (infinite).
inline constexpr float kInfiniteSharpness = 10.0f;
inline bool is_infinite(float sharpness) {
    return sharpness >= kInfiniteSharpness;
}

/// How a vertex is treated, from its own sharpness and the number of sharp edges that meet there.
enum class VertexRule : uint8_t { smooth, dart, crease, corner };

/// Any vertex sharpness or three sharp edges make a corner; two a crease; one a dart.
inline VertexRule vertex_rule(float vertex_sharpness, uint32_t sharp_edge_count) {
    if (vertex_sharpness > 0 || sharp_edge_count > 2) return VertexRule::corner;
    if (sharp_edge_count == 2) return VertexRule::crease;
    return sharp_edge_count == 1 ? VertexRule::dart : VertexRule::smooth;
}

/// Sharpness one level on: infinite stays, anything else falls by one, not below zero.
inline float child_sharpness(float sharpness) {
    if (is_infinite(sharpness)) return kInfiniteSharpness;
    return sharpness > 1.0f ? sharpness - 1.0f : 0.0f;
}

/// The edges of finite, non-zero sharpness around a vertex.
struct SemiSharpEdges {
    float sum = 0;
    uint32_t count = 0;
    void add(float sharpness) {
        if (sharpness <= 0 || is_infinite(sharpness)) return;
        sum += sharpness;
        ++count;
    }
};

/// Sharpness of the child of an edge next to a vertex, `around` counting that edge, too.
/// Chaikin: 3/4 of its own and 1/4 of the mean of the other semi-sharp edges there, less one.
float child_edge_sharpness(CreasingMethod creasing, float sharpness, const SemiSharpEdges& around);

/// Edge point: `smooth` is the share of the smooth mask, the rest is the midpoint. `child_rule` is the rule
/// of the child vertex; both child edges are sharp when it is a crease.
double edge_smooth_share(const SchemeOptions& options, float sharpness, VertexRule child_rule);

/// Vertex point in transition between two rules: the share of the parent's rule, the mean of the sharpness
/// values that vanish in this step. `parent` and `child` are the sharpness of the edges around, in the same
/// order.
double vertex_parent_share(float parent_vertex, float child_vertex, std::span<const float> parent,
                           std::span<const float> child);

/// Weight of each of the faces beside a smooth Catmull-Clark edge (their centroids), face sizes n0 and n1;
/// each end point then weighs 1/2 - this.
double edge_face_weight(TriangleSubdivision triangles, uint32_t n0, uint32_t n1);

/// Smooth vertex point of valence n. Catmull-Clark: over the vertex, its edge neighbours and the centroids of
/// its faces; Loop: over the vertex and its neighbours (face == 0).
struct VertexMask {
    double vertex, edge, face;
};
VertexMask smooth_vertex_mask(Scheme scheme, uint32_t valence);

/// Limit position and tangents at a vertex whose ring is quads (Catmull-Clark) or triangles (Loop).
/// Ring weights: edge[i] for the neighbour along edge i, face[i] for the vertex opposite in quad i, which
/// lies between edges i and i + 1 (Catmull-Clark only). Boundary vertices have one edge more than faces.
struct LimitMask {
    double vertex = 0;
    std::span<double> edge;  ///< the caller's storage, one per edge
    std::span<double> face;  ///< one per face
};

/// The neighbourhood of a vertex as limit masks need it, ring in counter-clockwise order.
struct LimitStar {
    VertexRule rule = VertexRule::smooth;
    uint32_t edge_count = 0;
    uint32_t face_count = 0;
    uint32_t sharp_edge_count = 0;
    uint32_t sharp_edges[2] = {0, 0};  ///< positions of the first two sharp edges in the ring
    bool infinite_dart = false;        ///< rule == dart and its edge never becomes smooth
};
void limit_position_mask(const SchemeOptions& options, const LimitStar& star, LimitMask& position);
void limit_tangent_masks(const SchemeOptions& options, const LimitStar& star, LimitMask& tangent1,
                         LimitMask& tangent2);

}  // namespace limn
