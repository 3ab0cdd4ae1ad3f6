// Whether the contents of a baked mesh fit together. Not part of the public interface.
#pragma once

#include "limn/baked_mesh.h"

namespace limn {

/// Everything that evaluation, tessellation or a device would follow: counts, offsets, indices, trees and references
/// that end, weights that are numbers. In time linear in the tables, on all cores. Errors: parse_error; the message says
/// what is wrong of which table.
Result<void> check_baked_mesh(const BakedMesh& mesh);

}  // namespace limn
