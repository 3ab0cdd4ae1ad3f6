/* A cube, as C describes it. */
#ifndef LIMN_TESTS_CUBE_H
#define LIMN_TESTS_CUBE_H
#include <limn/c/limn.h>
#include <string.h>

static const uint32_t sizes[6] = {4, 4, 4, 4, 4, 4};
static const uint32_t faces[24] = {0, 1, 3, 2, 2, 3, 5, 4, 4, 5, 7, 6, 6, 7, 1, 0, 1, 7, 5, 3, 6, 0, 2, 4};
/* In float or double. */
#define CUBE_POINTS \
    {-1, -1, 1, 1, -1, 1, -1, 1, 1, 1, 1, 1, -1, 1, -1, 1, 1, -1, -1, -1, -1, 1, -1, -1}

static limn_control_mesh_description describe_cube(void) {
    limn_control_mesh_description d;
    memset(&d, 0, sizeof d);
    d.struct_size = sizeof d;
    d.vertex_count = 8;
    d.face_sizes = sizes;
    d.face_count = 6;
    d.face_vertices = faces;
    d.face_vertex_count = 24;
    return d;
}
#endif
