#include <cmath>
#include <numbers>

#include "shapes/shapes.h"

namespace limn::test {
namespace {

constexpr double kPi = std::numbers::pi;

// Height of the disks below: curved, so that normals differ from point to point.
double dome(double x, double y) {
    return 0.3 - 0.15 * (x * x + 0.7 * y * y) + 0.05 * x * y;
}

}  // namespace

TestMesh make_cube() {
    TestMesh mesh;
    for (uint32_t i = 0; i < 8; ++i) mesh.add_vertex((i & 1) ? 1 : -1, (i & 2) ? 1 : -1, (i & 4) ? 1 : -1);
    mesh.add_face({0, 2, 3, 1});
    mesh.add_face({4, 5, 7, 6});
    mesh.add_face({0, 1, 5, 4});
    mesh.add_face({2, 6, 7, 3});
    mesh.add_face({0, 4, 6, 2});
    mesh.add_face({1, 3, 7, 5});
    mesh.perturb(0.13);
    return mesh;
}

TestMesh make_tetrahedron() {
    TestMesh mesh;
    mesh.add_vertex(1, 1, 1);
    mesh.add_vertex(-1, -1, 1);
    mesh.add_vertex(-1, 1, -1);
    mesh.add_vertex(1, -1, -1);
    mesh.add_face({0, 2, 1});
    mesh.add_face({0, 1, 3});
    mesh.add_face({0, 3, 2});
    mesh.add_face({1, 2, 3});
    mesh.perturb(0.1);
    return mesh;
}

TestMesh make_octahedron() {
    TestMesh mesh;
    for (int axis = 0; axis < 3; ++axis) {
        for (double side : {1.0, -1.0}) {
            mesh.add_vertex(axis == 0 ? side : 0, axis == 1 ? side : 0, axis == 2 ? side : 0);
        }
    }
    const uint32_t belt[4] = {0, 2, 1, 3};
    for (uint32_t i = 0; i < 4; ++i) {
        mesh.add_face({4, belt[i], belt[(i + 1) % 4]});
        mesh.add_face({5, belt[(i + 1) % 4], belt[i]});
    }
    mesh.perturb(0.1);
    return mesh;
}

TestMesh make_icosahedron() {
    TestMesh mesh;
    mesh.add_vertex(0, 0, 1);
    for (uint32_t i = 0; i < 10; ++i) {
        const double angle = kPi * i / 5, z = i % 2 == 0 ? 0.4472 : -0.4472;
        mesh.add_vertex(0.8944 * std::cos(angle), 0.8944 * std::sin(angle), z);
    }
    mesh.add_vertex(0, 0, -1);
    for (uint32_t i = 0; i < 10; i += 2) {
        const uint32_t a = 1 + i, b = 1 + (i + 1) % 10, c = 1 + (i + 2) % 10, d = 1 + (i + 3) % 10;
        mesh.add_face({0, a, c});
        mesh.add_face({a, b, c});
        mesh.add_face({c, b, d});
        mesh.add_face({11, d, b});
    }
    mesh.perturb(0.07);
    return mesh;
}

TestMesh make_grid(uint32_t columns, uint32_t rows) {
    TestMesh mesh;
    for (uint32_t y = 0; y <= rows; ++y) {
        for (uint32_t x = 0; x <= columns; ++x) {
            mesh.add_vertex(x, y, 2 * dome(x - 0.4 * columns, y - 0.6 * rows));
        }
    }
    const uint32_t stride = columns + 1;
    for (uint32_t y = 0; y < rows; ++y) {
        for (uint32_t x = 0; x < columns; ++x) {
            const uint32_t v = y * stride + x;
            mesh.add_face({v, v + 1, v + stride + 1, v + stride});
        }
    }
    mesh.perturb(0.12);
    return mesh;
}

TestMesh make_triangle_grid(uint32_t columns, uint32_t rows) {
    TestMesh mesh = make_grid(columns, rows);
    mesh.triangulate();
    return mesh;
}

TestMesh make_torus(uint32_t around, uint32_t across) {
    TestMesh mesh;
    for (uint32_t i = 0; i < around; ++i) {
        for (uint32_t j = 0; j < across; ++j) {
            const double u = 2 * kPi * i / around, v = 2 * kPi * j / across;
            const double radius = 2 + 0.8 * std::cos(v);
            mesh.add_vertex(radius * std::cos(u), radius * std::sin(u), 0.8 * std::sin(v));
        }
    }
    for (uint32_t i = 0; i < around; ++i) {
        for (uint32_t j = 0; j < across; ++j) {
            const uint32_t i1 = (i + 1) % around, j1 = (j + 1) % across;
            mesh.add_face({i * across + j, i1 * across + j, i1 * across + j1, i * across + j1});
        }
    }
    mesh.perturb(0.1);
    return mesh;
}

TestMesh make_triangle_torus(uint32_t around, uint32_t across) {
    TestMesh mesh = make_torus(around, across);
    mesh.triangulate();
    return mesh;
}

namespace {

// Sectors around vertex 0. Closed stars share ray `sectors` with ray 0; open ones span half a turn.
TestMesh make_star(uint32_t sectors, uint32_t rings, bool closed, bool triangles) {
    TestMesh mesh;
    mesh.add_vertex(0, 0, dome(0, 0));
    const uint32_t rays = closed ? sectors : sectors + 1;
    const double turn = (closed ? 2 * kPi : kPi) / sectors;
    auto place = [&](uint32_t sector, double i, double j) {
        // In polar coordinates: sectors of half a turn must not fold onto their rays.
        const double angle = turn * (sector + std::atan2(j, i) / (kPi / 2));
        const double radius = triangles ? 0.9 * (i + j) : std::hypot(i, j);
        const double x = radius * std::cos(angle), y = radius * std::sin(angle);
        return mesh.add_vertex(x, y, dome(x, y));
    };
    // rows[s][i][j]: j == 0 lies on ray s; triangles have j < i only in ring i, quads a full square.
    auto on_ray = [&](uint32_t s, uint32_t i) { return i == 0 ? 0 : 1 + (s % rays) * rings + (i - 1); };
    for (uint32_t s = 0; s < rays; ++s) {
        for (uint32_t i = 1; i <= rings; ++i) place(s, i, 0);
    }
    for (uint32_t s = 0; s < sectors; ++s) {
        std::vector<std::vector<uint32_t>> inner(rings + 1, std::vector<uint32_t>(rings + 1, ~0u));
        for (uint32_t i = 0; i <= rings; ++i) {
            inner[i][0] = on_ray(s, i);
            inner[0][i] = on_ray(s + 1, i);
        }
        for (uint32_t i = 1; i <= rings; ++i) {
            for (uint32_t j = 1; j <= rings; ++j) {
                if (!triangles || i + j <= rings) inner[i][j] = place(s, i, j);
            }
        }
        for (uint32_t i = 0; i < rings; ++i) {
            for (uint32_t j = 0; j < rings; ++j) {
                if (!triangles) {
                    mesh.add_face({inner[i][j], inner[i + 1][j], inner[i + 1][j + 1], inner[i][j + 1]});
                    continue;
                }
                if (i + j + 1 <= rings) mesh.add_face({inner[i][j], inner[i + 1][j], inner[i][j + 1]});
                if (i + j + 2 <= rings)
                    mesh.add_face({inner[i + 1][j], inner[i + 1][j + 1], inner[i][j + 1]});
            }
        }
    }
    mesh.perturb(0.08, sectors);
    return mesh;
}

}  // namespace

TestMesh make_quad_star(uint32_t valence, uint32_t rings) {
    return make_star(valence, rings, true, false);
}
TestMesh make_triangle_star(uint32_t valence, uint32_t rings) {
    return make_star(valence, rings, true, true);
}
TestMesh make_quad_half_star(uint32_t faces, uint32_t rings) {
    return make_star(faces, rings, false, false);
}
TestMesh make_triangle_half_star(uint32_t faces, uint32_t rings) {
    return make_star(faces, rings, false, true);
}

TestMesh make_globe(uint32_t valence, uint32_t bands) {
    TestMesh mesh;
    mesh.add_vertex(0, 0, 1.1);
    mesh.add_vertex(0, 0, -0.9);
    for (uint32_t b = 0; b <= bands; ++b) {
        for (uint32_t i = 0; i < valence; ++i) {
            const double u = 2 * kPi * i / valence, v = kPi * (b + 1) / (bands + 2);
            mesh.add_vertex(std::sin(v) * std::cos(u), std::sin(v) * std::sin(u), std::cos(v));
        }
    }
    auto at = [&](uint32_t b, uint32_t i) { return 2 + b * valence + i % valence; };
    for (uint32_t i = 0; i < valence; ++i) {
        mesh.add_face({0, at(0, i), at(0, i + 1)});
        for (uint32_t b = 0; b < bands; ++b) {
            mesh.add_face({at(b, i), at(b + 1, i), at(b + 1, i + 1), at(b, i + 1)});
        }
        mesh.add_face({1, at(bands, i + 1), at(bands, i)});
    }
    mesh.perturb(0.3 / valence);
    return mesh;
}

TestMesh make_triangle_globe(uint32_t valence, uint32_t bands) {
    TestMesh mesh = make_globe(valence, bands);
    mesh.triangulate();
    return mesh;
}

TestMesh make_prism(uint32_t sides) {
    TestMesh mesh;
    std::vector<uint32_t> top, bottom;
    for (uint32_t i = 0; i < sides; ++i) {
        const double angle = 2 * kPi * i / sides;
        top.push_back(mesh.add_vertex(std::cos(angle), std::sin(angle), 0.7));
        bottom.push_back(mesh.add_vertex(1.2 * std::cos(angle), 1.2 * std::sin(angle), -0.7));
    }
    for (uint32_t i = 0; i < sides; ++i) {
        const uint32_t j = (i + 1) % sides;
        mesh.add_face({bottom[i], bottom[j], top[j], top[i]});
    }
    mesh.add_face(top);
    mesh.add_face(std::vector<uint32_t>(bottom.rbegin(), bottom.rend()));
    mesh.perturb(0.1);
    return mesh;
}

TestMesh make_pyramid(uint32_t sides) {
    TestMesh mesh;
    mesh.add_vertex(0.1, -0.05, 1.3);
    std::vector<uint32_t> base;
    for (uint32_t i = 0; i < sides; ++i) {
        const double angle = 2 * kPi * i / sides;
        base.push_back(mesh.add_vertex(std::cos(angle), std::sin(angle), 0));
    }
    for (uint32_t i = 0; i < sides; ++i) mesh.add_face({0, base[i], base[(i + 1) % sides]});
    mesh.add_face(std::vector<uint32_t>(base.rbegin(), base.rend()));
    mesh.perturb(0.1);
    return mesh;
}

TestMesh make_book(uint32_t pages, bool triangles) {
    TestMesh mesh;
    mesh.add_vertex(0, 0, 0);
    mesh.add_vertex(0, 0, 1);
    for (uint32_t p = 0; p < pages; ++p) {
        const double angle = 2 * kPi * p / pages, x = std::cos(angle), y = std::sin(angle);
        const uint32_t a = mesh.add_vertex(x, y, 0.1);
        if (triangles) {
            mesh.add_face(p % 2 == 0 ? std::vector<uint32_t>{0, a, 1} : std::vector<uint32_t>{0, 1, a});
            continue;
        }
        const uint32_t b = mesh.add_vertex(1.1 * x, 1.1 * y, 1.2);
        mesh.add_face(p % 2 == 0 ? std::vector<uint32_t>{0, a, b, 1} : std::vector<uint32_t>{0, 1, b, a});
    }
    mesh.perturb(0.03);
    return mesh;
}

}  // namespace limn::test
