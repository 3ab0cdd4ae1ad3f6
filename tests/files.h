// Files in tests: a directory to put them in, and what they hold.
#pragma once

#include <unistd.h>

#include <atomic>
#include <bit>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <system_error>

namespace limn {

/// A directory of its own, gone with the object.
struct TemporaryDirectory {
    std::filesystem::path path;
    TemporaryDirectory() {
        static std::atomic<int> count = 0;
        path = std::filesystem::temp_directory_path() /
               ("limn_test." + std::to_string(getpid()) + "." + std::to_string(count++));
        std::filesystem::create_directories(path);
    }
    ~TemporaryDirectory() {
        std::error_code ignored;
        std::filesystem::remove_all(path, ignored);
    }
    std::string file(const std::string& name) const { return (path / name).string(); }
    size_t entry_count() const {
        return static_cast<size_t>(
            std::distance(std::filesystem::directory_iterator(path), std::filesystem::directory_iterator()));
    }
};

inline std::string contents(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

inline void put_contents(const std::string& path, const std::string& text) {
    std::ofstream(path, std::ios::binary) << text;
}

/// Reads little-endian values off the front of a string.
struct ByteReader {
    std::string bytes;
    size_t at = 0;
    uint32_t byte() { return static_cast<uint8_t>(bytes.at(at++)); }
    uint32_t u32() {
        const uint32_t b[4] = {byte(), byte(), byte(), byte()};
        return b[0] | b[1] << 8 | b[2] << 16 | b[3] << 24;
    }
    float f32() { return std::bit_cast<float>(u32()); }
};

}  // namespace limn
