// Grids refined along their two directions by matrices of curves.
#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "schemes/scheme_meshes.h"
#include "shapes/random_mesh.h"

namespace limn::test {

using Matrix = std::vector<std::vector<double>>;  // rows

/// Points of a grid, columns by rows, refined along both directions.
inline std::vector<double> refine_grid(const std::vector<double>& points, size_t columns, const Matrix& u,
                                       const Matrix& v) {
    std::vector<double> out;
    for (const auto& row_v : v)
        for (const auto& row_u : u)
            for (size_t k = 0; k < 3; ++k) {
                double sum = 0;
                for (size_t j = 0; j < row_v.size(); ++j)
                    for (size_t i = 0; i < row_u.size(); ++i)
                        sum += row_v[j] * row_u[i] * points[3 * (j * columns + i) + k];
                out.push_back(sum);
            }
    return out;
}

/// The distance of the point from the nearest of `points`.
inline double distance_to(const double* point, const std::vector<double>& points) {
    double least = HUGE_VAL;
    for (size_t v = 0; v < points.size(); v += 3)
        least = std::min(least, std::hypot(point[0] - points[v], point[1] - points[v + 1], point[2] - points[v + 2]));
    return least;
}

inline void expect_same_points(const RefinedMesh& mesh, const std::vector<double>& points) {
    ASSERT_EQ(mesh.points.size(), points.size());
    for (size_t v = 0; v < points.size(); v += 3) {
        EXPECT_LT(distance_to(mesh.points.data() + v, points), 1e-12);
        EXPECT_LT(distance_to(points.data() + v, mesh.points), 1e-12);
    }
}

/// A grid of random points, columns by rows.
inline RefinedMesh make_random_grid(uint32_t columns, uint32_t rows, uint64_t seed) {
    RandomNumbers random(seed);
    RefinedMesh mesh;
    for (uint32_t i = 0; i < 3 * columns * rows; ++i) mesh.points.push_back(random.uniform(-1, 1));
    for (uint32_t j = 0; j + 1 < rows; ++j)
        for (uint32_t i = 0; i + 1 < columns; ++i) {
            const uint32_t a = j * columns + i, d = a + columns;
            mesh.face_sizes.push_back(4);
            mesh.face_vertices.insert(mesh.face_vertices.end(), {a, a + 1, d + 1, d});
        }
    return mesh;
}

}  // namespace limn::test
