// Patch trees of tables that change, as those of crowds do: a plan's tree is grown once.
#pragma once

#include <memory>

#include "limn/patch_tree.h"

namespace limn {

/// Trees already grown, for any number of tables and threads. A tree takes about 8 bytes for each of its local points and
/// each point of its ring.
class PatchTreeCache {
  public:
    PatchTreeCache();
    ~PatchTreeCache();
    PatchTreeCache(PatchTreeCache&&) noexcept;
    PatchTreeCache& operator=(PatchTreeCache&&) noexcept;
    uint32_t size() const;   ///< trees: one for each plan, rate and kind
    uint64_t bytes() const;  ///< what they take up

    struct Impl;
    Impl& impl() const { return *impl_; }

  private:
    std::unique_ptr<Impl> impl_;
};

/// As without a cache, but that trees which it has are taken from it and new ones put there. The result is the same to the
/// bit where tables were built with one PlanCache. Errors: and invalid_argument where the table has no plan_identities.
Result<PatchTreeTable> build_patch_trees(const PatchTable& table, const PatchTreeOptions& options,
                                         const PatchTreeCache& cache);

}  // namespace limn
