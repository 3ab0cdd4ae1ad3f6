// The limit surface around one extraordinary vertex by eigenvectors of its subdivision matrix, as an
// implementation of its own: nothing of the library is used. Stam 1998, "Exact evaluation of Catmull-Clark
// subdivision surfaces at arbitrary parameter values"; Stam 1999, "Evaluation of Loop subdivision surfaces".
#pragma once

#include <Eigen/Dense>
#include <array>
#include <initializer_list>
#include <utility>
#include <vector>

namespace limn::test {

/// A control point: from the extraordinary vertex (0, 0, 0) `i` edges along ray `s`, then to the left, along
/// the sector between rays s and s + 1, `j` edges.
using StarLabel = std::array<int, 3>;

/// How often the star is refined by powers of the matrix, or through its eigenvectors.
enum class StamMethod { powers, eigenvectors };

/// The face between rays 0 and 1 of a vertex of some valence, and all other vertices regular.
class StamEvaluator {
  public:
    StamEvaluator(bool triangles, int valence);

    /// The control points that the face depends on, in the order of the matrices: 2 n + 8, or n + 6 of
    /// triangles.
    const std::vector<StarLabel>& labels() const { return labels_; }

    /// The value, du, dv, duu, duv and dvv at (u, v), not (0, 0): u along ray 0, v along ray 1. `points`: a
    /// row of three for each label. Row k of the result is value k.
    Eigen::Matrix<double, 6, 3> evaluate(const Eigen::MatrixXd& points, double u, double v,
                                         StamMethod method = StamMethod::powers) const;

    /// Of the eigenvectors; infinite where there are too few.
    double condition() const;

  private:
    /// Numbers of the points around: (x, y) counts edges along rays 0 and 1.
    using Place = std::pair<int, int>;
    int number_of(const StarLabel& label) const;
    int number_at(Place place) const;
    Eigen::RowVectorXd row(std::initializer_list<std::pair<Place, double>> entries) const;
    Eigen::RowVectorXd fine_row(Place fine) const;
    Eigen::RowVectorXd child_row(const StarLabel& label) const;
    Eigen::RowVectorXd vertex_row() const;
    StarLabel label_at(Place place) const;
    void add_patch(Place origin, int direction);

    bool triangles_;
    int valence_;
    std::vector<StarLabel> labels_;
    Eigen::MatrixXd step_;                    ///< of the points themselves
    std::array<Eigen::MatrixXd, 3> patches_;  ///< of 16 (12) points of a regular patch of the next level
    Eigen::MatrixXcd vectors_, inverse_;
    Eigen::VectorXcd values_;
};

}  // namespace limn::test
