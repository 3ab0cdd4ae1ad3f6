#include "limn/plan_set.h"

#include <tbb/enumerable_thread_specific.h>

#include "limn/parallel.h"
#include "limn/plan_scratch.h"

namespace limn {

const BuiltPlan* PlanSet::find_cached(const PlanKey& key) const {
    const std::lock_guard lock(cache_.mutex);
    const auto at = cache_.plans.find(key);
    return at == cache_.plans.end() ? nullptr : at->second.get();
}

uint32_t PlanSet::find(const PlanHash& hash) {
    const std::lock_guard lock(cache_.mutex);
    const auto at = cache_.plans_by_hash.find(hash);
    if (at == cache_.plans_by_hash.end()) return kInvalidIndex;
    entries_.push_back({nullptr, at->second, nullptr, {}});
    return static_cast<uint32_t>(entries_.size()) - 1;
}

Result<void> PlanSet::build(const BuildPart& part) {
    tbb::enumerable_thread_specific<PlanScratch> scratch;
    BuildPart rest = part;  // nobody knows how many plans the first ones ask for
    while (!requests_.empty()) {
        const std::vector<Request> batch = std::exchange(requests_, {});
        for (const Request& r : batch)
            if (r.request.ring_size > kMaxRingSize)
                return Error{ErrorCode::unsupported, "more than " + std::to_string(kMaxRingSize) +
                                                         " points lie around one face of the surface"};
        std::vector<NewPlan> built(batch.size());
        for_each_index(
            static_cast<uint32_t>(batch.size()), rest.part(0, 0.5f),
            [&](uint32_t i) { built[i] = build_plan(batch[i].request, scheme_, options_, numbers_, scratch.local()); },
            1);
        if (auto ok = rest.check(); !ok) return ok;
        rest = rest.part(0.5f, 1);
        // In their order, so that numbers do not depend on threads.
        for (size_t i = 0; i < batch.size(); ++i) {
            std::vector<uint32_t> references;
            for (PlanReference& r : built[i].references)
                references.push_back(find_or_request(r.key, [&] { return std::move(*r.request); }));
            Entry& entry = entries_[batch[i].number];
            entry.built = std::move(built[i].plan);
            entry.built->identity = hash_signature(*entry.key);
            entry.plan = entry.built.get();
            entry.references = std::move(references);
        }
    }
    keep_in_cache();
    return {};
}

std::pair<BuiltPlan*, bool> PlanCache::Impl::keep(const PlanKey& key, std::unique_ptr<BuiltPlan>&& plan) {
    const auto [at, is_new] = plans.try_emplace(key, std::move(plan));
    if (is_new)
        bytes += key.size() * sizeof(uint32_t) + at->second->weights.size() * sizeof(double) +
                 at->second->nodes.size() * sizeof(PlanNode) + at->second->points.size() * sizeof(uint32_t);
    return {at->second.get(), is_new};
}

/// Another build may have put a plan there since it was looked for: then that one is taken.
void PlanSet::keep_in_cache() {
    const std::lock_guard lock(cache_.mutex);
    std::vector<std::pair<BuiltPlan*, const std::vector<uint32_t>*>> kept;
    for (Entry& entry : entries_) {
        if (entry.built == nullptr) continue;
        const auto [plan, is_new] = cache_.keep(*entry.key, std::move(entry.built));
        if (is_new) kept.emplace_back(plan, &entry.references);
        entry.plan = plan;
    }
    for (const auto& [plan, references] : kept)
        for (const uint32_t r : *references) plan->references.push_back(entries_[r].plan);
    for (const auto& [hash, number] : hashes_)
        if (cache_.plans_by_hash.try_emplace(hash, entries_[number].plan).second)
            cache_.bytes += sizeof(PlanHash) + sizeof(const BuiltPlan*);
}

PlanCache::PlanCache() : impl_(std::make_unique<Impl>()) {}
PlanCache::~PlanCache() = default;
PlanCache::PlanCache(PlanCache&&) noexcept = default;
PlanCache& PlanCache::operator=(PlanCache&&) noexcept = default;

uint32_t PlanCache::size() const {
    const std::lock_guard lock(impl_->mutex);
    return static_cast<uint32_t>(impl_->plans.size());
}

uint64_t PlanCache::bytes() const {
    const std::lock_guard lock(impl_->mutex);
    return impl_->bytes;
}

}  // namespace limn
