// Curvature against closed forms (quadrics, a sphere, a torus) and against Gauss and Bonnet's theorem.
#include "limn/curvature.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "limn/evaluate.h"
#include "limn/patch_table.h"
#include "limn/schemes/spline_mesh.h"
#include "schemes/rational_sphere.h"
#include "shapes/random_mesh.h"
#include "shapes/shapes.h"

namespace limn::test {
namespace {

using Vector = Eigen::Vector3d;

/// A limit surface in double.
struct LimitSurface {
    PatchTableDouble table;
    std::vector<double> points;
    uint32_t width;

    LimitSurface(const ControlMeshDescription& description, std::span<const double> control,
                 uint32_t components)
        : width(components) {
        const auto mesh = ControlMesh::create(description);
        EXPECT_TRUE(mesh);
        auto built = build_patch_table<double>(*mesh, {});
        EXPECT_TRUE(built);
        table = std::move(*built);
        points.resize(size_t{table.point_count()} * width);
        build_patch_points(table, control, width, points);
    }
    std::vector<double> evaluate(const std::vector<PatchSample>& samples) const {
        std::vector<double> values(samples.size() * 6 * width);
        std::vector<SampleStatus> statuses(samples.size());
        evaluate_patches(table, samples, points, width, Derivatives::second, values, statuses);
        for (const SampleStatus status : statuses) EXPECT_EQ(status, SampleStatus::valid);
        return values;
    }
    std::vector<Curvature> curvatures(const std::vector<PatchSample>& samples) const {
        std::vector<Curvature> out(samples.size());
        evaluate_curvature(evaluate(samples), width, out);
        return out;
    }
};

/// Somewhere on each of some faces.
std::vector<PatchSample> random_samples(std::span<const uint32_t> faces, bool triangles, uint64_t seed) {
    RandomNumbers random(seed);
    std::vector<PatchSample> samples;
    for (const uint32_t face : faces)
        for (int i = 0; i < 20; ++i) {
            const double u = random.uniform(0, 1), v = random.uniform(0, triangles ? 1 - u : 1);
            samples.push_back({face, u, v});
        }
    return samples;
}

/// z = q(i, j) over x and y linear in i and j, and all of it turned: the graph of a quadratic function, which
/// subdivision gives when control points are the function less what the scheme adds to it.
struct Quadric {
    Eigen::Matrix2d hessian;  ///< by x and y
    Eigen::Vector2d slope;    ///< at the origin
    Eigen::Matrix3d turn;

    explicit Quadric(uint64_t seed) {
        RandomNumbers random(seed);
        const auto number = [&] { return random.uniform(-1, 1); };
        const double xy = number();
        hessian << number(), xy, xy, number();
        slope << number(), number();
        turn = (Eigen::AngleAxisd(2 * number(), Vector(number(), number(), number()).normalized()))
                   .toRotationMatrix();
    }
    double height(const Eigen::Vector2d& p) const { return slope.dot(p) + 0.5 * p.dot(hessian * p); }

    void check(const Vector& turned, const Curvature& c) const {
        const Vector p = turn.transpose() * turned;
        const Eigen::Vector2d gradient = slope + hessian * p.head<2>();
        const double area = 1 + gradient.squaredNorm();
        EXPECT_NEAR(p.z(), height(p.head<2>()), 1e-12);
        const double gaussian = hessian.determinant() / (area * area);
        const double mean = -((1 + gradient.y() * gradient.y()) * hessian(0, 0) -
                              2 * gradient.x() * gradient.y() * hessian(0, 1) +
                              (1 + gradient.x() * gradient.x()) * hessian(1, 1)) /
                            (2 * std::pow(area, 1.5));
        EXPECT_NEAR(c.gaussian, gaussian, 1e-10);
        EXPECT_NEAR(c.mean, mean, 1e-10);
        EXPECT_NEAR(c.first, mean + std::sqrt(std::max(0.0, mean * mean - gaussian)), 1e-8);
        EXPECT_NEAR(c.second, mean - std::sqrt(std::max(0.0, mean * mean - gaussian)), 1e-8);
        // Directions: of length 1, at right angles, tangent; and the second form is diagonal in them.
        const Vector a = turn.transpose() * Vector(c.first_direction),
                     b = turn.transpose() * Vector(c.second_direction);
        const Vector normal(-gradient.x(), -gradient.y(), 1);
        EXPECT_NEAR(a.norm(), 1, 1e-12);
        EXPECT_NEAR(b.norm(), 1, 1e-12);
        EXPECT_NEAR(a.dot(b), 0, 1e-12);
        EXPECT_NEAR((a.cross(b) - normal.normalized()).norm(), 0, 1e-11);
        const auto form = [&](const Vector& s, const Vector& t) {
            return -s.head<2>().dot(hessian * t.head<2>()) / std::sqrt(area);
        };
        EXPECT_NEAR(form(a, a), c.first, 1e-10);
        EXPECT_NEAR(form(b, b), c.second, 1e-10);
        EXPECT_NEAR(form(a, b), 0, 1e-10);
    }
};

TEST(Curvature, of_quadrics_under_catmull_clark) {
    for (uint64_t seed = 1; seed <= 20; ++seed) {
        const Quadric quadric(seed);
        Eigen::Matrix2d map;  // rows of control points are neither at right angles nor alike
        map << 0.9, 0.3, -0.2, 0.6;
        const Eigen::Matrix2d by_parameters = map.transpose() * quadric.hessian * map;
        BSplineSurface surface{make_uniform_knots(3, 6), make_uniform_knots(3, 6), 3, {}};
        for (int j = 0; j < 6; ++j)
            for (int i = 0; i < 6; ++i) {
                const Eigen::Vector2d p = map * Eigen::Vector2d(i - 2, j - 3);
                const Vector at =
                    quadric.turn * Vector(p.x(), p.y(), quadric.height(p) - by_parameters.trace() / 6);
                surface.points.insert(surface.points.end(), at.data(), at.data() + 3);
            }
        const auto mesh = build_spline_mesh(surface);
        ASSERT_TRUE(mesh);
        const LimitSurface limit(mesh->description(), surface.points, 3);
        const auto samples = random_samples(std::vector<uint32_t>{6, 7, 8, 11, 12, 13, 18}, false, seed);
        const auto values = limit.evaluate(samples);
        const auto curvatures = limit.curvatures(samples);
        for (size_t s = 0; s < samples.size(); ++s)
            quadric.check(Vector(values.data() + 18 * s), curvatures[s]);
    }
}

TEST(Curvature, of_quadrics_under_loop) {
    constexpr int kSize = 6;
    for (uint64_t seed = 1; seed <= 20; ++seed) {
        const Quadric quadric(seed);
        Eigen::Matrix2d map;
        map << 1, 0.4, 0.1, 0.8;
        const auto second = [&](double i, double j) {
            const Eigen::Vector2d d = map * Eigen::Vector2d(i, j);
            return d.dot(quadric.hessian * d);
        };
        const double added = (second(1, 0) + second(0, 1) + second(1, -1)) / 12;
        std::vector<double> control;
        std::vector<uint32_t> vertices, inner;
        for (int j = 0; j <= kSize; ++j)
            for (int i = 0; i <= kSize; ++i) {
                const Eigen::Vector2d p = map * Eigen::Vector2d(i - 3, j - 3);
                const Vector at = quadric.turn * Vector(p.x(), p.y(), quadric.height(p) - added);
                control.insert(control.end(), at.data(), at.data() + 3);
            }
        for (uint32_t j = 0; j < kSize; ++j)
            for (uint32_t i = 0; i < kSize; ++i) {
                const uint32_t a = j * (kSize + 1) + i, b = a + 1, c = a + kSize + 1, d = c + 1;
                if (i > 0 && j > 0 && i + 1 < kSize && j + 1 < kSize)
                    for (const uint32_t f : {0u, 1u})
                        inner.push_back(static_cast<uint32_t>(vertices.size() / 3) + f);
                vertices.insert(vertices.end(), {a, b, c, b, d, c});
            }
        const std::vector<uint32_t> sizes(vertices.size() / 3, 3);
        ControlMeshDescription description;
        description.options.scheme = Scheme::loop;
        description.vertex_count = (kSize + 1) * (kSize + 1);
        description.face_sizes = sizes;
        description.face_vertices = vertices;
        const LimitSurface limit(description, control, 3);
        const auto samples = random_samples(inner, true, seed);
        const auto values = limit.evaluate(samples);
        const auto curvatures = limit.curvatures(samples);
        for (size_t s = 0; s < samples.size(); ++s)
            quadric.check(Vector(values.data() + 18 * s), curvatures[s]);
    }
}

TEST(Curvature, of_a_rational_sphere) {
    for (const BSplineSurface& part : split_at_full_knots(make_sphere())) {
        const auto mesh = build_spline_mesh(part);
        ASSERT_TRUE(mesh);
        std::vector<double> control(size_t{mesh->vertices.row_count()} * 4);
        apply_stencil_table<double>(mesh->vertices, part.points, control, 4);
        const LimitSurface limit(mesh->description(), control, 4);
        const auto samples = random_samples(std::vector<uint32_t>{4}, false, 3);
        for (const Curvature& c : limit.curvatures(samples)) {
            EXPECT_NEAR(c.gaussian, 1, 1e-9);
            EXPECT_NEAR(c.mean, 1, 1e-9);
            EXPECT_NEAR(c.first, 1, 1e-6);
            EXPECT_NEAR(c.second, 1, 1e-6);
        }
    }
}

/// The largest error of curvature on a torus of n x n / 2 quads, whose control points lie on it.
double torus_error(uint32_t n) {
    constexpr double kRadius = 2, kTube = 0.7;
    const uint32_t m = n / 2;
    std::vector<double> control;
    std::vector<uint32_t> vertices;
    for (uint32_t j = 0; j < m; ++j)
        for (uint32_t i = 0; i < n; ++i) {
            const double a = 2 * std::numbers::pi * i / n, b = 2 * std::numbers::pi * j / m,
                         r = kRadius + kTube * std::cos(b);
            control.insert(control.end(), {r * std::cos(a), r * std::sin(a), kTube * std::sin(b)});
            const auto at = [&](uint32_t x, uint32_t y) { return x % n + y % m * n; };
            vertices.insert(vertices.end(), {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    const std::vector<uint32_t> sizes(vertices.size() / 4, 4);
    ControlMeshDescription description;
    description.vertex_count = n * m;
    description.face_sizes = sizes;
    description.face_vertices = vertices;
    const LimitSurface limit(description, control, 3);
    std::vector<PatchSample> samples;
    for (uint32_t f = 0; f < sizes.size(); ++f) samples.push_back({f, 0.3, 0.6});
    const auto values = limit.evaluate(samples);
    const auto curvatures = limit.curvatures(samples);
    double worst = 0;
    for (size_t s = 0; s < samples.size(); ++s) {
        const double* p = values.data() + 18 * s;
        const double distance = std::hypot(p[0], p[1]), across = distance - kRadius,
                     tube = std::hypot(across, p[2]);
        const double around = across / tube / distance;  // cos b / (R + r cos b)
        worst = std::max({worst, std::abs(curvatures[s].first - 1 / kTube),
                          std::abs(curvatures[s].second - around),
                          std::abs(curvatures[s].gaussian - around / kTube)});
    }
    return worst;
}

TEST(Curvature, converges_on_a_torus) {
    const double coarse = torus_error(24), middle = torus_error(48), fine = torus_error(96);
    EXPECT_LT(coarse, 0.2);
    EXPECT_NEAR(coarse / middle, 4, 0.5);  // second order
    EXPECT_NEAR(middle / fine, 4, 0.3);
}

/// Abscissas and weights of Gauss and Legendre on [0, 1].
struct Quadrature {
    std::vector<double> at, weights;
    explicit Quadrature(int n) {
        for (int k = 0; k < n; ++k) {
            double x = std::cos(std::numbers::pi * (k + 0.75) / (n + 0.5)), slope = 1;
            for (int step = 0; step < 50; ++step) {  // Newton's method on the Legendre polynomial
                double p0 = 1, p1 = x;
                for (int i = 2; i <= n; ++i) {
                    const double p2 = ((2 * i - 1) * x * p1 - (i - 1) * p0) / i;
                    p0 = p1;
                    p1 = p2;
                }
                slope = n * (x * p1 - p0) / (x * x - 1);
                x -= p1 / slope;
            }
            at.push_back((1 + x) / 2);
            weights.push_back(1 / ((1 - x * x) * slope * slope));
        }
    }
};

/// Places with weights by area in (u, v): finer and finer towards corners, where curvature may grow without
/// bound.
struct WeightedPlaces {
    std::vector<PatchSample> samples;
    std::vector<double> weights;
    Quadrature rule = Quadrature(6);

    void add_square(uint32_t face, double u, double v, double du, double dv) {
        for (size_t j = 0; j < rule.at.size(); ++j)
            for (size_t i = 0; i < rule.at.size(); ++i) {
                samples.push_back({face, u + du * rule.at[i], v + dv * rule.at[j]});
                weights.push_back(rule.weights[i] * rule.weights[j] * std::abs(du * dv));
            }
    }
    /// Corners at (u, v), (u + size, v) and (u, v + size); negative: turned.
    void add_triangle(uint32_t face, double u, double v, double size) {
        for (size_t j = 0; j < rule.at.size(); ++j)
            for (size_t i = 0; i < rule.at.size(); ++i) {
                const double x = rule.at[i], y = (1 - x) * rule.at[j];
                samples.push_back({face, u + size * x, v + size * y});
                weights.push_back(rule.weights[i] * rule.weights[j] * (1 - x) * size * size);
            }
    }
    void add_quad_face(uint32_t face, int depth) {
        for (const auto& [u, v] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}})
            for (int level = 2; level <= depth; ++level) {
                const double du = std::exp2(-level) * (u == 0 ? 1 : -1),
                             dv = std::exp2(-level) * (v == 0 ? 1 : -1);
                for (const auto& [i, j] : {std::pair{1, 0}, {1, 1}, {0, 1}})
                    add_square(face, u + i * du, v + j * dv, du, dv);
            }
    }
    void add_triangle_face(uint32_t face, int depth) {
        add_triangle(face, 0.5, 0.5, -0.5);
        for (const auto& [u, v] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}})
            for (int level = 2; level <= depth; ++level) {
                // The corner's triangle of twice the size, but for the part at the corner.
                const double h = std::exp2(-level), u0 = u == 0 ? 0 : 1 - 2 * h, v0 = v == 0 ? 0 : 1 - 2 * h;
                for (const auto& [i, j] : {std::pair{0, 0}, {1, 0}, {0, 1}})
                    if (i != static_cast<int>(u) || j != static_cast<int>(v))
                        add_triangle(face, u0 + i * h, v0 + j * h, h);
                add_triangle(face, u0 + h, v0 + h, -h);
            }
    }
};

/// The integral of Gaussian curvature over a closed surface, in units of 2 pi: its Euler characteristic.
double total_curvature(TestMesh mesh) {
    constexpr int kDepth = 18;
    const LimitSurface limit(mesh.description(), mesh.positions_double(), 3);
    WeightedPlaces places;
    for (uint32_t f = 0; f < limit.table.ptex_surfaces.size(); ++f)
        mesh.options.scheme == Scheme::loop ? places.add_triangle_face(f, kDepth)
                                            : places.add_quad_face(f, kDepth);
    const auto values = limit.evaluate(places.samples);
    const auto curvatures = limit.curvatures(places.samples);
    double sum = 0;
    for (size_t s = 0; s < curvatures.size(); ++s) {
        const Vector u(values.data() + 18 * s + 3), v(values.data() + 18 * s + 6);
        sum += curvatures[s].gaussian * u.cross(v).norm() * places.weights[s];
    }
    return sum / (2 * std::numbers::pi);
}

TEST(Curvature, adds_up_to_the_euler_characteristic) {
    EXPECT_NEAR(total_curvature(make_cube()), 2, 1e-6);
    EXPECT_NEAR(total_curvature(make_prism(5)), 2, 1e-6);
    TestMesh icosahedron = make_icosahedron();
    icosahedron.options.scheme = Scheme::loop;
    EXPECT_NEAR(total_curvature(icosahedron), 2, 1e-6);
    EXPECT_NEAR(total_curvature(make_messy_torus(5, 3, 1)), 0, 1e-4);
}

TEST(Curvature, of_scaled_and_mirrored_surfaces) {
    RandomNumbers random(4);
    for (int round = 0; round < 50; ++round) {
        const double scale = std::exp2(random.uniform(-8, 8));
        double values[3][18];  // as it is, scaled, mirrored
        for (int k = 0; k < 18; ++k) {
            values[0][k] = random.uniform(-1, 1) + (k == 3 || k == 7 ? 2 : 0);
            values[1][k] = scale * values[0][k];
            values[2][k] = values[0][k] * (k % 3 == 2 ? -1 : 1);
        }
        Curvature c[3];
        evaluate_curvature({&values[0][0], 54}, 3, c);
        const double tolerance = 1e-12 * (std::abs(c[0].first) + std::abs(c[0].second));
        EXPECT_NEAR(c[1].first * scale, c[0].first, tolerance);
        EXPECT_NEAR(c[1].second * scale, c[0].second, tolerance);
        // The normal is on the other side of the mirrored surface.
        EXPECT_NEAR(c[2].first, -c[0].second, tolerance);
        EXPECT_NEAR(c[2].mean, -c[0].mean, tolerance);
    }
}

TEST(Curvature, of_a_plane_and_of_nothing) {
    // A plane, whose derivatives are skew; du and dv alike; no derivatives; a cylinder of radius 2 along y,
    // seen from outside.
    const double values[4][18] = {{0, 0, 0, 1, 2, 0, 3, -1, 0, 5, 1, 0, 2, 2, 0, 1, 0, 0},
                                  {0, 0, 0, 1, 2, 0, 2, 4, 0, 5, 1, 3, 2, 2, 1, 1, 0, 0},
                                  {},
                                  {0, 0, 2, 2, 0, 0, 0, 1, 0, 0, 0, -2, 0, 0, 0, 0, 0, 0}};
    Curvature c[4];
    evaluate_curvature({&values[0][0], 72}, 3, c);
    EXPECT_EQ(c[0].gaussian, 0);
    EXPECT_EQ(c[0].mean, 0);
    EXPECT_NEAR(Vector(c[0].first_direction).norm(), 1, 1e-15);
    for (const int i : {1, 2}) {
        EXPECT_EQ(c[i].first, 0);
        EXPECT_EQ(Vector(c[i].first_direction).norm(), 0);
    }
    EXPECT_NEAR(c[3].first, 0.5, 1e-15);
    EXPECT_NEAR(c[3].second, 0, 1e-15);
    EXPECT_NEAR(std::abs(c[3].first_direction[0]), 1, 1e-15);
    EXPECT_NEAR(std::abs(c[3].second_direction[1]), 1, 1e-15);
    const double weightless[24] = {1, 2, 3, 0, 1};
    evaluate_curvature(weightless, 4, std::span(c, 1));
    EXPECT_EQ(c[0].gaussian, 0);
}

}  // namespace
}  // namespace limn::test
