// Faces whose limit is one polynomial patch, and the points of that patch. Not part of the public interface.
#pragma once

#include <array>

#include "limn/patch_table.h"
#include "limn/stencil_row.h"
#include "limn/topology.h"

namespace limn {

/// A row of a few entries.
struct PatchPoint {
    static constexpr size_t kMaxEntries = 6;
    std::array<RowEntry, kMaxEntries> entries;
    uint32_t count = 0;

    size_t size() const { return count; }
    const RowEntry* begin() const { return entries.data(); }
    const RowEntry* end() const { return entries.data() + count; }
};

/// A patch's points as weighted sums of vertices; what lies beyond an infinitely sharp edge is extrapolated.
struct PatchPoints {
    PlanNodeKind kind = PlanNodeKind::bicubic;
    uint32_t count = 0;
    std::array<PatchPoint, 16> points;
    /// Bicubic: the sharpness of crease_edge, the only one of the face that is neither smooth nor infinite;
    /// else 0. The surface then is that of these points refined across that edge.
    float crease_sharpness = 0;
    uint32_t crease_edge = 0;
    /// Bicubic: bit k stands for the edge from corner k to the next one, beyond which points are extrapolated.
    uint32_t sharp_edges = 0;
};

/// False where the face is not regular: anything but 4 (Loop: 6) faces around a smooth corner, 2 (3) beside
/// an infinite crease or boundary, 1 in an infinitely sharp corner. `linear`: every face of the scheme's own
/// size is a bilinear patch, or a linear triangle.
bool find_patch_points(const Topology& t, uint32_t face, bool linear, PatchPoints& out);

/// A quad's net of vertices, row by row; what lies beyond infinitely sharp edges is kInvalidIndex.
using QuadNet = std::array<uint32_t, 16>;
/// And the rest of its patch, as PatchPoints has it.
struct QuadPattern {
    uint32_t sharp_edges = 0;
    float crease_sharpness = 0;
    uint32_t crease_edge = 0;

    bool is_regular() const { return sharp_edges == 0 && crease_sharpness == 0; }
    /// Whether point k of the net lies beyond a sharp edge.
    bool is_outside(uint32_t k) const {
        const uint32_t edges =
            uint32_t{k < 4} | uint32_t{k % 4 == 3} << 1 | uint32_t{k >= 12} << 2 | uint32_t{k % 4 == 0} << 3;
        return (sharp_edges & edges) != 0;
    }
};
PatchPoints make_quad_patch(const QuadNet& net, const QuadPattern& pattern);
/// The other way round, of bicubic patches.
QuadPattern read_quad_patch(const PatchPoints& patch, QuadNet& net);
/// Turns it so that alike ones are alike: what is sharp begins at edge 0. The corner that became corner 0.
uint32_t turn_quad_patch(QuadNet& net, QuadPattern& pattern);

/// Whether a face may be a patch as far as corner c (of a face of the scheme's own size) is concerned.
bool is_regular_corner(const Topology& t, uint32_t c);

/// One for each vertex: 1 where it is smooth, and nothing but 4 quads (Loop: 6 triangles) lie around it.
std::vector<uint8_t> find_regular_vertices(const Topology& t, const BuildPart& part = {});

/// The points of a face of the scheme's own size all of whose vertices are regular, in the order of its patch
/// (as find_patch_points, but quicker). `linear`: of any face of that size. Returns how many.
uint32_t write_regular_ring(const Topology& t, uint32_t face, bool linear, uint32_t (&ring)[16]);

/// The faces around corner c's vertex that can be reached from c's without crossing an infinitely sharp edge,
/// c's own first.
std::vector<uint32_t> faces_of_sector(const Topology& t, uint32_t c);

}  // namespace limn
