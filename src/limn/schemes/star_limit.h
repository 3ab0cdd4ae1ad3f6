// Limits of neighbourhoods: what a scheme's own steps make of a vertex or face, by the eigenvectors of the matrix of
// those steps. Not part of the public interface.
#pragma once

#include <map>
#include <shared_mutex>
#include <vector>

#include "limn/result.h"
#include "limn/schemes/scheme_refinement.h"
#include "limn/schemes/star_patch.h"

namespace limn {

/// Weights over the vertices of a patch.
struct StarMask {
    std::vector<uint32_t> labels;  ///< ascending
    std::vector<double> position, tangent1, tangent2;
    uint32_t rings = 0;   ///< whose vertices the labels are
    bool exists = true;   ///< false: the element has no child, nothing is above
    bool smooth = false;  ///< there is a tangent plane, by eigenvalues
};

/// Masks by key, made when they are asked for. Thread-safe; what they are does not depend on the order.
class StarLimits {
  public:
    /// Of patches of `rings` rings.
    StarLimits(const SubdivisionScheme& scheme, uint32_t rings) : scheme_(scheme), rings_(rings) {}

    /// The mask of a key, or null: not made yet.
    const StarMask* find(const std::vector<uint32_t>& key) const;
    /// Makes it. Errors: unsupported.
    Result<const StarMask*> make(const StarPatch& patch);

  private:
    const StarMask* insert(const std::vector<uint32_t>& key, StarMask mask);

    const SubdivisionScheme& scheme_;
    const uint32_t rings_;
    mutable std::shared_mutex mutex_;
    std::map<std::vector<uint32_t>, StarMask> masks_;
};

/// As in scheme_limit.h, with masks, of patch_rings(scheme) rings, that tables of other levels share.
template <class Real>
Result<BasicStencilTable<Real>> build_scheme_limit_table(const BasicSchemeRefinement<Real>& refined, bool tangents,
                                                         StarLimits& limits, const BuildPart& control);

}  // namespace limn
