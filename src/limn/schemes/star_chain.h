// Step after step around an element, until a neighbourhood comes again. Includes Eigen: not part of the public
// interface.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "limn/result.h"
#include "limn/schemes/star_patch.h"

namespace limn {

/// A patch and the rows of what its step makes of it over it.
struct StarLink {
    StarPatch patch;
    std::vector<Row> rows;
};

/// Steps that lead to a cycle, or to a patch that is known.
struct StarChain {
    std::vector<StarLink> links;
    size_t entry = 0;                ///< the link that the last step leads to; links.size(): a known patch
    std::vector<uint32_t> last_key;  ///< of the patch that the last step leads to
    bool exists = true;              ///< false: the element has no child

    size_t cycle_size() const { return links.size() - entry; }
    /// Link i of the cycle, counted from the one of the least key: the same wherever one enters.
    const StarLink& in_cycle(size_t i) const;
    /// What the steps of the cycle together do to points of in_cycle(0).
    Eigen::VectorXcd step(Eigen::VectorXcd points) const;
    /// The same as a matrix, of the first `count` points and all rings that they depend on.
    Eigen::MatrixXd matrix_of_cycle(uint32_t count) const;
};

/// Refines `rings` rings around the patch's element again and again. Errors: unsupported (too many faces around one
/// vertex; nothing comes again).
Result<StarChain> follow_steps(const StarPatch& patch, const SubdivisionScheme& scheme, uint32_t rings,
                               const std::function<bool(const std::vector<uint32_t>& key)>& is_known);

}  // namespace limn
