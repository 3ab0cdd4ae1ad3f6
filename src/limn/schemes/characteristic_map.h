// Control nets of characteristic maps: drawing and checking them. Includes Eigen: not part of the public interface.
#pragma once

#include <Eigen/Core>

#include "limn/schemes/scheme_analysis.h"
#include "limn/schemes/star_chain.h"

namespace limn {

/// The rings of a patch that decide all faces of a map of `rings` rings, refined twice.
uint32_t map_rings(const SubdivisionScheme& scheme, uint32_t rings);

/// Outer points of an eigenvector whose inner ones are there: a step (of the chain's cycle) takes the vector to
/// `factor` times itself.
Eigen::VectorXcd extend_map(const StarChain& chain, Eigen::VectorXcd inner, std::complex<double> factor);

/// Fills the map's points and faces and says whether it is regular and injective.
void draw_map(const SubdivisionScheme& scheme, const StarPatch& patch, uint32_t rings, const Eigen::VectorXcd& points,
              SchemeAnalysis& out);

}  // namespace limn
