// How a stencil table is laid out for the device: rows of one size lie together, transposed, in runs that a
// dispatch can bind; rows with the same weights share them. limn/shared/stencil_eval_params.h has the layout
// of a run. Not part of the public interface.
#pragma once

#include <vector>

#include "limn/shared/stencil_eval_params.h"
#include "limn/stencil_table.h"

namespace limn::vk {

inline constexpr uint64_t kNoPairs = ~uint64_t{0};

/// Rows for one dispatch. Offsets are in pairs from the beginning of the device table.
struct StencilRun {
    uint32_t kind = 0;         ///< kStencilRunShared, kStencilRunOwn or kStencilRunLong
    uint32_t entry_count = 0;  ///< of each row; own: rounded up to pairs; long: 0
    uint32_t item_count = 0;   ///< rows
    uint32_t row_begin =
        0;  ///< its rows lie in [row_begin, row_end): all of these where they are consecutive
    uint32_t row_end = 0;
    uint32_t source_min =
        0;  ///< its indices lie in [source_min, source_max]; source_min > source_max: it has none
    uint32_t source_max = 0;
    uint64_t begin = 0;  ///< everything below lies in [begin, end)
    uint64_t end = 0;
    uint64_t index_offset = 0;
    uint64_t row_offset = kNoPairs;
    uint64_t weight_offsets[3] = {};  ///< points, first and second tangents; own and long
    float weights[shared::kStencilEvalMaxSharedWeights] = {};

    uint32_t pair_count() const { return (entry_count + 1) / 2; }
    bool has_consecutive_rows() const { return row_offset == kNoPairs; }
    bool operator==(const StencilRun&) const = default;
};

/// Weights that many rows share, largest first; a row's entries are put into this order.
struct WeightPattern {
    uint32_t entry_count = 0;
    uint32_t value_count = 0;                                    ///< distinct weights
    uint32_t values[shared::kStencilEvalMaxSharedWeights] = {};  ///< bits of each distinct weight
    uint32_t first[shared::kStencilEvalMaxSharedWeights] = {};   ///< and where its entries begin
    uint32_t count[shared::kStencilEvalMaxSharedWeights] = {};   ///< and how many there are
};

/// A layout: first planned, then written to memory that the plan gives the size of.
struct StencilRuns {
    std::vector<StencilRun> runs;
    uint64_t pair_count = 0;  ///< of the device table

    // How rows map to runs, needed by write_stencil_runs only.
    std::vector<WeightPattern> patterns;
    Array<uint8_t> classes;           ///< row_count: rows of a class have the same kind and size
    std::vector<uint32_t> first_run;  ///< of each class, and one more
    std::vector<uint32_t>
        chunk_items;  ///< [chunk * class_count + class]: rows of the class in earlier chunks
};

/// Time is linear in the table, on all cores; the result does not depend on their number.
/// Errors: too_large when a single row is larger than a device can bind.
Result<StencilRuns> plan_stencil_runs(const StencilTable& table);

/// Writes 2 * runs.pair_count words, and source_min and source_max of the runs.
void write_stencil_runs(const StencilTable& table, StencilRuns& runs, uint32_t* words);

}  // namespace limn::vk
