// OpenSubdiv, the peer: its refiner, its truth in double, its stencil tables.
#pragma once

#include <opensubdiv/far/stencilTable.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/far/topologyRefiner.h>

#include <memory>
#include <vector>

#include "limn/control_mesh.h"

namespace limn::bench {

using OsdRefiner = std::unique_ptr<OpenSubdiv::Far::TopologyRefiner>;

/// A control mesh as OpenSubdiv takes it: converted once, so that conversion is not a part of its times.
class OsdMesh {
  public:
    explicit OsdMesh(const ControlMesh& mesh);
    /// The base level. Null when OpenSubdiv refuses the mesh.
    OsdRefiner create() const;
    /// And levels 1 .. level.
    OsdRefiner refine(uint32_t level) const;

  private:
    std::vector<int> face_sizes_, face_vertices_, creases_, corners_, holes_;
    std::vector<float> crease_sharpness_, corner_sharpness_;
    OpenSubdiv::Far::TopologyDescriptor descriptor_;
    OpenSubdiv::Sdc::SchemeType scheme_;
    OpenSubdiv::Sdc::Options options_;
};

/// Points of the last level in double, level by level: 3 per vertex.
std::vector<double> osd_points(const OpenSubdiv::Far::TopologyRefiner& refiner,
                               const std::vector<float>& positions);

enum class OsdTableKind {
    last_level,         ///< over the control points, of the last level only
    all_levels,         ///< over the control points, of all levels: the factory's default
    all_levels_chained  ///< each level over the one before
};

struct OsdTable {
    OsdTableKind kind;
    std::unique_ptr<const OpenSubdiv::Far::StencilTable> table;
    uint32_t control_count = 0;
    /// Rows [begin, end) are evaluated together. With control points and the points of all rows one after the
    /// other, their indices count from point `source`.
    struct Pass {
        uint32_t begin, end, source;
    };
    std::vector<Pass> passes;

    uint64_t row_count() const { return table->GetSizes().size(); }
    uint64_t entry_count() const { return table->GetWeights().size(); }
    uint64_t bytes() const {
        return 8 * row_count() + 8 * entry_count();
    }                                                                  // sizes, offsets; indices, weights
    uint64_t last_level_begin() const { return passes.back().begin; }  // not of all_levels
    /// Points that passes read and write, each pass reading what it refers to once.
    uint64_t moved_points() const;
};
OsdTable build_osd_table(const OpenSubdiv::Far::TopologyRefiner& refiner, OsdTableKind kind);

}  // namespace limn::bench
