#include "cli/plot.h"

#include <algorithm>
#include <cmath>

#include "limn/file.h"
#ifdef LIMN_HAVE_PICTURES
#include "viewer/picture.h"
#endif

namespace limn::cli {
namespace {

bool ends_with(const std::string& text, const char* end) {
    return std::string_view(text).ends_with(end);
}

std::string format(const char* pattern, double a, double b = 0, double c = 0) {
    char text[160];
    std::snprintf(text, sizeof text, pattern, a, b, c);
    return text;
}

std::string paint(const char* property, uint32_t color) {
    char text[64];
    if (color == kNoColor)
        std::snprintf(text, sizeof text, " %s=\"none\"", property);
    else
        std::snprintf(text, sizeof text, " %s=\"#%06x\"", property, color);
    return text;
}

std::string svg_of(const Plot& plot) {
    std::string out =
        format("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" height=\"%.0f\">\n", plot.width, plot.height) +
        "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
    for (const Plot::Shape& shape : plot.shapes) {
        if (shape.radius > 0) {
            out += format("<circle cx=\"%.3f\" cy=\"%.3f\" r=\"%.3f\"", shape.xy[0], shape.xy[1], shape.radius);
        } else {
            out += "<polygon points=\"";
            for (size_t i = 0; i < shape.xy.size(); i += 2) out += format("%.3f,%.3f ", shape.xy[i], shape.xy[i + 1]);
            out += "\" stroke-linejoin=\"round\"";
        }
        out += paint("fill", shape.fill) + paint("stroke", shape.stroke) +
               format(" stroke-width=\"%.2f\"/>\n", shape.stroke_width);
    }
    for (const Plot::Label& label : plot.labels)
        out += format("<text x=\"%.1f\" y=\"%.1f\" font-family=\"sans-serif\" font-size=\"13\">", label.x, label.y) +
               label.text + "</text>\n";
    return out + "</svg>\n";
}

#ifdef LIMN_HAVE_PICTURES
double distance_to_segment(double x, double y, const double* a, const double* b) {
    const double dx = b[0] - a[0], dy = b[1] - a[1], square = dx * dx + dy * dy;
    const double t = square > 0 ? std::clamp(((x - a[0]) * dx + (y - a[1]) * dy) / square, 0.0, 1.0) : 0;
    return std::hypot(x - a[0] - t * dx, y - a[1] - t * dy);
}

/// Distance to the outline, negative inside.
double signed_distance(const Plot::Shape& shape, double x, double y) {
    if (shape.radius > 0) return std::hypot(x - shape.xy[0], y - shape.xy[1]) - shape.radius;
    const size_t count = shape.xy.size() / 2;
    double distance = 1e300;
    bool inside = false;
    for (size_t i = 0; i < count; ++i) {
        const double *a = &shape.xy[2 * i], *b = &shape.xy[2 * ((i + 1) % count)];
        distance = std::min(distance, distance_to_segment(x, y, a, b));
        if ((a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])) inside = !inside;
    }
    return inside ? -distance : distance;
}

void blend(uint8_t* pixel, uint32_t color, double share) {
    if (color == kNoColor || share <= 0) return;
    for (int k = 0; k < 3; ++k) {
        const double to = color >> (16 - 8 * k) & 255u;
        pixel[k] = static_cast<uint8_t>(std::lround(pixel[k] + std::min(share, 1.0) * (to - pixel[k])));
    }
}

void draw(viewer::Picture& picture, const Plot::Shape& shape) {
    const double margin = shape.radius + shape.stroke_width + 1;
    double low[2] = {1e300, 1e300}, high[2] = {-1e300, -1e300};
    for (size_t i = 0; i < shape.xy.size(); ++i) {
        low[i % 2] = std::min(low[i % 2], shape.xy[i] - margin);
        high[i % 2] = std::max(high[i % 2], shape.xy[i] + margin);
    }
    const auto clamp = [](double v, uint32_t size) { return static_cast<uint32_t>(std::clamp(v, 0.0, size + 0.0)); };
    for (uint32_t y = clamp(low[1], picture.height); y < clamp(high[1], picture.height); ++y)
        for (uint32_t x = clamp(low[0], picture.width); x < clamp(high[0], picture.width); ++x) {
            uint8_t* pixel = picture.rgb.data() + 3 * (size_t{y} * picture.width + x);
            const double distance = signed_distance(shape, x + 0.5, y + 0.5);
            blend(pixel, shape.fill, 0.5 - distance);
            blend(pixel, shape.stroke, 0.5 + shape.stroke_width / 2 - std::abs(distance));
        }
}
#endif

}  // namespace

std::string check_plot_path(const std::string& path) {
    if (ends_with(path, ".svg")) return {};
#ifdef LIMN_HAVE_PICTURES
    if (ends_with(path, ".png")) return {};
    return "plots are .svg or .png files";
#else
    return "plots are .svg files: this program was built without libpng";
#endif
}

Result<void> write_plot(const std::string& path, const Plot& plot) {
    auto file = FileWriter::create(path);
    if (!file) return file.error();
#ifdef LIMN_HAVE_PICTURES
    if (ends_with(path, ".png")) {
        viewer::Picture picture{plot.width, plot.height,
                                std::vector<uint8_t>(size_t{3} * plot.width * plot.height, 255)};
        for (const Plot::Shape& shape : plot.shapes) draw(picture, shape);
        return viewer::write_png(std::move(*file), picture);
    }
#endif
    const std::string text = svg_of(plot);
    for (size_t at = 0; at < text.size(); at += FileWriter::kBufferBytes)
        file->append(std::string_view(text).substr(at, FileWriter::kBufferBytes));
    return file->commit();
}

}  // namespace limn::cli
