// Plans: the surface over one face as a function of the points around it. Not part of the public interface.
#pragma once

#include <deque>
#include <map>
#include <mutex>
#include <vector>

#include "limn/neighborhood.h"
#include "limn/patch_table.h"
#include "limn/topology.h"

namespace limn {

/// A plan on its own; Plan in patch_table.h tells what the arrays hold. Nodes refer to plans of the cache.
struct BuiltPlan {
    uint32_t ring_size = 0;
    uint32_t row_count = 0;
    std::vector<double> weights;
    std::vector<PlanNode> nodes;
    std::vector<uint32_t> points;
};

struct PlanCache::Impl {
    std::mutex mutex;
    std::map<std::vector<uint32_t>, uint32_t> ids;  ///< by everything that a plan depends on
    std::deque<BuiltPlan> plans;
};

struct PlanOptions {
    bool linear;
    uint32_t depth;
};

/// The corner of a face that its plan calls 0, so that alike faces share: the least regular one.
uint32_t choose_plan_corner(const Topology& t, uint32_t face);

/// The id in the cache of the plan of a face with the neighbourhood `hood`, walked from
/// choose_plan_corner; built when missing. The caller holds the mutex.
uint32_t find_or_build_plan(const Topology& t, const Neighborhood& hood, uint32_t rotation,
                            const PlanOptions& options, PlanCache::Impl& cache);

}  // namespace limn
