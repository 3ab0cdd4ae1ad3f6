// Tangents of stationary neighbourhoods, by left eigenvectors: in the plane of a smooth vertex or face, and along and
// across what cuts the surface at a vertex. Includes Eigen: not part of the public interface.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "limn/schemes/star_patch.h"

namespace limn {

/// Weights over all vertices of a patch.
struct Tangents {
    Eigen::VectorXd first, second;
};

/// Two edges of the first face: for want of tangents.
Tangents edge_tangents(const StarPatch& patch);

/// The labels of the element's own faces.
std::vector<int> ring_labels(const StarPatch& patch);

/// `values` of `labels`, zeros elsewhere.
Eigen::VectorXd scatter(const Eigen::VectorXd& values, const std::vector<int>& labels, uint32_t size);

/// The plane of the subdominant eigenvalues of a patch that `matrix` takes to itself, where there are exactly two.
std::optional<Tangents> smooth_tangents(const StarPatch& patch, const Eigen::MatrixXd& matrix);

/// Faces around vertex 0 between two of its edges, boundaries or infinitely sharp: a piece of surface of its own.
struct Sector {
    uint32_t edge = 0, faces = 0;  ///< the first edge's position; counter-clockwise
};
/// All of them, counter-clockwise. None where fewer than two edges are sharp.
std::vector<Sector> sectors_of(const StarPatch& patch);

/// Along the sector's first edge, whose curve depends on itself alone, and across it; at corners along both edges.
std::optional<Tangents> sector_tangents(const StarPatch& patch, const Eigen::MatrixXd& matrix, const Sector& sector);

/// Turns the second so that first x second lies along the normal.
void orient(const StarPatch& patch, Tangents& tangents);

}  // namespace limn
