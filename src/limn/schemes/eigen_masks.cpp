#include "limn/schemes/eigen_masks.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace limn {
namespace {

using Complex = std::complex<double>;

constexpr double kSpread = 1e-3;  // a defective eigenvalue of a block of n is off by the n-th root of the precision
constexpr double kSameModulus = 1e-7;
constexpr double kSingular = 1e-9;

template <class Matrix>
std::vector<Complex> eigenvalues_of(const Matrix& matrix) {
    std::vector<Complex> values;
    if constexpr (std::is_same_v<Matrix, Eigen::MatrixXd>) {
        const Eigen::EigenSolver<Matrix> solver(matrix, false);
        values.assign(solver.eigenvalues().begin(), solver.eigenvalues().end());
    } else {
        const Eigen::ComplexEigenSolver<Matrix> solver(matrix, false);
        values.assign(solver.eigenvalues().begin(), solver.eigenvalues().end());
    }
    return values;
}

/// Whether `count` eigenvalues near `mean` are one that is defective: the matrix less it loses less rank than that.
template <class Matrix>
bool is_one_eigenvalue(const Matrix& matrix, Complex mean) {
    const Eigen::MatrixXcd shifted =
        matrix.template cast<Complex>() - mean * Eigen::MatrixXcd::Identity(matrix.rows(), matrix.cols());
    Eigen::FullPivLU<Eigen::MatrixXcd> lu(shifted);
    lu.setThreshold(kSingular);
    return lu.rank() < matrix.rows();
}

/// Clusters that only rounding has spread become one value.
template <class Matrix>
void join_defective(const Matrix& matrix, std::vector<Complex>& values) {
    std::vector<bool> done(values.size(), false);
    for (size_t i = 0; i < values.size(); ++i) {
        if (done[i]) continue;
        std::vector<size_t> near;
        Complex sum = 0;
        double spread = 0;
        for (size_t k = i; k < values.size(); ++k)
            if (!done[k] && std::abs(values[k] - values[i]) < kSpread) {
                near.push_back(k);
                sum += values[k];
                spread = std::max(spread, std::abs(values[k] - values[i]));
            }
        const Complex mean = sum / static_cast<double>(near.size());
        if (spread > 1e-12 && !is_one_eigenvalue(matrix, mean)) continue;
        for (const size_t k : near) {
            values[k] = std::abs(mean.imag()) < 1e-13 ? Complex(mean.real(), 0) : mean;
            done[k] = true;
        }
    }
}

template <class Matrix>
std::vector<Complex> sorted(const Matrix& matrix) {
    std::vector<Complex> values = eigenvalues_of(matrix);
    join_defective(matrix, values);
    // Moduli that differ by rounding must not decide: they are compared on a grid.
    auto modulus = [](Complex c) { return std::round(std::abs(c) * 1e10); };
    std::stable_sort(values.begin(), values.end(), [&](Complex a, Complex b) {
        if (modulus(a) != modulus(b)) return modulus(a) > modulus(b);
        if (std::abs(a.real() - b.real()) > 1e-10) return a.real() > b.real();
        return a.imag() > b.imag() + 1e-10;
    });
    return values;
}

template <class Matrix>
Matrix null_space_of(const Matrix& matrix) {
    Eigen::FullPivLU<Matrix> lu(matrix);
    lu.setThreshold(kSingular);
    if (lu.dimensionOfKernel() == 0) return Matrix(matrix.rows(), 0);
    return lu.kernel();
}

void append_columns(Eigen::MatrixXd& to, const Eigen::MatrixXd& columns) {
    to.conservativeResize(columns.rows(), to.cols() + columns.cols());
    to.rightCols(columns.cols()) = columns;
}

}  // namespace

Eigen::MatrixXd matrix_of_rows(const std::vector<Row>& rows, uint32_t source_count) {
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(static_cast<int>(rows.size()), static_cast<int>(source_count));
    for (size_t r = 0; r < rows.size(); ++r)
        for (const RowEntry& entry : rows[r])
            matrix(static_cast<int>(r), static_cast<int>(entry.index)) += entry.weight;
    return matrix;
}

std::vector<int> closed_labels(const Eigen::MatrixXd& matrix, const std::vector<int>& seeds) {
    constexpr double kZero = 1e-14;
    std::vector<uint8_t> in(static_cast<size_t>(matrix.rows()), 0);
    std::vector<int> found;
    auto visit = [&](int label) {
        if (in[static_cast<size_t>(label)]++ == 0) found.push_back(label);
        in[static_cast<size_t>(label)] = 1;
    };
    for (const int seed : seeds) visit(seed);
    for (size_t i = 0; i < found.size(); ++i)
        for (int c = 0; c < matrix.cols(); ++c)
            if (std::abs(matrix(found[i], c)) > kZero) visit(c);
    std::sort(found.begin(), found.end());
    return found;
}

Eigen::MatrixXd block_of(const Eigen::MatrixXd& matrix, const std::vector<int>& labels) {
    return matrix(labels, labels);
}

std::vector<Complex> sorted_eigenvalues(const Eigen::MatrixXd& matrix) {
    return sorted(matrix);
}
std::vector<Complex> sorted_eigenvalues(const Eigen::MatrixXcd& matrix) {
    return sorted(matrix);
}

Eigen::MatrixXd null_space(const Eigen::MatrixXd& matrix) {
    return null_space_of(matrix);
}
Eigen::MatrixXcd null_space(const Eigen::MatrixXcd& matrix) {
    return null_space_of(matrix);
}

Eigen::VectorXd position_mask(const Eigen::MatrixXd& matrix) {
    const auto n = matrix.rows();
    // Adding u 1^T, which the sum of one turns into u, makes I - A^T regular.
    const Eigen::VectorXd u = Eigen::VectorXd::Constant(n, 1.0 / static_cast<double>(n));
    const Eigen::MatrixXd regular =
        Eigen::MatrixXd::Identity(n, n) - matrix.transpose() + u * Eigen::RowVectorXd::Ones(n);
    const Eigen::PartialPivLU<Eigen::MatrixXd> lu(regular);
    Eigen::VectorXd mask = lu.solve(u);
    mask += lu.solve(u - regular * mask);
    return mask;
}

LeftVectors::LeftVectors(const Eigen::MatrixXd& matrix) : transposed_(matrix.transpose()) {
    eigenvalues_ = sorted_eigenvalues(matrix);
    const auto one = std::min_element(eigenvalues_.begin(), eigenvalues_.end(),
                                      [](Complex a, Complex b) { return std::abs(a - 1.0) < std::abs(b - 1.0); });
    if (one != eigenvalues_.end()) eigenvalues_.erase(one);
}

Eigen::MatrixXd LeftVectors::next() {
    const auto n = transposed_.rows();
    Eigen::MatrixXd group(n, 0);
    const size_t begin = at_;
    for (; at_ < eigenvalues_.size(); ++at_) {
        const Complex value = eigenvalues_[at_];
        if (std::abs(std::abs(value) - std::abs(eigenvalues_[begin])) > kSameModulus) break;
        bool seen = value.imag() < 0;  // the other one of a pair
        for (size_t k = begin; k < at_; ++k) seen = seen || std::abs(eigenvalues_[k] - value) < kSameModulus;
        if (seen) continue;
        if (value.imag() == 0) {
            append_columns(
                group, null_space_of<Eigen::MatrixXd>(transposed_ - value.real() * Eigen::MatrixXd::Identity(n, n)));
        } else {
            const Eigen::MatrixXcd vectors =
                null_space_of<Eigen::MatrixXcd>(transposed_.cast<Complex>() - value * Eigen::MatrixXcd::Identity(n, n));
            append_columns(group, vectors.real());
            append_columns(group, vectors.imag());
        }
    }
    if (group.cols() == 0) return at_ < eigenvalues_.size() ? next() : group;
    return Eigen::HouseholderQR<Eigen::MatrixXd>(group).householderQ() * Eigen::MatrixXd::Identity(n, group.cols());
}

}  // namespace limn
