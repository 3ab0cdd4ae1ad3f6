// Stencil tables row by row, and products of them. Not part of the public interface.
#pragma once

#include <vector>

#include "limn/stencil_table.h"

namespace limn {

/// A row that is being made: equal indices add up, entries stay in the order of their first appearance. Rows
/// are short.
struct SparseRow {
    struct Entry {
        uint32_t index;
        double weight, tangent1, tangent2;
    };
    std::vector<Entry> entries;

    void add(uint32_t index, double weight, double tangent1 = 0, double tangent2 = 0) {
        for (Entry& entry : entries) {
            if (entry.index != index) continue;
            entry.weight += weight;
            entry.tangent1 += tangent1;
            entry.tangent2 += tangent2;
            return;
        }
        entries.push_back({index, weight, tangent1, tangent2});
    }
};

/// A table without rows.
inline StencilTableDouble make_empty_table(uint32_t source_count) {
    StencilTableDouble table;
    table.source_count = source_count;
    table.offsets.push_back(0);
    return table;
}

inline void append_row(StencilTableDouble& table, const SparseRow& row, bool tangents) {
    for (const SparseRow::Entry& entry : row.entries) {
        table.indices.push_back(entry.index);
        table.weights.push_back(entry.weight);
        if (!tangents) continue;
        table.tangent1_weights.push_back(entry.tangent1);
        table.tangent2_weights.push_back(entry.tangent2);
    }
    table.offsets.push_back(static_cast<uint32_t>(table.indices.size()));
}

/// The rows of `after`, which refer to rows of `before`, over what those refer to.
inline StencilTableDouble multiply_tables(const StencilTableDouble& after, const StencilTableDouble& before) {
    StencilTableDouble product = make_empty_table(before.source_count);
    const bool tangents = !after.tangent1_weights.empty();
    SparseRow row;
    for (uint32_t r = 0; r < after.row_count(); ++r) {
        row.entries.clear();
        for (uint32_t k = after.offsets[r]; k < after.offsets[r + 1]; ++k) {
            const double tangent1 = tangents ? after.tangent1_weights[k] : 0;
            const double tangent2 = tangents ? after.tangent2_weights[k] : 0;
            const uint32_t middle = after.indices[k];
            for (uint32_t j = before.offsets[middle]; j < before.offsets[middle + 1]; ++j) {
                const double weight = before.weights[j];
                row.add(before.indices[j], after.weights[k] * weight, tangent1 * weight, tangent2 * weight);
            }
        }
        append_row(product, row, tangents);
    }
    return product;
}

template <class Real>
BasicStencilTable<Real> convert_table(StencilTableDouble&& table) {
    if constexpr (std::is_same_v<Real, double>) {
        return std::move(table);
    } else {
        BasicStencilTable<Real> out;
        out.source_count = table.source_count;
        out.offsets = std::move(table.offsets);
        out.indices = std::move(table.indices);
        const auto convert = [](const Array<double>& from, Array<Real>& to) {
            to.allocate(from.size());
            for (size_t i = 0; i < from.size(); ++i) to[i] = static_cast<Real>(from[i]);
        };
        convert(table.weights, out.weights);
        convert(table.tangent1_weights, out.tangent1_weights);
        convert(table.tangent2_weights, out.tangent2_weights);
        return out;
    }
}

}  // namespace limn
