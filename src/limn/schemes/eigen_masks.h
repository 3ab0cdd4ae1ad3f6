// Left eigenvectors of subdivision matrices. Includes Eigen: not part of the public interface.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <cstdint>
#include <vector>

#include "limn/row.h"

namespace limn {

/// Rows over `source_count` points as a matrix.
Eigen::MatrixXd matrix_of_rows(const std::vector<Row>& rows, uint32_t source_count);

/// The least set of labels that has those of `seeds` and, with each row, what the row refers to. Ascending.
std::vector<int> closed_labels(const Eigen::MatrixXd& matrix, const std::vector<int>& seeds);

/// The block of a closed set of labels.
Eigen::MatrixXd block_of(const Eigen::MatrixXd& matrix, const std::vector<int>& labels);

/// Largest modulus first; of equal ones the larger real part. Eigenvalues of a defective cluster, which rounding
/// spreads, are replaced by their mean.
std::vector<std::complex<double>> sorted_eigenvalues(const Eigen::MatrixXd& matrix);
std::vector<std::complex<double>> sorted_eigenvalues(const Eigen::MatrixXcd& matrix);

/// Columns that span what `matrix` takes to nothing, rounding aside.
Eigen::MatrixXd null_space(const Eigen::MatrixXd& matrix);
Eigen::MatrixXcd null_space(const Eigen::MatrixXcd& matrix);

/// The left eigenvector of the eigenvalue 1, which is simple, rows of `matrix` summing to one. Sums to one.
Eigen::VectorXd position_mask(const Eigen::MatrixXd& matrix);

/// The left eigenvectors of the eigenvalues after 1 that have the same modulus, group after group, largest first: real
/// orthonormal vectors, of complex pairs real and imaginary parts. True eigenvectors alone, fewer than eigenvalues
/// where those are defective.
class LeftVectors {
  public:
    explicit LeftVectors(const Eigen::MatrixXd& matrix);
    /// The next group, empty after the last one.
    Eigen::MatrixXd next();

  private:
    Eigen::MatrixXd transposed_;
    std::vector<std::complex<double>> eigenvalues_;
    size_t at_ = 0;
};

}  // namespace limn
