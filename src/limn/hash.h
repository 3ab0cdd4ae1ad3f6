// XXH3 in 128 bits of what comes in pieces. Not part of the public interface.
#pragma once

#include <bit>
#include <cstddef>
#include <span>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "limn/baked_mesh.h"

namespace limn {

/// Bytes as they are; numbers and lists, each behind its length, as on a machine that puts low bytes first.
class ContentHasher {
  public:
    ContentHasher() { XXH3_128bits_reset(&state_); }
    void add_bytes(std::span<const std::byte> bytes) {
        if (!bytes.empty()) XXH3_128bits_update(&state_, bytes.data(), bytes.size());
    }
    void add(uint32_t value) {
        const auto byte = [&](uint32_t i) { return static_cast<std::byte>(value >> 8 * i & 255); };
        const std::byte bytes[4] = {byte(0), byte(1), byte(2), byte(3)};
        add_bytes(bytes);
    }
    template <class T>
    void add(std::span<const T> list) {
        static_assert(sizeof(T) == 4);
        add(static_cast<uint32_t>(list.size()));
        add(static_cast<uint32_t>(uint64_t{list.size()} >> 32));
        if constexpr (std::endian::native == std::endian::little)
            add_bytes(std::as_bytes(list));
        else
            for (const T& value : list) add(std::bit_cast<uint32_t>(value));
    }
    ContentHash finish() const {
        const XXH128_hash_t hash = XXH3_128bits_digest(&state_);
        return {hash.high64, hash.low64};
    }

  private:
    XXH3_state_t state_;
};

}  // namespace limn
