#include "limn/crowd_points.h"

#include <algorithm>
#include <bit>
#include <cassert>

#include "limn/refined_points.h"

namespace limn {
namespace {

constexpr uint32_t kMaxShortPairs = 32;  // as kernels of short rows are unrolled for
constexpr uint64_t kMaxPoolPairs = uint64_t{1}
                                   << 22;  // 32 MiB: a quarter of the smallest maxStorageBufferRange
constexpr uint32_t kLeastPool = 64;        // items: a dispatch has its price
constexpr uint32_t kNoRow = 0xffffffff;

/// Pairs of an item that a row of so many entries goes into: few sizes, since each is a dispatch.
uint32_t size_of(uint32_t entry_count) {
    const uint32_t pairs = std::max(1u, entry_count / 2 + entry_count % 2);
    if (pairs <= 6) return pairs;
    return pairs <= kMaxShortPairs ? (pairs + 3) / 4 * 4 : std::bit_ceil(pairs);
}
/// With its row: of short rows half a pair, rounded up for all together.
uint64_t item_pairs(uint32_t pair_count) {
    return 2 * uint64_t{pair_count} + (pair_count > kMaxShortPairs ? 2 : 1);
}
uint64_t most_items(uint32_t pair_count) {
    return kMaxPoolPairs / item_pairs(pair_count);
}

std::map<uint32_t, uint32_t> count_rows(const PatchTable& mesh) {
    std::map<uint32_t, uint32_t> rows;
    for (const PointRun& run : mesh.point_runs) rows[size_of(run.entry_count)] += run.row_count;
    return rows;
}

}  // namespace

void CrowdPoints::expect(const PatchTable& mesh) {
    for (const auto& [size, count] : count_rows(mesh)) expected_[size] += count;
}

bool CrowdPoints::lay_out(float reserve) {
    // Half of the reserve is in pools, half for pools to come.
    const auto with_reserve = [&](uint64_t count) {
        return count + static_cast<uint64_t>(static_cast<double>(reserve) / 2 * static_cast<double>(count)) +
               kLeastPool;
    };
    uint64_t pairs = 0;
    for (const auto& [size, count] : expected_) pairs += with_reserve(count) * item_pairs(size);
    pairs = with_reserve(pairs) + 64 * kLeastPool;
    if (2 * pairs > kInvalidIndex) return false;
    words_.assign(2 * pairs, 0);
    for (const auto& [size, count] : expected_)
        for (uint64_t left = with_reserve(count); left != 0;) {
            const uint64_t items = std::min(left, most_items(size));
            if (!add_pool(size, items)) return false;
            left -= items;
        }
    return true;
}

bool CrowdPoints::add_pool(uint32_t pair_count, uint64_t item_count) {
    const uint64_t room = words_.size() / 2 - pair_end_;
    item_count = std::min({item_count, room / item_pairs(pair_count), most_items(pair_count)});
    if (item_count == 0) return false;
    PointPool pool = {
        pair_count, static_cast<uint32_t>(item_count), pair_count > kMaxShortPairs, pair_end_, 0, 0, 0, 0};
    pool.index_offset = pool.begin;
    pool.weight_offset = pool.index_offset + pair_count * item_count;
    pool.row_offset = pool.weight_offset + pair_count * item_count;
    const uint64_t rows = pool.is_long ? 2 * item_count : (item_count + 1) / 2;
    pool.end = pair_end_ = pool.row_offset + rows;
    for (uint64_t i = 0; i < item_count; ++i)
        words_[2 * pool.row_offset + i * (pool.is_long ? 4 : 1)] = kNoRow;
    changes.mark(2 * pool.begin, 2 * (pool.end - pool.begin));
    pools_.push_back(pool);
    free_.emplace_back(pool.item_count);
    return true;
}

bool CrowdPoints::take(uint32_t pair_count, uint32_t count, PointItems& out) {
    uint64_t alike = 0;
    for (int attempt = 0; attempt < 2; ++attempt) {
        for (uint32_t p = 0; p < pools_.size(); ++p) {
            if (pools_[p].pair_count != pair_count) continue;
            out = {p, free_[p].take(count), count};
            if (out.first != kInvalidIndex) return true;
            alike += pools_[p].item_count;
        }
        if (!add_pool(pair_count, std::max<uint64_t>({count, alike / 2, kLeastPool}))) break;
    }
    return false;
}

bool CrowdPoints::add(const PatchTable& mesh, uint32_t first_control, uint32_t first_row,
                      std::vector<PointItems>& items) {
    for (const auto& [size, count] : count_rows(mesh)) {
        PointItems all = {};
        if (!take(size, count, all)) return false;
        items.push_back(all);
        PointItems next = all;
        for (const PointRun& run : mesh.point_runs) {
            if (size_of(run.entry_count) != size) continue;
            write_run(mesh, run, first_control, first_row, next);
            next.first += run.row_count;
        }
        mark(all);
    }
    return true;
}

void CrowdPoints::write_run(const PatchTable& mesh, const PointRun& run, uint32_t first_control,
                            uint32_t first_row, const PointItems& items) {
    const PointPool& pool = pools_[items.pool];
    const std::vector<uint32_t> order =
        order_by_weight(std::span(mesh.point_weights.data() + run.first_weight, run.entry_count));
    const uint64_t pitch = pool.is_long ? 1 : pool.item_count;
    for (uint32_t r = 0; r < run.row_count; ++r) {
        const uint64_t item = items.first + r, at = pool.is_long ? item * pool.pair_count : item;
        for (uint32_t k = 0; k < 2 * pool.pair_count; ++k) {
            const uint32_t entry = order[std::min(k, run.entry_count - 1)];
            const uint64_t word = 2 * (at + k / 2 * pitch) + k % 2;
            words_[2 * pool.index_offset + word] =
                mesh.point_indices[run.first_index + size_t{r} * run.entry_count + entry] + first_control;
            words_[2 * pool.weight_offset + word] =
                k < run.entry_count ? std::bit_cast<uint32_t>(mesh.point_weights[run.first_weight + entry])
                                    : 0;
        }
        const uint32_t row = run.first_point - mesh.first_refined + r + first_row;
        if (!pool.is_long) {
            words_[2 * pool.row_offset + item] = row;
            continue;
        }
        uint32_t* head = words_.data() + 2 * pool.row_offset + 4 * item;
        head[0] = row;
        head[1] = static_cast<uint32_t>(at);
        head[2] = pool.pair_count;
    }
}

void CrowdPoints::mark(const PointItems& items) {
    const PointPool& pool = pools_[items.pool];
    for (const uint64_t offset : {pool.index_offset, pool.weight_offset}) {
        if (pool.is_long)
            changes.mark(2 * (offset + uint64_t{items.first} * pool.pair_count),
                         uint64_t{2} * items.count * pool.pair_count);
        else
            for (uint64_t g = 0; g < pool.pair_count; ++g)
                changes.mark(2 * (offset + g * pool.item_count + items.first), uint64_t{2} * items.count);
    }
    const uint64_t row_words = pool.is_long ? 4 : 1;
    changes.mark(2 * pool.row_offset + items.first * row_words, items.count * row_words);
}

void CrowdPoints::remove(std::vector<PointItems>& items) {
    for (const PointItems& some : items) {
        const PointPool& pool = pools_[some.pool];
        const uint64_t row_words = pool.is_long ? 4 : 1, first = 2 * pool.row_offset + some.first * row_words;
        for (uint64_t i = 0; i < some.count; ++i) words_[first + i * row_words] = kNoRow;
        changes.mark(first, some.count * row_words);
        free_[some.pool].give_back(some.first, some.count);
    }
    items.clear();
}

}  // namespace limn
