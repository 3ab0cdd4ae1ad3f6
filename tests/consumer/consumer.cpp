// The limit of a tetrahedron's vertices, with limn::limn only.
#include <cstdio>
#include <limn/stencil_table.h>

int main() {
    const uint32_t face_sizes[] = {3, 3, 3, 3};
    const uint32_t face_vertices[] = {0, 1, 2, 0, 3, 1, 1, 3, 2, 2, 3, 0};
    limn::ControlMeshDescription description;
    description.vertex_count = 4;
    description.face_sizes = face_sizes;
    description.face_vertices = face_vertices;
    const auto mesh = limn::ControlMesh::create(description);
    if (!mesh) return std::puts(mesh.error().message.c_str()), 1;
    const auto refinement = limn::build_refinement(*mesh, {.level = 2, .full_last_level = true});
    if (!refinement) return std::puts(refinement.error().message.c_str()), 1;
    const auto table = limn::build_limit_table<float>(*refinement, 2);
    if (!table) return std::puts(table.error().message.c_str()), 1;
    std::printf("%u limit points\n", table->row_count());
    return table->row_count() == 50 ? 0 : 1;
}
