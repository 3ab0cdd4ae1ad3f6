// Composition of refinement steps: rows over the control points. Not part of the public interface.
#pragma once

#include "limn/stencil_table.h"

namespace limn {

enum class Target : uint8_t { refined, limit, limit_with_tangents };

struct ComposeOptions {
    uint32_t level;  ///< whose vertices the rows make; at least 1 for Target::refined
    Interpolation interpolation;
    Target target;
    BuildPart control = {};
};

template <class Real>
Result<BasicStencilTable<Real>> compose(const Refinement& refinement, const ComposeOptions& options);

/// The base face that face f of a level descends from.
uint32_t base_face_of(const Refinement& refinement, uint32_t level, uint32_t f);

inline constexpr uint64_t kMaxTableEntries = 0xffffffff;
/// What larger tables are refused with.
Error too_many_entries(uint64_t entries);

/// Row sizes, with room for one more entry at the end -> offsets. Error: too_large past 2^32 - 1 entries.
Result<void> offsets_from_sizes(Array<uint32_t>& sizes);

}  // namespace limn
