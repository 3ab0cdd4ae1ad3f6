#include "mesh.h"

#include <cmath>

namespace {

constexpr uint32_t kSides = 10;

/// A ring of vertices; every other one is moved inwards by `flute`. Sharpness is that of the edges around it.
struct Ring {
    float radius, height, flute, sharpness;
};
constexpr Ring kProfile[] = {{0.70f, -1.30f, 0.00f, 10}, {0.72f, -1.18f, 0.00f, 3}, {0.30f, -0.85f, 0.00f, 0},
                             {1.00f, -0.35f, 0.36f, 0},  {1.15f, 0.25f, 0.40f, 0},  {0.45f, 0.75f, 0.08f, 0},
                             {0.78f, 1.20f, 0.10f, 2},   {0.62f, 1.22f, 0.10f, 10}, {0.30f, 0.70f, 0.05f, 0}};
constexpr uint32_t kRings = sizeof(kProfile) / sizeof(kProfile[0]);

}  // namespace

limn::ControlMeshDescription Mesh::description() const {
    return {.vertex_count = static_cast<uint32_t>(positions.size() / 3),
            .face_sizes = face_sizes,
            .face_vertices = face_vertices,
            .crease_vertices = crease_vertices,
            .crease_sharpness = crease_sharpness,
            .positions = positions};
}

Mesh make_vase() {
    Mesh mesh;
    const auto vertex = [](uint32_t ring, uint32_t side) { return ring * kSides + side % kSides; };
    for (uint32_t r = 0; r < kRings; ++r) {
        const Ring& ring = kProfile[r];
        for (uint32_t s = 0; s < kSides; ++s) {
            const float angle = 6.2831853f * static_cast<float>(s) / kSides;
            const float radius = ring.radius - (s % 2 == 1 ? ring.flute : 0);
            mesh.positions.insert(mesh.positions.end(),
                                  {radius * std::cos(angle), radius * std::sin(angle), ring.height});
            if (ring.sharpness > 0) {
                mesh.crease_vertices.insert(mesh.crease_vertices.end(), {vertex(r, s), vertex(r, s + 1)});
                mesh.crease_sharpness.push_back(ring.sharpness);
            }
            if (r + 1 == kRings) continue;
            mesh.face_sizes.push_back(4);
            mesh.face_vertices.insert(mesh.face_vertices.end(), {vertex(r, s), vertex(r, s + 1),
                                                                 vertex(r + 1, s + 1), vertex(r + 1, s)});
        }
    }
    for (const bool bottom : {true, false}) {
        mesh.face_sizes.push_back(kSides);
        for (uint32_t s = 0; s < kSides; ++s)
            mesh.face_vertices.push_back(bottom ? kSides - 1 - s : vertex(kRings - 1, s));
    }
    return mesh;
}

void animate(const Mesh& mesh, float time, float* points) {
    for (size_t i = 0; i < mesh.positions.size(); i += 3) {
        const float x = mesh.positions[i], y = mesh.positions[i + 1], z = mesh.positions[i + 2];
        const float twist = 0.5f * std::sin(1.7f * time) * (z + 1.3f), up = (z + 1.3f) / 2.6f;
        points[i] = x * std::cos(twist) - y * std::sin(twist) + 0.3f * std::sin(2.3f * time) * up * up;
        points[i + 1] = x * std::sin(twist) + y * std::cos(twist);
        points[i + 2] = z;
    }
}
