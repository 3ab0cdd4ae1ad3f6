// The model: a fluted vase of quads between two 10-gons, creased at foot and rim.
#pragma once

#include <limn/control_mesh.h>

#include <vector>

struct Mesh {
    std::vector<uint32_t> face_sizes, face_vertices, crease_vertices;
    std::vector<float> crease_sharpness;
    std::vector<float> positions;  ///< x, y, z of each vertex, at rest

    /// Refers to the vectors above.
    limn::ControlMeshDescription description() const;
};

Mesh make_vase();

/// The control points at `time`, in seconds: the vase twists and sways. Writes mesh.positions.size() floats.
void animate(const Mesh& mesh, float time, float* points);
