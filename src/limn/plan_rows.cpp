#include "limn/plan_rows.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace limn {
namespace {

/// Four sums at a time, so that none waits for another.
uint64_t hash_row(const double* row, size_t width) {
    constexpr uint64_t kFactor = 0x9e3779b97f4a7c15;
    uint64_t sums[4] = {1, 2, 3, 4};
    size_t j = 0;
    for (; j + 4 <= width; j += 4)
        for (size_t k = 0; k < 4; ++k)
            sums[k] = std::rotl((sums[k] ^ std::bit_cast<uint64_t>(row[j + k])) * kFactor, 29);
    for (size_t k = 0; j < width; ++j, ++k)
        sums[k] = std::rotl((sums[k] ^ std::bit_cast<uint64_t>(row[j])) * kFactor, 29);
    uint64_t hash = sums[0];
    for (size_t k = 1; k < 4; ++k) hash = (std::rotl(hash, 17) ^ sums[k]) * kFactor;
    return hash ^ hash >> 32;
}

}  // namespace

void PlanRows::begin(BuiltPlan& plan) {
    plan_ = &plan;
    weights_.clear();
    slots_.assign(std::max<size_t>(slots_.size(), 256), Slot{0, kInvalidIndex});
    used_ = 0;
}

uint32_t PlanRows::append(const double* row) {
    const size_t stride = shared::plan_row_stride(plan_->ring_size);
    weights_.insert(weights_.end(), row, row + width());
    weights_.resize(++plan_->row_count * stride, 0.0);
    return plan_->row_count - 1;
}

uint32_t PlanRows::write(double* row) {
    for (size_t j = 0; j < width(); ++j) row[j] += 0.0;
    const uint64_t hash = hash_row(row, width());
    const size_t stride = shared::plan_row_stride(plan_->ring_size), mask = slots_.size() - 1;
    size_t at = hash & mask;
    for (; slots_[at].row != kInvalidIndex; at = (at + 1) & mask)
        if (slots_[at].hash == hash &&
            std::memcmp(row, weights_.data() + slots_[at].row * stride, width() * sizeof(double)) == 0)
            return slots_[at].row;
    const uint32_t number = append(row);
    slots_[at] = {hash, number};
    if (2 * ++used_ > slots_.size()) grow();
    return number;
}

void PlanRows::grow() {
    const std::vector<Slot> old =
        std::exchange(slots_, std::vector<Slot>(2 * slots_.size(), Slot{0, kInvalidIndex}));
    const size_t mask = slots_.size() - 1;
    for (const Slot& slot : old) {
        if (slot.row == kInvalidIndex) continue;
        size_t at = slot.hash & mask;
        while (slots_[at].row != kInvalidIndex) at = (at + 1) & mask;
        slots_[at] = slot;
    }
}

void LazyRows::begin(const Topology& parent, size_t width, uint32_t count, RowCache* star) {
    parent_ = &parent;
    parent_rows_ = nullptr;
    above_ = nullptr;
    star_ = star;
    rows.width = width;
    if (rows.values.size() < count * width) rows.values.resize(count * width);
    made_.assign(count, 0);
    numbers_.assign(count, kInvalidIndex);
}

void LazyRows::begin(const Topology& parent, const VertexRows& parent_rows, uint32_t count) {
    begin(parent, parent_rows.width, count, nullptr);
    parent_rows_ = &parent_rows;
}

void LazyRows::begin_star(const Topology& parent, RowCache& cache, size_t width, uint32_t count) {
    begin(parent, width, count, &cache);
}

void LazyRows::begin_star(const Topology& parent, RowCache& cache, LazyRows& above,
                          const std::vector<uint32_t>& vertices, uint32_t count) {
    begin(parent, above.rows.width, count, &cache);
    above_ = &above;
    above_vertices_ = &vertices;
}

void LazyRows::begin(const VertexRows& known, uint32_t count) {
    rows = known;
    star_ = nullptr;
    made_.assign(count, 1);
    numbers_.assign(count, kInvalidIndex);
}

void LazyRows::make(uint32_t v) {
    made_[v] = 1;
    std::span<const RowEntry> entries;
    if (star_ != nullptr) {
        entries = star_->row(*parent_, v);
    } else {
        scratch_.clear();
        refinement_row(*parent_, v, Interpolation::vertex, scratch_);
        entries = scratch_;
    }
    double* const sum = rows.row(v);
    std::fill_n(sum, rows.width, 0.0);
    if (parent_rows_ == nullptr && above_ == nullptr) {  // points of the ring themselves
        for (const RowEntry& e : entries) sum[e.index] += e.weight;
        return;
    }
    // Three at a time, added one after the other.
    size_t k = 0;
    for (; k + 3 <= entries.size(); k += 3) {
        const double *a = parent_row(entries[k].index), *b = parent_row(entries[k + 1].index),
                     *c = parent_row(entries[k + 2].index);
        const double wa = entries[k].weight, wb = entries[k + 1].weight, wc = entries[k + 2].weight;
        for (size_t j = 0; j < rows.width; ++j) sum[j] = sum[j] + wa * a[j] + wb * b[j] + wc * c[j];
    }
    for (; k < entries.size(); ++k) {
        const double* from = parent_row(entries[k].index);
        for (size_t j = 0; j < rows.width; ++j) sum[j] += entries[k].weight * from[j];
    }
}

std::span<const RowEntry> RowCache::row(const Topology& parent, uint32_t child) {
    Place& place = places_[child];
    if (place.count == 0) {
        place.first = static_cast<uint32_t>(entries_.size());
        refinement_row(parent, child, Interpolation::vertex, entries_);
        place.count = static_cast<uint32_t>(entries_.size()) - place.first;
    }
    return {entries_.data() + place.first, place.count};
}

}  // namespace limn
