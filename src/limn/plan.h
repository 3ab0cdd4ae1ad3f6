// Plans: the surface over one face as a function of the points around it. Not part of the public interface.
#pragma once

#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

#include "limn/neighborhood.h"
#include "limn/patch_points.h"
#include "limn/patch_table.h"
#include "limn/quad_star.h"
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

/// The points of a face that is one patch, where that may be a leaf of a plan or a surface.
bool find_patch(const Topology& t, uint32_t face, const PlanOptions& options, PatchPoints& out);

/// A patch over the few vertices that its points are made of.
struct LocalPatch {
    std::vector<uint32_t> ring;       ///< vertices
    uint32_t rotation = 0;            ///< the corner of the face that is corner 0 of the patch
    std::vector<uint32_t> signature;  ///< all that it is, but for the vertices: equal where plans are
};
void make_local(const PatchPoints& patch, LocalPatch& out);
void make_local(QuadNet net, QuadPattern pattern, LocalPatch& out);

/// That of faces that have a regular ring (write_regular_ring).
LocalPatch make_regular_patch(const SchemeOptions& options, bool linear);

/// A plan to build.
struct PlanRequest {
    uint32_t ring_size = 0;
    /// Of a face that is one patch: its signature. Or else
    std::vector<uint32_t> patch;
    /// of one that is irregular at a corner: the star there. Or else
    std::optional<QuadStar> star;
    /// a face of some topology, with its neighbourhood walked from choose_plan_corner: turned so that the corner is 0,
    /// and those around it,
    std::unique_ptr<Topology> part;
    std::vector<uint32_t> slots;  ///< and the place in the ring of each vertex of `part`.
};
/// What all keys of a mesh begin with.
PlanKey begin_plan_key(const SchemeOptions& o, const PlanOptions& options);
PlanKey make_plan_key(const Topology& t, const Neighborhood& hood, const PlanOptions& options);
PlanRequest request_plan(const Topology& t, const Neighborhood& hood, uint32_t corner);
/// Of patches.
PlanKey make_patch_key(const SchemeOptions& options, const LocalPatch& patch);
PlanRequest request_patch_plan(const LocalPatch& patch);
/// Of quads that are irregular at a corner, cut to their sector; those are not one patch.
PlanKey make_star_key(const SchemeOptions& scheme, const PlanOptions& options, const QuadStar& star);
PlanRequest request_star_plan(const QuadStar& star);

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
NewPlan build_plan(const PlanRequest& request, const SchemeOptions& scheme, const PlanOptions& options,
                   const KnownPlans& known, PlanScratch& scratch);

}  // namespace limn
