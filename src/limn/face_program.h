// The refinement over one face as a small linear program, and its two readings: which control points each
// refined one depends on, and with what weights. Not part of the public interface.
#pragma once

#include <vector>

#include "limn/compose.h"
#include "limn/local_refinement.h"
#include "limn/neighborhood.h"
#include "limn/stencil_row.h"

namespace limn {

/// The refinement over one face, written down: each step's rows over the points of the level before, for the
/// points that are needed. Entries hold positions among those. Points of level 0 are in the order of the
/// neighbourhood's ring. In limit tables the last step carries tangents.
struct Program {
    struct Step {
        std::vector<uint32_t> offsets;
        Row entries;
    };
    size_t ring_size = 0, target_count = 0;
    std::vector<Step> steps;                ///< in order of execution
    std::vector<TangentWeights> tangents;   ///< beside the entries of the last step
    std::vector<uint32_t> points, sources;  ///< scratch: vertices that a step makes, and needs
    Neighborhood hood;
    LocalRefinement local;
};

/// Works back from the targets over a face (corners of a Block) to the ring of its walk.
void write_program(const WalkOptions& walk, uint32_t face, Orientation orientation,
                   const std::vector<uint32_t>& target_corners, const ComposeOptions& options,
                   Program& program);

/// Supports of the targets as bit sets over the ring: `words` words each.
struct Supports {
    uint32_t words = 0;
    std::vector<uint64_t> bits, previous;
};

void run_supports(const Program& program, Supports& supports);

/// How many ring points target `row` depends on.
uint32_t support_size(const Supports& supports, size_t row);

/// Dense weights of the targets over the ring, `stride` columns a row.
struct Weights {
    size_t stride = 0;
    std::vector<double> rows, previous, tangent1, tangent2;
};

void run_weights(const Program& program, Weights& weights);

}  // namespace limn
