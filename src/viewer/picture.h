// Pictures on the host, and PNG files.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "limn/file.h"

namespace limn::viewer {

/// Eight bits a channel, sRGB, no alpha: pixel (x, y) is the three bytes at 3 * (y * width + x), row 0 on
/// top.
struct Picture {
    uint32_t width = 0, height = 0;
    std::vector<uint8_t> rgb;

    const uint8_t* at(uint32_t x, uint32_t y) const { return rgb.data() + 3 * (size_t{y} * width + x); }
};

/// Into a file that has been opened before there was anything to write, and is committed here. Errors:
/// cannot_open, invalid_argument (an empty picture); the file is then as it was.
Result<void> write_png(FileWriter file, const Picture& picture);

}  // namespace limn::viewer
