#include "schemes/stam.h"

#include <cassert>
#include <cmath>
#include <numbers>
#include <span>

namespace limn::test {
namespace {

using Jets = Eigen::Matrix<double, 6, Eigen::Dynamic>;  // value, du, dv, duu, duv, dvv of each function

/// Of the uniform cubic B-spline: four functions, and their derivatives.
std::array<Eigen::RowVector4d, 3> cubic_functions(double t) {
    Eigen::Matrix4d polynomials;  // powers of t, function by function
    polynomials << 1, 4, 1, 0, -3, 0, 3, 0, 3, -6, 3, 0, -1, 3, -3, 1;
    polynomials /= 6;
    const Eigen::RowVector4d powers(1, t, t * t, t * t * t), first(0, 1, 2 * t, 3 * t * t),
        second(0, 0, 2, 6 * t);
    return {powers * polynomials, first * polynomials, second * polynomials};
}

/// Function 4 * row + column.
Jets bicubic_functions(double s, double t) {
    const auto a = cubic_functions(s), b = cubic_functions(t);
    constexpr int kOrders[6][2] = {{0, 0}, {1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}};
    Jets jets(6, 16);
    for (int k = 0; k < 6; ++k)
        for (int j = 0; j < 4; ++j)
            for (int i = 0; i < 4; ++i)
                jets(k, 4 * j + i) =
                    a[static_cast<size_t>(kOrders[k][0])](i) * b[static_cast<size_t>(kOrders[k][1])](j);
    return jets;
}

/// A term of a quartic in barycentric coordinates: factor * x^a y^b z^c.
struct Term {
    double factor;
    int a, b, c;
};

/// The value and the derivatives where x and y are parameters and z = 1 - x - y, added to a column.
void add_term(const Term& term, const double (&at)[3], Eigen::Ref<Eigen::Matrix<double, 6, 1>> jet) {
    const auto power = [&](int da, int db, int dc) {  // differentiated so often by each
        double product = term.factor;
        const int exponents[3] = {term.a, term.b, term.c}, orders[3] = {da, db, dc};
        for (int k = 0; k < 3; ++k) {
            for (int d = 0; d < orders[k]; ++d) product *= exponents[k] - d;
            if (exponents[k] >= orders[k]) product *= std::pow(at[k], exponents[k] - orders[k]);
        }
        return product;
    };
    const double mixed_x = power(1, 0, 1), mixed_y = power(0, 1, 1), twice = power(0, 0, 2);
    jet(0) += power(0, 0, 0);
    jet(1) += power(1, 0, 0) - power(0, 0, 1);
    jet(2) += power(0, 1, 0) - power(0, 0, 1);
    jet(3) += power(2, 0, 0) - 2 * mixed_x + twice;
    jet(4) += power(1, 1, 0) - mixed_x - mixed_y + twice;
    jet(5) += power(0, 2, 0) - 2 * mixed_y + twice;
}

// Points of a regular patch, in lattice coordinates: rows of 3, 4, 3 and 2. Its corners A, B and C are at (1,
// 0), (0, 1) and (0, 0), with barycentric coordinates s, t and 1 - s - t.
constexpr int kLattice[12][2] = {{0, -1}, {1, -1}, {2, -1}, {-1, 0}, {0, 0},  {1, 0},
                                 {2, 0},  {-1, 1}, {0, 1},  {1, 1},  {-1, 2}, {0, 2}};

int lattice_point(int x, int y) {
    for (int k = 0; k < 12; ++k)
        if (kLattice[k][0] == x && kLattice[k][1] == y) return k;
    return assert(false), 0;
}

/// The quartic box spline's, by the terms of Stam's paper.
Jets box_spline_functions(double s, double t) {
    const Term own[] = {{6, 4, 0, 0},  {24, 3, 0, 1}, {24, 2, 0, 2}, {8, 1, 0, 3}, {1, 0, 0, 4},
                        {24, 3, 1, 0}, {60, 2, 1, 1}, {36, 1, 1, 2}, {6, 0, 1, 3}, {24, 2, 2, 0},
                        {36, 1, 2, 1}, {12, 0, 2, 2}, {8, 1, 3, 0},  {6, 0, 3, 1}, {1, 0, 4, 0}};
    const Term across[] = {{1, 4, 0, 0}, {2, 3, 0, 1}, {6, 3, 1, 0}, {6, 2, 1, 1}, {12, 2, 2, 0},
                           {6, 1, 2, 1}, {6, 1, 3, 0}, {2, 0, 3, 1}, {1, 0, 4, 0}};
    const Term beyond_second[] = {{1, 4, 0, 0}, {2, 3, 1, 0}}, beyond_third[] = {{1, 4, 0, 0}, {2, 3, 0, 1}};
    const int corners[3][2] = {{1, 0}, {0, 1}, {0, 0}};
    const double at[3] = {s, t, 1 - s - t};
    Jets jets = Jets::Zero(6, 12);
    for (int k = 0; k < 3; ++k) {
        const int second = (k + 1) % 3, third = (k + 2) % 3;
        const auto point = [&](int a, int b,
                               int c) {  // a times corner k, b times the second, c times the third
            return lattice_point(a * corners[k][0] + b * corners[second][0] + c * corners[third][0],
                                 a * corners[k][1] + b * corners[second][1] + c * corners[third][1]);
        };
        const auto add = [&](int column, std::span<const Term> terms) {
            for (const Term& term : terms) {
                int exponents[3] = {};
                exponents[k] = term.a;
                exponents[second] = term.b;
                exponents[third] = term.c;
                add_term({term.factor / 12, exponents[0], exponents[1], exponents[2]}, at, jets.col(column));
            }
        };
        add(point(1, 0, 0), own);
        add(point(1, 1, -1), across);
        add(point(2, 0, -1), beyond_second);
        add(point(2, -1, 0), beyond_third);
    }
    return jets;
}

}  // namespace

StarLabel StamEvaluator::label_at(Place place) const {
    const auto [x, y] = place;
    const int n = valence_;
    if (triangles_) {
        if (x == 0 && y == 0) return {0, 0, 0};
        if (y < 0) return x + y == 0 ? StarLabel{n - 1, -y, 0} : StarLabel{n - 1, -y, x + y};
        if (x < 0) return x + y == 0 ? StarLabel{2 % n, y, 0} : StarLabel{1, x + y, -x};
        return x == 0 ? StarLabel{1, y, 0} : StarLabel{0, x, y};
    }
    if (y < 0) return {n - 1, -y, x};
    if (x < 0) return y == 0 ? StarLabel{2 % n, -x, 0} : StarLabel{1, y, -x};
    return x == 0 ? StarLabel{y == 0 ? 0 : 1, y, 0} : StarLabel{0, x, y};
}

int StamEvaluator::number_of(const StarLabel& label) const {
    for (size_t k = 0; k < labels_.size(); ++k)
        if (labels_[k] == label) return static_cast<int>(k);
    return assert(false), 0;
}
int StamEvaluator::number_at(Place place) const {
    return number_of(label_at(place));
}

Eigen::RowVectorXd StamEvaluator::row(std::initializer_list<std::pair<Place, double>> entries) const {
    Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(static_cast<Eigen::Index>(labels_.size()));
    for (const auto& [place, weight] : entries) row(number_at(place)) += weight;
    return row;
}

/// A point of the next level that is regular, at (x, y) edges of that level.
Eigen::RowVectorXd StamEvaluator::fine_row(Place fine) const {
    const auto [x, y] = fine;
    const auto half = [](int k) { return (k - (k & 1)) / 2; };
    const bool odd_x = (x & 1) != 0, odd_y = (y & 1) != 0;
    const int i = half(x), j = half(y);
    if (!triangles_) {
        const auto along = [](bool odd) {
            return odd ? std::array<double, 3>{0, 0.5, 0.5} : std::array<double, 3>{0.125, 0.75, 0.125};
        };
        Eigen::RowVectorXd sum = row({});
        for (int b = -1; b <= 1; ++b)
            for (int a = -1; a <= 1; ++a) {
                const double weight =
                    along(odd_x)[static_cast<size_t>(a + 1)] * along(odd_y)[static_cast<size_t>(b + 1)];
                if (weight != 0) sum(number_at({i + a, j + b})) += weight;
            }
        return sum;
    }
    const double ends = 3.0 / 8, sides = 1.0 / 8;
    if (odd_x && odd_y)
        return row({{{i, j + 1}, ends}, {{i + 1, j}, ends}, {{i + 1, j + 1}, sides}, {{i, j}, sides}});
    if (odd_x) return row({{{i, j}, ends}, {{i + 1, j}, ends}, {{i, j + 1}, sides}, {{i + 1, j - 1}, sides}});
    if (odd_y) return row({{{i, j}, ends}, {{i, j + 1}, ends}, {{i + 1, j}, sides}, {{i - 1, j + 1}, sides}});
    const double w = 1.0 / 16;
    return row({{{i, j}, 10 * w},
                {{i + 1, j}, w},
                {{i - 1, j}, w},
                {{i, j + 1}, w},
                {{i, j - 1}, w},
                {{i + 1, j - 1}, w},
                {{i - 1, j + 1}, w}});
}

/// The extraordinary vertex of the next level.
Eigen::RowVectorXd StamEvaluator::vertex_row() const {
    const double n = valence_;
    Eigen::RowVectorXd sum = row({});
    const double c = 3.0 / 8 + std::cos(2 * std::numbers::pi / n) / 4, beta = (5.0 / 8 - c * c) / n;
    sum(0) = triangles_ ? 1 - n * beta : 1 - 7 / (4 * n);
    for (int s = 0; s < valence_; ++s) {
        sum(number_of({s, 1, 0})) = triangles_ ? beta : 3 / (2 * n * n);
        if (!triangles_) sum(number_of({s, 1, 1})) = 1 / (4 * n * n);
    }
    return sum;
}

/// The point of the next level with this label.
Eigen::RowVectorXd StamEvaluator::child_row(const StarLabel& label) const {
    const int n = valence_, s = label[0], next = (s + 1) % n, previous = (s + n - 1) % n;
    if (label == StarLabel{0, 0, 0}) return vertex_row();
    Eigen::RowVectorXd sum = row({});
    if (label == StarLabel{s, 1, 0}) {  // the edge along ray s
        const double ends = 3.0 / 8, sides = triangles_ ? 1.0 / 8 : 1.0 / 16;
        sum(0) = ends;
        sum(number_of({s, 1, 0})) = ends;
        for (const int beside : {next, previous}) sum(number_of({beside, 1, 0})) += sides;
        if (!triangles_)
            for (const int sector : {s, previous}) sum(number_of({sector, 1, 1})) += sides;
        return sum;
    }
    if (!triangles_ && label == StarLabel{s, 1, 1}) {  // the face of sector s
        sum(0) = 0.25;
        for (const StarLabel& corner : {StarLabel{s, 1, 0}, StarLabel{s, 1, 1}, StarLabel{next, 1, 0}})
            sum(number_of(corner)) = 0.25;
        return sum;
    }
    for (int y = -1; y <= 2; ++y)
        for (int x = -1; x <= 2; ++x)
            if (label_at({x, y}) == label && (x > 1 || y > 1 || x + y > 1)) return fine_row({x, y});
    return assert(false), sum;
}

/// A regular patch of the next level, of which (0, 0) is at `origin`, and u and v go on by `direction`.
void StamEvaluator::add_patch(Place origin, int direction) {
    const int count = triangles_ ? 12 : 16;
    Eigen::MatrixXd patch(count, static_cast<Eigen::Index>(labels_.size()));
    for (int k = 0; k < count; ++k) {
        const int x = triangles_ ? kLattice[k][0] : k % 4 - 1, y = triangles_ ? kLattice[k][1] : k / 4 - 1;
        const Place place = {origin.first + direction * x, origin.second + direction * y};
        const bool fine =
            place.first > 1 || place.second > 1 || (triangles_ && place.first + place.second > 1);
        patch.row(k) = fine ? fine_row(place) : child_row(label_at(place));
    }
    for (Eigen::MatrixXd& slot : patches_)
        if (slot.size() == 0) {
            slot = patch;
            return;
        }
}

StamEvaluator::StamEvaluator(bool triangles, int valence) : triangles_(triangles), valence_(valence) {
    const int n = valence;
    labels_.push_back({0, 0, 0});
    for (int s = 0; s < n; ++s) {
        labels_.push_back({s, 1, 0});
        if (!triangles) labels_.push_back({s, 1, 1});
    }
    if (triangles)
        labels_.insert(labels_.end(), {{n - 1, 1, 1}, {0, 2, 0}, {0, 1, 1}, {1, 2, 0}, {1, 1, 1}});
    else
        labels_.insert(labels_.end(),
                       {{n - 1, 1, 2}, {0, 2, 0}, {0, 2, 1}, {0, 2, 2}, {0, 1, 2}, {1, 2, 0}, {1, 2, 1}});
    const auto count = static_cast<Eigen::Index>(labels_.size());
    step_.resize(count, count);
    for (Eigen::Index k = 0; k < count; ++k) step_.row(k) = child_row(labels_[static_cast<size_t>(k)]);
    add_patch({1, 0}, 1);
    add_patch({0, 1}, 1);
    add_patch({1, 1}, triangles ? -1 : 1);
    const Eigen::EigenSolver<Eigen::MatrixXd> solver(step_);
    values_ = solver.eigenvalues();
    vectors_ = solver.eigenvectors();
    inverse_ = vectors_.inverse();
}

double StamEvaluator::condition() const {
    const auto values = Eigen::JacobiSVD<Eigen::MatrixXcd>(vectors_).singularValues();
    return values(0) / values(values.size() - 1);
}

Eigen::Matrix<double, 6, 3> StamEvaluator::evaluate(const Eigen::MatrixXd& points, double u, double v,
                                                    StamMethod method) const {
    // The level at which the place is outside the faces at the vertex, and the patch there.
    const double farthest = triangles_ ? u + v : std::max(u, v);
    const int level = std::max(1, static_cast<int>(std::floor(-std::log2(farthest))) + 1);
    const double scale = std::exp2(level), x = scale * u, y = scale * v;
    const size_t patch = triangles_ ? (x >= 1 ? 0 : y >= 1 ? 1 : 2) : (x < 1 ? 1 : y < 1 ? 0 : 2);
    double s = patch == 1 ? x : x - 1, t = patch == 0 ? y : y - 1, sign = 1;
    if (triangles_ && patch == 2) {
        s = 1 - x;
        t = 1 - y;
        sign = -1;
    }
    Eigen::MatrixXd refined = points;
    if (method == StamMethod::powers) {
        for (int k = 1; k < level; ++k) refined = step_ * refined;
    } else {
        Eigen::MatrixXcd projected = inverse_ * points;
        for (Eigen::Index k = 0; k < values_.size(); ++k) projected.row(k) *= std::pow(values_(k), level - 1);
        refined = (vectors_ * projected).real();
    }
    const Jets jets = triangles_ ? box_spline_functions(s, t) : bicubic_functions(s, t);
    Eigen::Matrix<double, 6, 3> out = jets * (patches_[patch] * refined);
    out.middleRows(1, 2) *= sign * scale;
    out.bottomRows(3) *= scale * scale;
    return out;
}

}  // namespace limn::test
