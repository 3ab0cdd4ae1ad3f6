// The faces of a T-mesh without T-junctions. Not part of the public interface.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "limn/result.h"
#include "limn/topology.h"

namespace limn {

struct TMeshSplit {
    ControlMesh mesh;               ///< quads; vertices of the T-mesh first
    std::vector<double> intervals;  ///< one for each corner
    std::vector<uint8_t>
        is_inside;  ///< one for each corner: its edge was no part of an edge, but lies inside of a face
};

/// Carries edges on from T-junctions. `lengths`: intervals of the edges. Errors: those of convert_t_mesh about faces.
Result<TMeshSplit> split_t_mesh(const Topology& t, std::span<const uint8_t> straight, std::span<const double> lengths);

}  // namespace limn
