// The plans that a patch table needs: taken from a cache, or built. Not part of the public interface.
#pragma once

#include <mutex>

#include "limn/plan.h"

namespace limn {

/// 128 bits in the place of a key: told more quickly where a plan is known. Different ones may be of one
/// plan.
using PlanHash = std::array<uint64_t, 2>;
struct PlanHashHash {
    size_t operator()(const PlanHash& hash) const { return hash[0]; }
};

struct PlanCache::Impl {
    std::mutex mutex;
    std::unordered_map<PlanKey, std::unique_ptr<BuiltPlan>, PlanKeyHash> plans;
    std::unordered_map<PlanHash, const BuiltPlan*, PlanHashHash> plans_by_hash;
    uint64_t bytes = 0;

    /// Keeps a plan, unless there is one of this key: the one that is there, and whether it is new. The caller has the
    /// mutex, and fills in the references of a new one before it gives that away.
    std::pair<BuiltPlan*, bool> keep(const PlanKey& key, std::unique_ptr<BuiltPlan>&& plan);
};

/// Plans of one build: taken from the cache or, where missing, built on all cores.
class PlanSet {
  public:
    PlanSet(const SchemeOptions& scheme, const PlanOptions& options, PlanCache::Impl& cache)
        : scheme_(scheme), options_(options), cache_(cache) {}

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

    /// The number of the plan of a hash that was kept in the cache, or kInvalidIndex.
    uint32_t find(const PlanHash& hash);
    /// Lets later builds find the plan by this hash, once build() puts it into the cache.
    void keep_hash(const PlanHash& hash, uint32_t number) { hashes_.emplace_back(hash, number); }

    /// Builds what was requested, and what that refers to; then hands all to the cache. After it plan()
    /// holds. Errors: unsupported, cancelled: the cache then gets nothing.
    Result<void> build(const BuildPart& part);
    const BuiltPlan* plan(uint32_t number) const { return entries_[number].plan; }

  private:
    struct Entry {
        const PlanKey* key;                ///< null where found by a hash
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

    SchemeOptions scheme_;
    PlanOptions options_;
    PlanCache::Impl& cache_;
    KnownPlans numbers_;
    std::vector<Entry> entries_;
    std::vector<Request> requests_;
    std::vector<std::pair<PlanHash, uint32_t>> hashes_;
};

}  // namespace limn
