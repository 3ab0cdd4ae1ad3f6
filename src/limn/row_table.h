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
        else if (&row[out++] != &entry)
            row[out - 1] = entry;
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
    uint64_t first_entry = 0;  ///< where they go

    void clear() {  // keeps its memory
        indices.resize(0);
        weights.resize(0);
    }
    /// Returns where the row begins within the block.
    uint32_t append(const Row& row) {
        const size_t at = indices.size();
        indices.resize(at + row.size());
        weights.resize(at + row.size());
        for (size_t k = 0; k < row.size(); ++k) {
            indices[at + k] = row[k].index;
            weights[at + k] = static_cast<Real>(row[k].weight);
        }
        return static_cast<uint32_t>(at);
    }
};

/// Some thousand rows at a time, which stay in cache until they go to the end of a table.
template <class Real>
class RowWindow {
  public:
    static constexpr uint32_t kBlock = 512, kRows = 128 * kBlock;

    /// Makes rows [first, first + count), count <= kRows; the table receives where each begins within its block.
    template <class RowOf>
    void fill(BasicStencilTable<Real>& table, uint32_t first, uint32_t count, const BuildPart& part,
              const RowOf& row_of) {
        blocks_.resize(std::max<size_t>(blocks_.size(), (count - 1) / kBlock + 1));
        for_each_block(count, part, kBlock, [&](uint32_t begin, uint32_t end) {
            RowBlock<Real>& block = blocks_[begin / kBlock];
            block.clear();
            Row row;
            for (uint32_t r = first + begin; r != first + end; ++r) {
                row.clear();
                row_of(r, row);
                merge_repeated(row);
                table.offsets[r] = block.append(row);
            }
        });
    }
    /// Appends them to the table. Errors: too_large.
    Result<void> move_to(BasicStencilTable<Real>& table, uint32_t first, uint32_t count, const BuildPart& part) {
        uint64_t entries = table.indices.size();
        for (uint32_t b = 0; b * kBlock < count; ++b) {
            blocks_[b].first_entry = entries;
            entries += blocks_[b].indices.size();
        }
        if (entries > kMaxTableEntries) return too_many_entries(entries);
        table.indices.resize(entries);
        table.weights.resize(entries);
        for_each_block(count, part, kBlock, [&](uint32_t begin, uint32_t end) {
            const RowBlock<Real>& block = blocks_[begin / kBlock];
            std::copy(block.indices.begin(), block.indices.end(), table.indices.begin() + block.first_entry);
            std::copy(block.weights.begin(), block.weights.end(), table.weights.begin() + block.first_entry);
            for (uint32_t r = first + begin; r != first + end; ++r)
                table.offsets[r] += static_cast<uint32_t>(block.first_entry);
        });
        return {};
    }

  private:
    std::vector<RowBlock<Real>> blocks_;
};

/// How many entries to make room for, by a sample of the rows; never very many, as that may be wrong.
template <class RowOf>
uint64_t estimate_entries(uint32_t row_count, const RowOf& row_of) {
    constexpr uint32_t kSample = 1024;
    constexpr uint64_t kMost = uint64_t{1} << 26;
    uint64_t entries = 0;
    Row row;
    for (uint32_t i = 0; i < kSample; ++i) {
        row.clear();
        row_of(static_cast<uint32_t>(uint64_t{i} * row_count / kSample), row);
        entries += row.size();
    }
    return std::min(kMost, entries * row_count / kSample * 17 / 16);
}

/// A table of `row_count` rows over source_count points; row_of(r, row) appends row r, the same each time.
/// Errors: too_large past 2^32 - 1 entries, cancelled.
template <class Real, class RowOf>
Result<BasicStencilTable<Real>> build_table_of_rows(uint32_t source_count, uint32_t row_count, const BuildPart& part,
                                                    const RowOf& row_of) {
    BasicStencilTable<Real> table;
    table.source_count = source_count;
    table.offsets.allocate(size_t{row_count} + 1);
    RowWindow<Real> window;
    if (row_count > window.kRows) {
        const uint64_t room = estimate_entries(row_count, row_of);
        table.indices.reserve(room);
        table.weights.reserve(room);
    }
    const auto share = [&](uint32_t row) { return static_cast<float>(row) / static_cast<float>(row_count); };
    for (uint32_t first = 0, count; first < row_count; first += count) {
        count = std::min(window.kRows, row_count - first);
        const BuildPart to_there = part.part(share(first), share(first + count));
        window.fill(table, first, count, to_there, row_of);
        if (auto ok = part.check(); !ok) return ok.error();
        if (auto ok = window.move_to(table, first, count, to_there.part(1, 1)); !ok) return ok.error();
    }
    table.offsets.back() = static_cast<uint32_t>(table.indices.size());
    if (auto ok = part.reach(1); !ok) return ok.error();
    return table;
}

}  // namespace limn
