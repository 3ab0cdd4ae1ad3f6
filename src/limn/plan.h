// Plans: the surface over one face as a function of the points around it. Not part of the public interface.
#pragma once

#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

#include "limn/neighborhood.h"
#include "limn/patch_table.h"
#include "limn/topology.h"

namespace limn {

/// A plan on its own; Plan in patch_table.h tells what the arrays hold. Nodes of kind `plan` name an entry of
/// `references`.
struct BuiltPlan {
    PlanIdentity identity = {};
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

struct PlanOptions {
    bool linear;
    EndCap end_cap;
    /// Levels below the root at which irregular faces become references or, from 0 on, Gregory patches.
    uint32_t depth;
};

/// The corner of a face that its plan calls 0, so that alike faces share: the least regular one. Where only
/// one is irregular evaluation must find it there, at every level (Plan::has_corner_rows). `regular`, where
/// at hand, is what find_regular_vertices made.
uint32_t choose_plan_corner(const Topology& t, uint32_t face, const std::vector<uint8_t>* regular = nullptr);

/// A plan to build: of a face of `t`, with its neighbourhood walked from choose_plan_corner.
struct PlanRequest {
    PlanKey key;
    Topology part;                ///< the face, turned so that the corner is 0, and those around it
    std::vector<uint32_t> slots;  ///< the place in the ring of each vertex of `part`
    uint32_t ring_size = 0;
    PlanNodeKind kind = PlanNodeKind::split;  ///< of a regular face, which has no `part`
};
/// The plan of faces that have a regular ring (write_regular_ring).
PlanRequest request_regular_plan(const SchemeOptions& options, bool linear);
/// What all keys of a mesh begin with.
PlanKey begin_plan_key(const SchemeOptions& o, const PlanOptions& options);
PlanKey make_plan_key(const Topology& t, const Neighborhood& hood, const PlanOptions& options);
PlanRequest request_plan(const Topology& t, const Neighborhood& hood, uint32_t corner, PlanKey key);

/// A plan that a new one refers to, and how to build it unless it is known.
struct PlanReference {
    PlanKey key;
    std::optional<PlanRequest> request;
};
struct NewPlan {
    std::unique_ptr<BuiltPlan> plan = std::make_unique<BuiltPlan>();
    std::vector<PlanReference> references;
};
using KnownPlans = std::unordered_map<PlanKey, uint32_t, PlanKeyHash>;

struct PlanScratch;  ///< plan_scratch.h

/// Builds a plan. What it refers to and is not known comes with a request.
NewPlan build_plan(const PlanRequest& request, const PlanOptions& options, const KnownPlans& known,
                   PlanScratch& scratch);

}  // namespace limn
