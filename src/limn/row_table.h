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
    Array<uint32_t> indices;
    Array<Real> weights;

    /// Rows [begin, end); `offsets` receives where each begins within the block.
    template <class RowOf>
    void fill(uint32_t begin, uint32_t end, const RowOf& row_of, uint32_t* offsets) {
        indices.resize(0);  // keeps its memory
        weights.resize(0);
        Row row;
        for (uint32_t r = begin; r != end; ++r) {
            row.clear();
            row_of(r, row);
            merge_repeated(row);
            append(row, *offsets++);
        }
    }
    void append(const Row& row, uint32_t& offset) {
        const size_t at = indices.size();
        offset = static_cast<uint32_t>(at);
        indices.resize(at + row.size());
        weights.resize(at + row.size());
        for (size_t k = 0; k < row.size(); ++k) {
            indices[at + k] = row[k].index;
            weights[at + k] = static_cast<Real>(row[k].weight);
        }
    }
    /// Copies all to where the table has entry `at` on; `offsets` are those of its rows.
    void move_to(BasicStencilTable<Real>& table, uint64_t at, std::span<uint32_t> offsets) const {
        std::copy(indices.begin(), indices.end(), table.indices.begin() + at);
        std::copy(weights.begin(), weights.end(), table.weights.begin() + at);
        for (uint32_t& offset : offsets) offset += static_cast<uint32_t>(at);
    }
};

/// How many entries to make room for: by some of the rows. Their number may be wrong, so not for very many.
template <class RowOf>
uint64_t estimate_entries(uint32_t row_count, const RowOf& row_of) {
    constexpr uint32_t kSample = 1024;
    constexpr uint64_t kMost = uint64_t{1} << 26;
    const uint32_t count = std::min(row_count, kSample);
    uint64_t entries = 0;
    Row row;
    for (uint32_t i = 0; i < count; ++i) {
        row.clear();
        row_of(static_cast<uint32_t>(uint64_t{i} * row_count / count), row);
        entries += row.size();
    }
    return std::min(kMost, entries * row_count / kSample * 17 / 16);
}

/// A table of `row_count` rows over source_count points; row_of(r, row) appends row r, the same each time.
/// Some thousand rows at a time are made, which stay in cache until it is known where they go.
/// Errors: too_large past 2^32 - 1 entries, cancelled.
template <class Real, class RowOf>
Result<BasicStencilTable<Real>> build_table_of_rows(uint32_t source_count, uint32_t row_count, const BuildPart& part,
                                                    const RowOf& row_of) {
    constexpr uint32_t kBlock = 512, kWindow = 128 * kBlock;
    BasicStencilTable<Real> table;
    table.source_count = source_count;
    table.offsets.allocate(size_t{row_count} + 1);
    std::vector<RowBlock<Real>> blocks(std::min(row_count, kWindow) / kBlock + 1);
    std::vector<uint64_t> firsts(blocks.size());
    if (row_count > kWindow) {
        const uint64_t room = estimate_entries(row_count, row_of);
        table.indices.reserve(room);
        table.weights.reserve(room);
    }
    for (uint32_t first = 0, count; first < row_count; first += count) {
        count = std::min(kWindow, row_count - first);
        uint32_t* offsets = table.offsets.data() + first;
        const auto share = [&](uint32_t row) { return static_cast<float>(row) / static_cast<float>(row_count); };
        for_each_block(count, part.part(share(first), share(first + count)), kBlock, [&](uint32_t begin, uint32_t end) {
            blocks[begin / kBlock].fill(first + begin, first + end, row_of, offsets + begin);
        });
        if (auto ok = part.check(); !ok) return ok.error();
        uint64_t entries = table.indices.size();
        for (uint32_t b = 0; b * kBlock < count; ++b) {
            firsts[b] = entries;
            entries += blocks[b].indices.size();
        }
        if (entries > kMaxTableEntries) return too_many_entries(entries);
        table.indices.resize(entries);
        table.weights.resize(entries);
        const BuildPart still = part.part(share(first + count), share(first + count));
        for_each_block(count, still, kBlock, [&](uint32_t begin, uint32_t end) {
            blocks[begin / kBlock].move_to(table, firsts[begin / kBlock], {offsets + begin, end - begin});
        });
    }
    table.offsets.back() = static_cast<uint32_t>(table.indices.size());
    if (auto ok = part.reach(1); !ok) return ok.error();
    return table;
}

}  // namespace limn
