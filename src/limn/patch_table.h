// The limit surface as few small shared tables: surfaces over rings of points, and the plans they share.
//
// A regular face is one surface, a bicubic patch (Loop: a quartic box spline). Any other face is split once
// into its level-1 faces. What each of those depends on is the star of one vertex, so that few different ones
// occur, in all meshes together: a plan is made once for each (Brainerd et al. 2016 share by whole faces;
// splitting first is what makes plans few and small).
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "limn/array.h"
#include "limn/build_control.h"
#include "limn/control_mesh.h"
#include "limn/shared/patch_table_layout.h"
#include "limn/stencil_table.h"

namespace limn {

/// What a node of a plan's tree is. Coordinates are those of the node: the unit square, or the triangle
/// u + v <= 1 for Loop.
enum class PlanNodeKind : uint32_t {
    /// Four nodes from `first`, in the order of a face's children: quads at (0,0), (1,0), (1,1), (0,1); of
    /// triangles three at the corners and, turned by 180 degrees, the centre.
    split = shared::kNodeSplit,
    /// Two nodes from `first`: the lower and the upper half in u or in v. Along a semi-sharp crease the
    /// surface needs no other splits (single-crease patches, Niessner et al. 2012).
    split_u = shared::kNodeSplitU,
    split_v = shared::kNodeSplitV,
    /// `first` begins 16 entries of plan_points in row-major order, v rows of u columns: uniform bicubic
    /// B-spline.
    bicubic = shared::kNodeBicubic,
    /// 12 entries: quartic box spline, see limn/shared/patch_basis.h.
    box_spline = shared::kNodeBoxSpline,
    /// 4 entries, or 3 of a triangle: corners counter-clockwise.
    bilinear = shared::kNodeBilinear,
    linear = shared::kNodeLinear,
    /// `first` begins the ring of another plan, `plan`, whose corner 0 is corner `rotation` of this node.
    /// Around an extraordinary vertex plans refer to themselves: the surface is exact at every depth.
    plan = shared::kNodePlan,
    /// 20 entries, or 18 of a triangle, see limn/shared/gregory_basis.h. Only with such end caps.
    gregory = shared::kNodeGregory,
    gregory_triangle = shared::kNodeGregoryTriangle,
};

/// What stands for the surface around an irregular vertex.
enum class EndCap : uint8_t {
    exact = shared::kEndCapExact,      ///< the surface itself, at any depth
    gregory = shared::kEndCapGregory,  ///< from the isolation level on a Gregory patch, as in OpenSubdiv
    /// And derivatives as OpenSubdiv defines them by default: as if the patch were no rational one.
    gregory_opensubdiv = shared::kEndCapGregoryOpenSubdiv,
};

struct PlanNode {
    uint32_t word;  ///< shared::pack_node
    uint32_t first;

    PlanNodeKind kind() const { return static_cast<PlanNodeKind>(shared::node_kind(word)); }
    uint32_t plan() const { return shared::node_plan(word); }
    uint32_t rotation() const { return shared::node_rotation(word); }
};

/// Rows of a plan are dense: row r weighs ring point j by
/// plan_weights[first_weight + r * shared::plan_row_stride(ring_size) + j]; what fills up a stride is zero.
/// Rows sum to one, tangents to zero. Node n is plan_nodes[first_node + n], its points are row numbers,
/// plan_points[first_point + node.first + k]. Node 0 is the root.
struct Plan {
    uint32_t ring_size;
    uint32_t row_count;
    uint32_t first_weight;  ///< a multiple of 4
    uint32_t first_node;
    uint32_t first_point;
    /// 1: rows kCornerLimitRow and kCornerTangentRow and the next are the limit of corner 0 and two tangents
    /// there, whose cross product points along the normal (limit_tangent_masks in scheme.h; at a crease, on
    /// the plan's own side). Only plans that split, and have no finite sharpness left, have them.
    uint32_t has_corner_rows;
};

struct Surface {
    uint32_t word;        ///< shared::pack_surface
    uint32_t first_ring;  ///< ring point j of the surface is entry first_ring + j of ring_points

    uint32_t plan() const { return shared::surface_plan(word); }
    uint32_t rotation() const { return shared::surface_rotation(word); }  ///< the corner that is the plan's 0
};

/// Equal where plans are, in all tables: a hash of all that a plan is made from. So tables can be merged (batch.h)
/// without a look at the plans themselves, which take up far more. Plans built twice, not by way of one cache,
/// may differ by the rounding of sums in double.
using PlanIdentity = std::array<uint64_t, 2>;

/// Indices of points: 32 bits each or, where all fit, 16, two in a word.
struct IndexList {
    Array<uint32_t> words;
    bool narrow = false;

    uint32_t operator[](size_t i) const {
        return narrow ? shared::narrow_index(words[i / 2], static_cast<uint32_t>(i & 1)) : words[i];
    }
};

/// Level-1 points whose rows have equal weights: row i < row_count makes point first_point + i of
/// entry_count points, sum over k of point_weights[first_weight + k] *
/// control[point_indices[first_index + i * entry_count + k]].
struct PointRun {
    uint32_t first_point;
    uint32_t row_count;
    uint32_t entry_count;
    uint32_t first_index;
    uint32_t first_weight;
};

/// Points are the control points [0, control_count) and, from first_refined on, the vertices of level 1 that
/// surfaces need: point_runs, whose points follow each other (of crowds, crowd.h, with gaps), say what they are made of. What
/// lies between is not used: first_refined is a multiple of 64, so that devices can bind the two apart.
template <class Real>
struct BasicPatchTable {
    SchemeOptions options;
    EndCap end_cap = EndCap::exact;
    uint32_t control_count = 0;
    uint32_t first_refined = 0;  ///< control_count where there are none
    uint32_t refined_count = 0;
    Array<PointRun> point_runs;
    IndexList point_indices;
    Array<Real> point_weights;
    Array<Surface> surfaces;
    IndexList ring_points;
    /// Nodes, points and weights of plans follow each other as plans do.
    Array<Plan> plans;
    Array<PlanIdentity> plan_identities;  ///< one per plan; not needed to evaluate
    Array<PlanNode> plan_nodes;
    Array<uint32_t> plan_points;
    Array<Real> plan_weights;
    /// One per ptex face: its surface, or the first of four with shared::kPtexSplit, or shared::kPtexHole
    /// where there is no surface. A face of the scheme's own size is one ptex face, any other is one per
    /// corner.
    Array<uint32_t> ptex_surfaces;

    uint32_t point_count() const { return first_refined + refined_count; }
    uint64_t plan_bytes() const {
        return plans.bytes() + plan_identities.bytes() + plan_nodes.bytes() + plan_points.bytes() +
               plan_weights.bytes();
    }
    uint64_t bytes() const {
        return point_runs.bytes() + point_indices.words.bytes() + point_weights.bytes() + surfaces.bytes() +
               ring_points.words.bytes() + plan_bytes() + ptex_surfaces.bytes();
    }
};
using PatchTable = BasicPatchTable<float>;
using PatchTableDouble = BasicPatchTable<double>;

struct PatchTableOptions {
    Interpolation interpolation = Interpolation::vertex;
    /// Levels that a plan's tree goes down at most before it refers to another plan, 1 .. 10: evaluation descends
    /// that far at once. The surface is the same for all. Not used with Gregory end caps.
    uint32_t plan_depth = 3;
    EndCap end_cap = EndCap::exact;
    /// Of Gregory end caps, 1 .. 10: the level of the faces that they stand for, where those are not regular.
    /// Semi-sharp features that reach deeper are smooth from there on. OpenSubdiv's adaptive refinement to
    /// the same level, with infinitely sharp and without single-crease patches, has the same patches.
    uint32_t isolation_level = 10;
    BuildPart control = {};  ///< as RefinementOptions::control
};

/// Plans already built, for any number of meshes and threads; each build takes what it needs from it and adds
/// what is new. A plan takes about 200 bytes for each point of its ring and level of its tree.
class PlanCache {
  public:
    PlanCache();
    ~PlanCache();
    PlanCache(PlanCache&&) noexcept;
    PlanCache& operator=(PlanCache&&) noexcept;
    uint32_t size() const;
    uint64_t bytes() const;

    struct Impl;
    Impl& impl() const { return *impl_; }

  private:
    std::unique_ptr<Impl> impl_;
};

/// The limit surface of the mesh for vertex or varying data. `cache` may be null. The result does not depend
/// on what the cache holds, nor on the number of cores. Errors: invalid_argument (plan_depth,
/// isolation_level); too_large past 2^31 - 1 corners, 2^32 ring points or 2^26 plans; unsupported where more
/// than kMaxRingSize points lie around one face after the split (a vertex of valence 2,000 or more); cancelled.
/// Doo-Sabin: every corner of a face is a surface, split faces' as they are, whole ones' one of four (kPtexSplit); sharpness
/// is ignored. Errors: unsupported where a face that is no hole has a vertex (Error::element) on a boundary, of two faces or
/// of more than one fan of faces, and with Gregory end caps. BoundaryInterpolation::none makes holes of faces at boundaries.
/// A cancelled build leaves nothing but, perhaps, more plans in the cache.
template <class Real>
Result<BasicPatchTable<Real>> build_patch_table(const ControlMesh& mesh, const PatchTableOptions& options,
                                                const PlanCache* cache = nullptr);

/// The limit of one face-varying channel: the same faces, in the channel's values.
/// Errors: and unsupported where a channel that is not linear everywhere meets semi-sharp Chaikin creases,
/// whose rules look beyond seams.
template <class Real>
Result<BasicPatchTable<Real>> build_face_varying_patch_table(const ControlMesh& mesh, uint32_t channel,
                                                             const PatchTableOptions& options,
                                                             const PlanCache* cache = nullptr);

inline constexpr uint32_t kMaxRingSize = 4096;

/// The level-1 points as an ordinary stencil table: row r is point first_refined + r, its entries by descending weights; a point
/// that is not used has none.
template <class Real>
BasicStencilTable<Real> build_point_table(const BasicPatchTable<Real>& table);

}  // namespace limn
