// The limit surface as few small shared tables: surfaces over rings of points, and the plans they share.
//
// A regular face is one surface, a bicubic patch (Loop: a quartic box spline). Any other face is split once
// into its level-1 faces. What each of those depends on is the star of one vertex, so that few different ones
// occur, in all meshes together: a plan is made once for each (Brainerd et al. 2016 share by whole faces;
// splitting first is what makes plans few and small).
#pragma once

#include <cstdint>
#include <memory>

#include "limn/array.h"
#include "limn/control_mesh.h"
#include "limn/stencil_table.h"

namespace limn {

/// What a node of a plan's tree is. Coordinates are those of the node: the unit square, or the triangle
/// u + v <= 1 for Loop.
enum class PlanNodeKind : uint32_t {
    /// Four nodes from `first`, in the order of a face's children: quads at (0,0), (1,0), (1,1), (0,1); of
    /// triangles three at the corners and, turned by 180 degrees, the centre.
    split,
    /// Two nodes from `first`: the lower and the upper half in u or in v. Along a semi-sharp crease the
    /// surface needs no other splits (single-crease patches, Niessner et al. 2012).
    split_u,
    split_v,
    /// `first` begins 16 entries of plan_points in row-major order, v rows of u columns: uniform bicubic
    /// B-spline.
    bicubic,
    /// 12 entries: quartic box spline, see kBoxSplineGrid in patch_basis.h.
    box_spline,
    /// 4 entries, corners counter-clockwise.
    bilinear,
    /// `first` begins the ring of another plan, `plan`, whose coordinates are turned by `rotation` corners.
    /// Around an extraordinary vertex plans refer to themselves: the surface is exact at every depth.
    plan,
};

struct PlanNode {
    PlanNodeKind kind;
    uint32_t first;
    uint32_t plan;      ///< of PlanNodeKind::plan
    uint32_t rotation;  ///< of PlanNodeKind::plan
};

/// Rows of a plan are dense: row r weighs ring point j by
/// plan_weights[first_weight + r * ring_size + j]. Rows sum to one. Node n is
/// plan_nodes[first_node + n], its points are plan_points[first_point + node.first + k], row numbers.
/// Node 0 is the root. Rows 0 .. corners - 1 are the limits of the surface's corners where the root is split
/// (right where no sharpness is left to fade).
struct Plan {
    uint32_t ring_size;
    uint32_t row_count;
    uint32_t first_weight;
    uint32_t first_node;
    uint32_t first_point;
};

struct Surface {
    uint32_t plan;
    uint32_t first_ring;  ///< ring point j of the surface is point ring_points[first_ring + j]
    uint32_t base_face;
    uint32_t rotation;  ///< the plan's corner 0 is this corner of the surface
};

/// Points are the control points [0, control_count) and, after them, the rows of `stencils` over the control
/// points: vertices of level 1, those that surfaces need.
template <class Real>
struct BasicPatchTable {
    SchemeOptions options;
    uint32_t control_count = 0;
    BasicStencilTable<Real> stencils;
    Array<Surface> surfaces;
    Array<uint32_t> ring_points;
    Array<Plan> plans;
    Array<PlanNode> plan_nodes;
    Array<uint32_t> plan_points;
    Array<Real> plan_weights;
    /// One per ptex face: its surface, or the first of four with kPtexSplit, or kInvalidIndex in a hole.
    /// A face of the scheme's own size is one ptex face, any other is one per corner.
    Array<uint32_t> ptex_surfaces;

    uint32_t point_count() const { return control_count + stencils.row_count(); }
    uint64_t bytes() const {
        return stencils.bytes() + surfaces.bytes() + ring_points.bytes() + plans.bytes() +
               plan_nodes.bytes() + plan_points.bytes() + plan_weights.bytes() + ptex_surfaces.bytes();
    }
};
using PatchTable = BasicPatchTable<float>;
using PatchTableDouble = BasicPatchTable<double>;

inline constexpr uint32_t kPtexSplit = 0x80000000u;

struct PatchTableOptions {
    Interpolation interpolation = Interpolation::vertex;
    /// Levels that a plan's tree goes down before it refers to another plan, 1 .. 10: evaluation descends
    /// that far at once. The surface is the same for all.
    uint32_t plan_depth = 3;
};

/// Plans already built, for any number of meshes and threads; each build takes what it needs from it and adds
/// what is new.
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
/// on what the cache holds. Errors: invalid_argument (plan_depth); too_large past 2^31 - 1 corners or rings.
template <class Real>
Result<BasicPatchTable<Real>> build_patch_table(const ControlMesh& mesh, const PatchTableOptions& options,
                                                const PlanCache* cache = nullptr);

/// The limit of one face-varying channel: the same surfaces' faces, in the channel's values.
/// Errors: and unsupported with Chaikin creasing, whose rules look beyond seams.
template <class Real>
Result<BasicPatchTable<Real>> build_face_varying_patch_table(const ControlMesh& mesh, uint32_t channel,
                                                             const PatchTableOptions& options,
                                                             const PlanCache* cache = nullptr);

}  // namespace limn
