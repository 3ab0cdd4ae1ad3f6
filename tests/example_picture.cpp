// example_picture A.png B.png: fails unless both are the same picture, of a surface that covers a part of it
// and has no hole: the background is one colour, and all of it is reached from the border.
#include <png.h>

#include <cstdint>
#include <cstdio>
#include <vector>

namespace {

struct Pixels {
    uint32_t width = 0, height = 0;
    std::vector<uint32_t> colors;  ///< four bytes each; empty where the file is no picture
};

Pixels read_png(const char* path) {
    png_image image = {};
    image.version = PNG_IMAGE_VERSION;
    Pixels pixels;
    if (png_image_begin_read_from_file(&image, path) == 0) return pixels;
    image.format = PNG_FORMAT_RGBA;
    pixels.width = image.width;
    pixels.height = image.height;
    pixels.colors.resize(size_t{image.width} * image.height);
    if (png_image_finish_read(&image, nullptr, pixels.colors.data(), 0, nullptr) == 0) pixels.colors.clear();
    return pixels;
}

/// Pixels of the colour of the first one that a path of such pixels joins to it.
size_t count_reached(const Pixels& pixels) {
    std::vector<bool> seen(pixels.colors.size());
    std::vector<size_t> open = {0};
    size_t reached = 0;
    seen[0] = true;
    while (!open.empty()) {
        const size_t at = open.back(), x = at % pixels.width;
        open.pop_back();
        ++reached;
        const auto visit = [&](bool inside, size_t next) {
            if (!inside || seen[next] || pixels.colors[next] != pixels.colors[0]) return;
            seen[next] = true;
            open.push_back(next);
        };
        visit(x > 0, at - 1);
        visit(x + 1 < pixels.width, at + 1);
        visit(at >= pixels.width, at - pixels.width);
        visit(at + pixels.width < seen.size(), at + pixels.width);
    }
    return reached;
}

}  // namespace

int main(int count, char** arguments) {
    if (count != 3) return std::puts("usage: example_picture A.png B.png"), 2;
    const Pixels a = read_png(arguments[1]), b = read_png(arguments[2]);
    if (a.colors.empty() || a.width != b.width || a.colors != b.colors)
        return std::puts("the pictures differ"), 1;
    size_t background = 0;
    for (const uint32_t color : a.colors) background += color == a.colors[0];
    const size_t reached = count_reached(a);
    const double covered = 1 - static_cast<double>(background) / static_cast<double>(a.colors.size());
    std::printf("%.1f %% covered, %zu pixels of background within the surface\n", 100 * covered,
                background - reached);
    return covered > 0.2 && covered < 0.6 && reached == background ? 0 : 1;
}
