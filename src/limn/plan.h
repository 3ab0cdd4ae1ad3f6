// Plans: the surface over one face as a function of the points around it. Not part of the public interface.
#pragma once

#include <mutex>
#include <unordered_map>
#include <vector>

#include "limn/neighborhood.h"
#include "limn/patch_table.h"
#include "limn/topology.h"

namespace limn {

/// A plan on its own; Plan in patch_table.h tells what the arrays hold. Nodes of kind `plan` name an entry of
/// `references`.
struct BuiltPlan {
    uint32_t ring_size = 0;
    uint32_t row_count = 0;
    bool has_corner_rows = false;
    std::vector<double> weights;
    std::vector<PlanNode> nodes;
    std::vector<uint32_t> points;
    std::vector<const BuiltPlan*> references;
};

/// Everything that a plan depends on.
using PlanKey = std::vector<uint32_t>;
struct PlanKeyHash {
    size_t operator()(const PlanKey& key) const { return hash_signature(key)[0]; }
};

struct PlanCache::Impl {
    std::mutex mutex;
    std::unordered_map<PlanKey, std::unique_ptr<BuiltPlan>, PlanKeyHash> plans;
    uint64_t bytes = 0;
};

struct PlanOptions {
    bool linear;
    EndCap end_cap;
    /// Levels below the root at which irregular faces become references or, from 0 on, Gregory patches.
    uint32_t depth;
};

/// The corner of a face that its plan calls 0, so that alike faces share: the least regular one. Where only
/// one is irregular evaluation must find it there, at every level (Plan::has_corner_rows).
uint32_t choose_plan_corner(const Topology& t, uint32_t face);

/// A plan to build: of a face of `t`, with its neighbourhood walked from choose_plan_corner.
struct PlanRequest {
    PlanKey key;
    Topology part;                ///< the face, turned so that the corner is 0, and those around it
    std::vector<uint32_t> slots;  ///< the place in the ring of each vertex of `part`
    uint32_t ring_size = 0;
    PlanNodeKind kind = PlanNodeKind::split;  ///< of a regular face, which has no `part`
};
/// The plan of faces that have a regular ring (find_regular_ring).
PlanRequest request_regular_plan(const SchemeOptions& options, bool linear);
PlanKey make_plan_key(const Topology& t, const Neighborhood& hood, const PlanOptions& options);
PlanRequest request_plan(const Topology& t, const Neighborhood& hood, uint32_t corner, PlanKey key);

/// Plans of one build: taken from the cache or, where missing, built on all cores.
class PlanSet {
  public:
    PlanSet(const PlanOptions& options, PlanCache::Impl& cache) : options_(options), cache_(cache) {}

    /// The number of the plan of this key; `make_request` is called where it is not known yet.
    template <class MakeRequest>
    uint32_t find_or_request(const PlanKey& key, const MakeRequest& make_request) {
        const auto [at, is_new] = numbers_.try_emplace(key, static_cast<uint32_t>(entries_.size()));
        if (is_new) {
            entries_.push_back({&at->first, find_cached(key), nullptr, {}});
            if (entries_.back().plan == nullptr) requests_.push_back({at->second, make_request()});
        }
        return at->second;
    }

    /// Builds what was requested, and what that refers to; then hands all to the cache. After it plan()
    /// holds.
    Result<void> build();
    const BuiltPlan* plan(uint32_t number) const { return entries_[number].plan; }

  private:
    struct Entry {
        const PlanKey* key;
        const BuiltPlan* plan;             ///< in the cache, or `built`
        std::unique_ptr<BuiltPlan> built;  ///< not yet in the cache
        std::vector<uint32_t> references;  ///< numbers
    };
    struct Request {
        uint32_t number;
        PlanRequest request;
    };
    const BuiltPlan* find_cached(const PlanKey& key) const;
    void keep_in_cache();

    PlanOptions options_;
    PlanCache::Impl& cache_;
    std::unordered_map<PlanKey, uint32_t, PlanKeyHash> numbers_;
    std::vector<Entry> entries_;
    std::vector<Request> requests_;
};

}  // namespace limn
