// Tables made row by row, on all cores. Not part of the public interface.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "limn/compose.h"
#include "limn/parallel.h"
#include "limn/row.h"
#include "limn/stencil_table.h"

namespace limn {

/// Adds up repeated indices, keeping the order of first appearance.
inline void merge_repeated(Row& row) {
    constexpr size_t kLong = 64;  // poles: sort rather than compare all pairs
    if (row.size() > kLong)
        std::stable_sort(row.begin(), row.end(),
                         [](const RowEntry& a, const RowEntry& b) { return a.index < b.index; });
    size_t out = 0;
    uint64_t seen = 0;  // a bit for each remainder of indices: nearly all entries are known to be new by it
    for (const RowEntry& entry : row) {
        const uint64_t bit = uint64_t{1} << entry.index % 64;
        const bool is_new = (seen & bit) == 0;
        seen |= bit;
        size_t k = is_new ? out : row.size() > kLong && out > 0 ? out - 1 : 0;
        while (k < out && row[k].index != entry.index) ++k;
        if (k < out)
            row[k].weight += entry.weight;
        else
            row[out++] = entry;
    }
    row.resize(out);
}

/// body(r, row) for each row r < count, `row` being empty.
template <class Body>
void for_each_row(uint32_t count, const BuildPart& part, const Body& body) {
    for_each_block(count, part, 512, [&](uint32_t begin, uint32_t end) {
        Row row;
        for (uint32_t r = begin; r != end; ++r) {
            row.clear();
            body(r, row);
        }
    });
}

/// Rows of a block of a table, before it is known where they go.
template <class Real>
struct RowBlock {
    std::vector<uint32_t> indices;
    std::vector<Real> weights;
};

/// A table of `row_count` rows over source_count points; row_of(r, row) appends row r, and is called once for each.
/// Holds as much as the table beside it while it is built. Errors: too_large past 2^32 - 1 entries, cancelled.
template <class Real, class RowOf>
Result<BasicStencilTable<Real>> build_table_of_rows(uint32_t source_count, uint32_t row_count, const BuildPart& part,
                                                    const RowOf& row_of) {
    constexpr uint32_t kBlock = 1024;
    BasicStencilTable<Real> table;
    table.source_count = source_count;
    table.offsets.allocate(size_t{row_count} + 1);
    table.offsets.back() = 0;
    std::vector<RowBlock<Real>> blocks(row_count / kBlock + 1);
    for_each_block(row_count, part.part(0, 0.85f), kBlock, [&](uint32_t begin, uint32_t end) {
        RowBlock<Real>& block = blocks[begin / kBlock];
        Row row;
        for (uint32_t r = begin; r != end; ++r) {
            row.clear();
            row_of(r, row);
            merge_repeated(row);
            table.offsets[r] = static_cast<uint32_t>(row.size());
            for (const RowEntry& entry : row) {
                block.indices.push_back(entry.index);
                block.weights.push_back(static_cast<Real>(entry.weight));
            }
        }
    });
    if (auto ok = part.check(); !ok) return ok.error();
    if (auto ok = offsets_from_sizes(table.offsets); !ok) return ok.error();
    table.indices.allocate(table.offsets.back());
    table.weights.allocate(table.offsets.back());
    for_each_block(row_count, part.part(0.85f, 0.95f), kBlock, [&](uint32_t begin, uint32_t) {
        RowBlock<Real> block = std::move(blocks[begin / kBlock]);
        std::copy(block.indices.begin(), block.indices.end(), table.indices.begin() + table.offsets[begin]);
        std::copy(block.weights.begin(), block.weights.end(), table.weights.begin() + table.offsets[begin]);
    });
    if (auto ok = part.reach(1); !ok) return ok.error();
    return table;
}

}  // namespace limn
