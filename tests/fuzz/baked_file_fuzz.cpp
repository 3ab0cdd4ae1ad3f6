// Baked files whose header is right and whose contents are anything: what loads is used for all that it is good for.
#include <tbb/global_control.h>

#include <cstring>

#include "limn/baked_file.h"
#include "limn/baked_format.h"
#include "shapes/follow_baked.h"

extern "C" size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t max_size);

/// Words take other values, among them such as are near those that are there: what makes files longer or shorter
/// hardly ever gets past the directory.
extern "C" size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t max_size, unsigned int seed) {
    if (size < 128 || seed % 8 == 0) return LLVMFuzzerMutate(data, size, max_size);
    uint64_t random = seed;
    const auto next = [&](uint64_t bound) {
        random = random * 6364136223846793005u + 1442695040888963407u;
        return (random >> 33) % bound;
    };
    for (uint64_t changes = 1 + next(3); changes-- > 0;) {
        // Half of all changes are to the directory.
        const size_t words = next(2) == 0 ? std::min<size_t>(size / 4, 512) : size / 4;
        uint8_t* at = data + 4 * next(words);
        uint32_t word = 0, other = 0;
        std::memcpy(&word, at, 4);
        std::memcpy(&other, data + 4 * next(size / 4), 4);
        const uint32_t special[] = {0, 1, 0x7fffffff, 0x80000000, 0xffffffff, 0xfffffffe, 0x7f800000, 0xffff};
        switch (next(6)) {
            case 0: word += static_cast<uint32_t>(next(9)) - 4; break;
            case 1: word ^= 1u << next(32); break;
            case 2: word = special[next(std::size(special))]; break;
            case 3: word = other; break;
            case 4: word = static_cast<uint32_t>(next(64)); break;
            default: word = static_cast<uint32_t>(next(uint64_t{1} << 31)) * 2; break;
        }
        std::memcpy(at, &word, 4);
    }
    return size;
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    static const tbb::global_control alone(tbb::global_control::max_allowed_parallelism, 1);
    if (size < sizeof(limn::BakedHeader)) return 0;
    limn::Array<std::byte> bytes;
    bytes.allocate(size);
    std::memcpy(bytes.data(), data, size);
    limn::BakedHeader header = {};
    std::memcpy(&header, data, sizeof header);
    std::memcpy(header.magic, limn::kBakedMagic, sizeof header.magic);
    header.byte_order = limn::kBakedByteOrder;
    header.version = limn::kBakedVersion;
    header.file_bytes = size;
    std::memcpy(bytes.data(), &header, sizeof header);
    const auto mesh = limn::load_baked_bytes({bytes.data(), size}, {.check_sums = false});
    if (!mesh) return 0;
    // Without positions nothing in the file has to match this count.
    if (mesh->patches.control_count > 1u << 16) return 0;
    for (const limn::BakedChannel& channel : mesh->channels)
        if (channel.patches.control_count > 1u << 16) return 0;
    limn::test::follow_baked(*mesh);
    return 0;
}
