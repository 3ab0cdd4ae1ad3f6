// The order of a grid's surfaces. Not part of the public interface.
#pragma once

#include <span>

#include "limn/grid_table.h"

namespace limn {

/// Sorts surfaces, which come in the order of their faces, by class within each pass. Not to be used where `part`
/// is cancelled.
void sort_passes(std::span<GridSurface> surfaces, uint32_t faces_per_pass, const BuildPart& part);

}  // namespace limn
