// PLY files: out only.
#pragma once

#include <string>

#include "limn/mesh_output.h"
#include "limn/result.h"

namespace limn {

/// Writes binary little-endian PLY. Memory use is constant.
/// - Vertices: float x y z, nx ny nz and, where there is one texture coordinate per vertex, s t.
/// - Faces: the list vertex_indices (int) and, where texture coordinates are indexed, the list texcoord
///   (float, u v per corner). Lengths are uchar, or uint where a list has more than 255 entries.
///
/// Both are customary. Blender reads s t and passes over texcoord, which is what MeshLab has for seams:
/// vertices need no splitting there, and a closed surface remains closed.
///
/// Errors: as check_mesh_output(), cannot_open, out_of_memory, on one line, `PATH: cause`; the file is then
/// as it was.
Result<void> write_ply(const std::string& path, const MeshOutput& mesh);

}  // namespace limn
