// All that is needed of a mesh at run time, made ahead of it: tables, and control points to begin with.
// baked_file.h keeps it in a file.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "limn/patch_tree.h"
#include "limn/refined_grid.h"
#include "limn/stencil_table.h"
#include "limn/tessellation_table.h"

namespace limn {

/// 128 bits of XXH3 over contents, the same on every machine.
struct ContentHash {
    uint64_t high = 0, low = 0;
    bool operator==(const ContentHash&) const = default;
    std::string hex() const;  ///< 32 digits
};

/// What to bake.
struct BakeOptions {
    /// Of vertices, and of channels. Interpolation stays that of vertices, end caps have no trees.
    PatchTableOptions patches;
    bool split_creases = true;  ///< as TessellationTableOptions
    uint32_t max_rate = 64;     ///< as PatchTreeOptions; 0: no trees, which only devices need
    /// Values of face-varying channels 0, 1, ..: value_count * width floats, width 1 .. 4. Channels of the mesh
    /// without values here are not baked.
    std::vector<std::span<const float>> channel_values;
    // And only where asked for:
    std::vector<uint32_t> grid_rates;      ///< grids of the limit surface, by GridOptions::rate
    std::vector<uint32_t> refined_levels;  ///< refined grids, by level
    std::vector<uint32_t> stencil_levels;  ///< rows for each point of these levels
    std::vector<uint32_t> limit_levels;    ///< rows for limits and two tangents of the vertices of these levels
};

/// A face-varying channel; its control points are its values.
struct BakedChannel {
    uint32_t width = 0;
    Array<float> values;  ///< width * patches.control_count
    PatchTable patches;
    PatchTreeTable trees;
};

struct BakedStencils {
    uint32_t level = 0;
    bool limit = false;
    StencilTable table;
};

/// Tables are like those that builders return, whether they own what they hold or borrow it from a file.
struct BakedMesh {
    ContentHash key;  ///< content_hash of what it was made from
    PatchTable patches;
    TessellationTable tessellation;
    PatchTreeTable trees;         ///< empty where BakeOptions::max_rate is 0
    Array<float> positions;       ///< 3 * patches.control_count, or none
    Array<uint32_t> edges;        ///< of the control mesh: pairs of vertices
    uint32_t face_count = 0;      ///< of the control mesh
    std::vector<BakedChannel> channels;
    std::vector<GridTable> grids;
    std::vector<RefinedGridTable> refined;
    std::vector<BakedStencils> stencils;

    uint64_t bytes() const;
};

/// A key for what is baked of these: equal where descriptions and options are, element for element, and where files
/// have the same format. It depends neither on byte order nor on padding.
ContentHash content_hash(const ControlMeshDescription& description, const BakeOptions& options);

/// Builds all of it. Errors: as ControlMesh::create and the builders; invalid_argument (values of a channel that the
/// mesh has not, or whose number is no multiple of its value_count, 1 to 4 times).
Result<BakedMesh> bake_mesh(const ControlMeshDescription& description, const BakeOptions& options);

}  // namespace limn
