// Tables made row by row, on all cores. Not part of the public interface.
#pragma once

#include <algorithm>

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
    for (const RowEntry& entry : row) {
        size_t k = row.size() > kLong && out > 0 ? out - 1 : 0;
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

/// A table of `row_count` rows over source_count points; row_of(r, row) appends row r, and is called twice for each: to
/// count its entries, and to write them. Errors: too_large past 2^32 - 1 entries, cancelled.
template <class Real, class RowOf>
Result<BasicStencilTable<Real>> build_table_of_rows(uint32_t source_count, uint32_t row_count, const BuildPart& part,
                                                    const RowOf& row_of) {
    BasicStencilTable<Real> table;
    table.source_count = source_count;
    table.offsets.allocate(size_t{row_count} + 1);
    table.offsets.back() = 0;
    for_each_row(row_count, part.part(0, 0.5f), [&](uint32_t r, Row& row) {
        row_of(r, row);
        merge_repeated(row);
        table.offsets[r] = static_cast<uint32_t>(row.size());
    });
    if (auto ok = part.check(); !ok) return ok.error();
    if (auto ok = offsets_from_sizes(table.offsets); !ok) return ok.error();
    table.indices.allocate(table.offsets.back());
    table.weights.allocate(table.offsets.back());
    for_each_row(row_count, part.part(0.5f, 0.95f), [&](uint32_t r, Row& row) {
        row_of(r, row);
        merge_repeated(row);
        uint32_t at = table.offsets[r];
        for (const RowEntry& entry : row) {
            table.indices[at] = entry.index;
            table.weights[at++] = static_cast<Real>(entry.weight);
        }
    });
    if (auto ok = part.reach(1); !ok) return ok.error();
    return table;
}

}  // namespace limn
