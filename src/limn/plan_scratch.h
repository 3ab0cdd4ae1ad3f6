// Memory that building one plan leaves to the next. Not part of the public interface.
#pragma once

#include "limn/plan_rows.h"

namespace limn {

struct PlanScratch {
    /// What splitting one face needs, one for each depth.
    struct Level {
        Topology child, part;  ///< of the face and those around it; those around one of its children
        LazyRows rows;         ///< of `child`
        std::vector<uint32_t> vertices;  ///< of `child`, that those of `part` are
        VertexRows part_rows;
    };
    std::array<Level, 10> levels;
    PlanRows rows;
    LazyRows root;
    Neighborhood hood;
    std::vector<double> row, lines, child_lines;
};

}  // namespace limn
