// A small hash map from indices to indices. Not part of the public interface.
#pragma once

#include <cstdint>
#include <vector>

namespace limn {

/// For some thousand keys; memory is kept and clear() is cheap.
class IndexMap {
  public:
    static constexpr uint32_t kMissing = ~uint32_t{0};

    IndexMap() = default;
    /// For keys below `key_bound`; where that is small, a plain array takes the place of hashing.
    explicit IndexMap(uint32_t key_bound);

    void clear();
    /// The value of `key`; when new, `next` is stored and returned.
    uint32_t find_or_insert(uint32_t key, uint32_t next) {
        if (direct_.empty()) return hashed_find_or_insert(key, next);
        if (direct_[key] == kMissing) direct_[key] = next;
        return direct_[key];
    }
    /// The value of `key` or kMissing.
    uint32_t find(uint32_t key) const { return direct_.empty() ? hashed_find(key) : direct_[key]; }

  private:
    uint32_t slot_of(uint32_t key) const {
        return (key * 2654435769u) >> 7 & static_cast<uint32_t>(slots_.size() - 1);
    }
    uint32_t hashed_find_or_insert(uint32_t key, uint32_t next) {
        if (2 * (count_ + 1) > slots_.size()) grow();
        const auto mask = static_cast<uint32_t>(slots_.size() - 1);
        uint32_t i = slot_of(key);
        for (; slots_[i].stamp == stamp_; i = (i + 1) & mask)
            if (slots_[i].key == key) return slots_[i].value;
        slots_[i] = {key, next, stamp_};
        ++count_;
        return next;
    }
    uint32_t hashed_find(uint32_t key) const;
    void grow();
    struct Slot {
        uint32_t key, value, stamp;
    };
    std::vector<uint32_t> direct_;
    std::vector<Slot> slots_;
    uint32_t stamp_ = 1, count_ = 0;
};

}  // namespace limn
