// A surface whose curvature everybody knows.
#pragma once

#include <cmath>

#include "limn/schemes/b_spline_surface.h"

namespace limn::test {

/// A sphere of radius 1: half a circle turned around, both rational and quadratic.
inline BSplineSurface make_sphere() {
    const double h = std::sqrt(0.5);
    const double circle[9][3] = {{1, 0, 1},   {1, 1, h},  {0, 1, 1},  {-1, 1, h}, {-1, 0, 1},
                                 {-1, -1, h}, {0, -1, 1}, {1, -1, h}, {1, 0, 1}};
    const double half[5][3] = {{0, -1, 1}, {1, -1, h}, {1, 0, 1}, {1, 1, h}, {0, 1, 1}};
    BSplineSurface s{{2, {0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4}}, {2, {0, 0, 0, 1, 1, 2, 2, 2}}, 4, {}};
    for (const auto& [radius, z, w] : half)
        for (const auto& [x, y, weight] : circle) {
            const double product = w * weight;
            for (const double value : {radius * x * product, radius * y * product, z * product, product})
                s.points.push_back(value);
        }
    return s;
}

}  // namespace limn::test
