// The words of a tessellation table on the device. Not part of the public interface.
#pragma once

#include "limn/vulkan/table_upload.h"
#include "limn/vulkan/tessellation_tables.h"

namespace limn::vk {

/// Where sections begin.
struct TessellationOffsets {
    shared::TreeOffsets vertices = {};
    std::vector<shared::TreeOffsets> channels = {};
    shared::TessOffsets topology = {};
    uint32_t instances = 0;
};

/// Words that are not a table's own.
struct MadeWords {
    Array<uint32_t> copies, instances;
};

/// Trees first, which start at offsets of `out`, as all sections do. `made`, what is made for them, has to
/// live as long as they are in use.
std::vector<TableSection> sections_of(const TessellationTable& table, const PatchTreeTable& vertices,
                                      std::span<const PatchTreeTable* const> channels,
                                      TessellationOffsets& out, MadeWords& made);
void set_offsets(const TessellationOffsets& offsets, DeviceTessellationTable& out);
/// All that does not depend on trees, or on how words are laid out.
void describe(const TessellationTable& table, DeviceTessellationTable& out);

}  // namespace limn::vk
