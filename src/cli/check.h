// What the parts of `limn check` share.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "cli/opensubdiv_reference.h"
#include "cli/point_runner.h"
#include "cli/surface_runner.h"

namespace limn::cli {

struct CheckOptions {
    std::vector<std::string> models;
    uint32_t level = 3;
    SurfaceOptions surface;
    DeviceOption device;
};

/// One line of the table: a worst error against its tolerance.
struct Row {
    std::string what;
    double error, tolerance;
    const char* unit;
    std::string remark = {};
    bool ok() const { return error <= tolerance; }  // false for NaN
};

/// Differences are told relative to the largest side of the bounding box; positions may also be off by 4 ulp
/// of the largest coordinate, which matters for small models far from the origin.
struct Extent {
    double size = 0, ulp = 0;
    double point_tolerance() const { return 2e-6 + 4 * ulp / size; }
};
Extent extent_of(std::span<const float> points, size_t width);

struct Vector {
    double x[3];
    double length() const { return std::sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]); }
};
inline Vector cross(const Vector& a, const Vector& b) {
    return {{a.x[1] * b.x[2] - a.x[2] * b.x[1], a.x[2] * b.x[0] - a.x[0] * b.x[2],
             a.x[0] * b.x[1] - a.x[1] * b.x[0]}};
}
template <class Values>
Vector vector_at(const Values& values, size_t i) {
    return {{static_cast<double>(values[3 * i]), static_cast<double>(values[3 * i + 1]),
             static_cast<double>(values[3 * i + 2])}};
}

struct Runners {
    const RunDevice& device;
    const PointRunner& points;
    const SurfaceRunner& surfaces;
};

struct Check {
    const CheckOptions& options;
    const Runners& runners;
    const LoadedModel& loaded;
    const OpenSubdivReference& reference;  ///< refined to options.level
    std::vector<Row> rows;
    std::vector<std::string> notes;  ///< what no row tells: lines below the table

    std::span<const float> points() const { return loaded.model.positions; }
};

/// Rows about the limit surface: regular and irregular places against OpenSubdiv's patches and Bfr, and
/// against the limits of refined vertices.
Result<void> check_surface(Check& check);

}  // namespace limn::cli
