// Numbers of the refined vertices over a face, without a list of them: vertices that are born alike, at one level on one
// edge or inside, have numbers in a row, whose first depends on the face alone. Not part of the public interface.
#pragma once

#include <span>
#include <vector>

#include "limn/face_block.h"
#include "limn/local_refinement.h"
#include "limn/shared/grid_eval_params.h"

namespace limn {

/// Slots of a face of n corners, each the first number of such a row: one for each corner; for each edge one of level 1
/// and two (halves of the edge) of every later level; those inside.
struct FaceNumbers {
    uint32_t slot_count = 0;
    /// For each orientation and target of the block: its slot << kGridOffsetBits | its place in the row.
    std::vector<std::vector<uint32_t>> words;
};

/// Error: unsupported (more slots or longer rows than a word holds).
Result<FaceNumbers> number_face(const SchemeOptions& options, const Block& block, uint32_t n, uint32_t level);

/// The slots (FaceNumbers::slot_count) of a face of `base`, as the whole mesh numbers its vertices at `level`; kInvalidIndex for
/// those of corners and edges that are first met elsewhere: in another face, or at another corner of this one.
void write_face_slots(const Topology& base, const std::vector<LevelCounts>& counts, uint32_t level, uint32_t face,
                      std::span<uint32_t> slots);

}  // namespace limn
