// Models with other faces, for schemes that take triangles or quads alone.
#pragma once

#include "limn/obj.h"

namespace limn::cli {

/// Quads are cut along their shorter diagonal, larger faces into fans around their first corner. Creases along edges and
/// texture coordinates stay; holes are the triangles of holes.
void triangulate(Model& model);

/// Each face gives a quad per corner, around its centroid and the midpoints of its edges; positions and texture coordinates
/// are linear, creases are passed on to both halves of their edge.
void split_into_quads(Model& model);

}  // namespace limn::cli
