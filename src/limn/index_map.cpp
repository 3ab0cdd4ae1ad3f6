#include "limn/index_map.h"

#include <algorithm>

namespace limn {

IndexMap::IndexMap(uint32_t key_bound) {
    constexpr uint32_t kSmall = 1024;
    if (key_bound <= kSmall) direct_.assign(key_bound, kMissing);
}

void IndexMap::clear() {
    std::fill(direct_.begin(), direct_.end(), kMissing);
    count_ = 0;
    if (++stamp_ != 0) return;
    for (Slot& slot : slots_) slot.stamp = 0;
    stamp_ = 1;
}

uint32_t IndexMap::hashed_find(uint32_t key) const {
    if (slots_.empty()) return kMissing;
    const auto mask = static_cast<uint32_t>(slots_.size() - 1);
    for (uint32_t i = slot_of(key); slots_[i].stamp == stamp_; i = (i + 1) & mask)
        if (slots_[i].key == key) return slots_[i].value;
    return kMissing;
}

void IndexMap::grow() {
    IndexMap larger;
    larger.slots_.assign(std::max<size_t>(256, 2 * slots_.size()), Slot{0, 0, 0});
    for (const Slot& slot : slots_)
        if (slot.stamp == stamp_) larger.hashed_find_or_insert(slot.key, slot.value);
    *this = std::move(larger);
}

}  // namespace limn
