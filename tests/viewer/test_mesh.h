// Meshes that viewer tests draw: made on the host, closed by their indices, and broken on purpose.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "shapes/shapes.h"
#include "viewer/scene.h"

namespace limn::viewer::test {

struct HostMesh {
    std::vector<glm::vec3> positions, normals;
    std::vector<uint32_t> indices;

    size_t triangle_count() const { return indices.size() / 3; }
    uint32_t add_vertex(const glm::vec3& position, const glm::vec3& normal);
    void add_triangle(uint32_t a, uint32_t b, uint32_t c);
    Bounds bounds() const;
};

/// The limit positions and normals of the shape's vertices at a refinement level, each vertex once.
HostMesh refine_to_limit(const limn::test::TestMesh& shape, uint32_t level);
/// Of radius 1; `steps` bands.
HostMesh make_sphere(uint32_t steps);

/// The triangle that the eye looks at: the frontmost one on the line from `eye` to `target`.
size_t find_triangle(const HostMesh& mesh, const glm::vec3& eye, const glm::vec3& target);
/// Cuts a strip `width` thin off that triangle, along its first edge, as a triangle of its own: the last one.
void cut_sliver(HostMesh& mesh, size_t triangle, float width);
/// Moves its three edges inwards by `width`, away from its neighbours.
void pull_apart(HostMesh& mesh, size_t triangle, float width);

/// A HostMesh in device buffers.
struct DeviceMesh {
    vk::Buffer vertices, indices, indirect, places, triangle_faces, face_rates;
    RenderMesh mesh() const;
};
/// Every triangle is a ptex face of its own; kinds, levels and rates grow with its number. Fails the test and
/// returns an empty mesh on an error.
DeviceMesh upload(const vk::Device& device, const HostMesh& mesh);

}  // namespace limn::viewer::test
