// What a subdivision scheme is: a few passes over a mesh, each a split of its faces and masks for the points that
// the split makes. One scheme is one small file of masks; subdivision_schemes.cpp lists them all.
//
// Every refined point is a weighted sum of points of the level before: a row. Tables of rows are what devices
// evaluate (stencil_table.h), so that no kernel knows which scheme made its rows.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "limn/row.h"
#include "limn/topology.h"

namespace limn {

/// A mesh between two passes. Its edge_vertices[2 * e] of a boundary edge comes first in the face.
struct Stage {
    Topology topology;  ///< options.scheme is loop where faces are split into triangles, else catmull_clark
    uint32_t step = 0;  ///< whole steps that lie behind it; boundary rules of some schemes alternate
    /// Knot intervals of non-uniform schemes: one for each corner, of the edge that begins there in its face, as seen
    /// from that end or from both (each scheme says so). Empty: all are one. Of schemes with convex and concave corners:
    /// the angle of each face corner in radians; empty: all are convex.
    Array<double> intervals;
};

/// How faces are split. Points are numbered in the order in which they are named here.
enum class SplitKind : uint8_t {
    none,       ///< same faces: a smoothing pass. Points of vertices
    quads,      ///< a quad per corner. Points of vertices, faces and edges
    triangles,  ///< four triangles per triangle. Points of vertices and edges
    corners,  ///< faces shrink, edges and vertices become faces. Points of corners and, along boundaries, of edge ends
              ///< and fixed vertices
    midpoints,  ///< faces joined through edge midpoints, vertices cut off. Points of edges
    sqrt3,      ///< triangles around face points, old edges turned. Points of vertices and faces, each second step of
                ///< boundary edge ends
    sqrt2,      ///< a quad per edge. Points of vertices and faces
    hexagons,   ///< n-gons turned inside n-gons, 2n-gons around vertices. Points of corners
    dual,       ///< faces become vertices. Points of faces and boundary edges
};

enum class Origin : uint8_t { vertex, face, edge, corner, edge_end };
inline constexpr uint32_t kOriginCount = 5;

/// Appends the row of the point that belongs to element `index` of `parent`: a vertex, face, edge or corner; for
/// Origin::edge_end 2 * edge + end, `end` as in Topology::edge_vertices.
using RowFunction = void (*)(const Stage& parent, uint32_t index, Row& row);

/// One pass: a split, and masks for the points that it makes. Null where the split makes no such points.
struct Pass {
    SplitKind split = SplitKind::none;
    RowFunction rows[kOriginCount] = {};
    /// Fills intervals of the child, whose topology is there; null: the scheme has none.
    void (*intervals)(const Stage& parent, Stage& child) = nullptr;
};

enum class FaceKind : uint8_t { polygons, quads, triangles };

/// What a scheme does with sharp edges and vertices. Boundaries are not meant: all schemes have rules for those.
enum class CreaseRules : uint8_t {
    none,        ///< ignored: the literature defines none for relatives of Catmull-Clark and Loop
    semi_sharp,  ///< all of ControlMesh's
};

/// What Stage::intervals are to a scheme (corner_values.h); where none are given all are one, and all corners convex.
enum class CornerValues : uint8_t { none, intervals, angles };

struct SubdivisionScheme {
    const char* name;  ///< of --scheme: lower case, digits and dashes
    const char* title;
    const char* source;            ///< papers, and where a rule is a reconstruction
    std::span<const Pass> passes;  ///< of one step, in order
    FaceKind faces = FaceKind::polygons;
    bool dual = false;           ///< vertices have no child vertex: they become faces
    bool interpolates = false;   ///< points of the control mesh stay where they are
    bool reconstructed = false;  ///< rules that could not be compared with the paper's own text
    CreaseRules creases = CreaseRules::none;
    CornerValues corner_values = CornerValues::none;
    uint32_t period = 1;  ///< steps after which boundary rules repeat
    /// Rings of faces around a point on which its limit depends at most, boundaries and irregular vertices included.
    uint32_t rings = 2;
    /// Rings of faces to cut out around a point so that refining them alone, step after step, finds its limit; 0: one
    /// more than `rings`, which is enough.
    uint32_t patch_rings = 0;
};

/// All schemes, in the order of the literature: Catmull-Clark, Loop and bilinear among them, by the same machinery.
/// Not here is what is no sum of points with fixed weights: the convexity-preserving scheme for hexagons of Dyn, Levin
/// and Liu (1992).
std::span<const SubdivisionScheme> subdivision_schemes();

/// The scheme of this name, or null.
const SubdivisionScheme* find_subdivision_scheme(std::string_view name);

}  // namespace limn
