// Binary glTF files: out only.
#pragma once

#include <string>

#include "limn/mesh_output.h"
#include "limn/result.h"

namespace limn::cli {

/// Writes binary glTF 2.0 (.glb): a scene of one mesh of triangles, with a neutral material.
/// - Faces of more than three corners become fans around their first corner, those of fewer are left out.
///   Where no triangle remains, the scene has a node without a mesh.
/// - Vertices keep their order, used or not. But glTF has no texture indices: where face_texture_coordinates
///   are given, there is one vertex for each pair of vertex and texture coordinate at a corner, in order of
///   first use. Seams have vertices of equal position then, so the mesh is closed only to who merges those.
/// - TEXCOORD_0 is (u, 1 - v), since v runs downward in glTF. Normals are written as they are; glTF wants
///   them at unit length.
///
/// Takes twice the size of the file in memory. Errors: as check_mesh_output(), not_finite (Error::element is
/// the vertex or the texture coordinate), too_large (more than 2^32 - 1 bytes), cannot_open, out_of_memory,
/// on one line, `PATH: cause`; the file is then as it was.
Result<void> write_glb(const std::string& path, const MeshOutput& mesh);

}  // namespace limn::cli
