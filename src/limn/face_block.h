// The refined vertices over one face, told by where they stand among its refined faces. Not part of the
// public interface.
#pragma once

#include <vector>

#include "limn/neighborhood.h"
#include "limn/refinement.h"

namespace limn {

/// Where on a face a refined vertex lies. Border vertices belong to the first face around the control vertex
/// or edge.
enum class Place : uint8_t { inside, edge, vertex };

/// The refined vertices over a face of n corners, each by a corner of the refined faces, counted from the
/// first over the face. `turned[s]` are the same vertices where the walk starts at corner s.
struct Block {
    std::vector<Place> places;
    std::vector<uint32_t> sides;  ///< the face's edge or corner that a border vertex lies on
    std::vector<std::vector<uint32_t>> turned;

    const std::vector<uint32_t>& corners(Orientation o) const {
        return turned[o.rotation + (o.mirrored ? turned.size() / 2 : 0)];
    }
};

/// A face of n corners alone, refined `level` times.
Refinement refine_polygon(const SchemeOptions& options, uint32_t n, uint32_t level);

/// The block of a face of n corners, refined `level` times.
Block build_block(const SchemeOptions& options, uint32_t n, uint32_t level);

}  // namespace limn
