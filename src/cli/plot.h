// Plane figures: polygons, discs and labels, into SVG or PNG files.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "limn/result.h"

namespace limn::cli {

/// 0xrrggbb, or none.
inline constexpr uint32_t kNoColor = ~uint32_t{0};

/// Lengths are pixels; (0,0) is the upper left corner. What comes later covers what came before.
struct Plot {
    struct Shape {
        std::vector<double> xy;  ///< of a closed polygon; a disc's centre
        double radius = 0;       ///< of a disc, else 0
        uint32_t fill = kNoColor, stroke = kNoColor;
        double stroke_width = 1;
    };
    struct Label {
        double x, y;  ///< where its baseline begins
        std::string text;
    };
    uint32_t width = 0, height = 0;
    std::vector<Shape> shapes;
    std::vector<Label> labels;  ///< in SVG files only
};

/// Whether write_plot knows what to do with this path: .svg, or .png where the program was built with libpng. Empty, or
/// what is wrong.
std::string check_plot_path(const std::string& path);

/// Errors: cannot_open.
Result<void> write_plot(const std::string& path, const Plot& plot);

}  // namespace limn::cli
