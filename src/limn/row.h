// One row of a table in the making: a point as a weighted sum of others.
#pragma once

#include <cstdint>
#include <vector>

namespace limn {

/// An index may occur more than once in a row; its weights then add up. Around alike vertices rows list their
/// entries in the same order.
struct RowEntry {
    uint32_t index;
    double weight;
};
using Row = std::vector<RowEntry>;

}  // namespace limn
