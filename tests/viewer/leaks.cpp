#include "viewer/leaks.h"

namespace limn::viewer::test {
namespace {

/// Magenta, in at least one of a pixel's samples.
bool shows_back(const uint8_t* rgb) {
    return rgb[0] > rgb[1] + 24 && rgb[2] > rgb[1] + 24;
}

bool is_background(const uint8_t* rgb) {
    return rgb[0] == 0 && rgb[1] == 0 && rgb[2] == 0;
}

bool beside_background(const Picture& picture, uint32_t x, uint32_t y) {
    for (uint32_t j = y == 0 ? 0 : y - 1; j <= y + 1 && j < picture.height; ++j)
        for (uint32_t i = x == 0 ? 0 : x - 1; i <= x + 1 && i < picture.width; ++i)
            if (is_background(picture.at(i, j))) return true;
    return false;
}

}  // namespace

size_t count_leaks(const Picture& picture) {
    size_t count = 0;
    for (uint32_t y = 0; y < picture.height; ++y)
        for (uint32_t x = 0; x < picture.width; ++x)
            count += shows_back(picture.at(x, y)) && !beside_background(picture, x, y);
    return count;
}

size_t count_covered(const Picture& picture) {
    size_t count = 0;
    for (uint32_t y = 0; y < picture.height; ++y)
        for (uint32_t x = 0; x < picture.width; ++x) count += !is_background(picture.at(x, y));
    return count;
}

}  // namespace limn::viewer::test
