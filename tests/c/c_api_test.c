/* The C interface as C99 sees it: a cube's limit surface on the CPU, and everything that has to be refused. */
#include <limn/c/limn.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "cube.h"

static int failures = 0;
#define CHECK(condition) \
    do { \
        if (!(condition)) { \
            printf("line %d: %s\n", __LINE__, #condition); \
            ++failures; \
        } \
    } while (0)
#define REFUSED(call) CHECK((call) == LIMN_ERROR_INVALID_ARGUMENT && error.code == LIMN_ERROR_INVALID_ARGUMENT)

static const double cube[24] = CUBE_POINTS;

static void test_descriptions(void) {
    struct {
        limn_control_mesh_description known;
        uint64_t later;
    } newer;
    limn_control_mesh_description d = describe_cube();
    limn_control_mesh* mesh = (limn_control_mesh*)&d;
    limn_error error;
    memset(&error, 0, sizeof error);
    REFUSED(limn_control_mesh_create(NULL, &mesh, &error));
    CHECK(mesh == NULL);
    REFUSED(limn_control_mesh_create(&d, NULL, &error));
    d.struct_size = 0;
    REFUSED(limn_control_mesh_create(&d, &mesh, &error));
    d = describe_cube();
    d.face_sizes = NULL;
    REFUSED(limn_control_mesh_create(&d, &mesh, &error));
    CHECK(strcmp(error.message, "face_sizes is null") == 0);
    d = describe_cube();
    d.scheme = 3;
    REFUSED(limn_control_mesh_create(&d, &mesh, &error));
    d = describe_cube();
    d.flags = 4;
    REFUSED(limn_control_mesh_create(&d, &mesh, &error));
    d = describe_cube();
    d.vertex_count = 7;
    CHECK(limn_control_mesh_create(&d, &mesh, &error) == LIMN_ERROR_INDEX_OUT_OF_RANGE && error.element == 2);
    CHECK(limn_control_mesh_create(&d, &mesh, NULL) == LIMN_ERROR_INDEX_OUT_OF_RANGE);
    newer.known = describe_cube();
    newer.known.struct_size = sizeof newer;
    newer.later = 1;
    CHECK(limn_control_mesh_create(&newer.known, &mesh, &error) == LIMN_ERROR_UNSUPPORTED && mesh == NULL);
    newer.later = 0;
    CHECK(limn_control_mesh_create(&newer.known, &mesh, &error) == LIMN_SUCCESS && mesh != NULL);
    limn_control_mesh_destroy(mesh);
}

static void test_surface(void) {
    const limn_control_mesh_description d = describe_cube();
    limn_control_mesh* mesh = NULL;
    limn_plan_cache* cache = NULL;
    limn_patch_table* table = NULL;
    limn_patch_table_info info;
    limn_patch_table_options options;
    limn_patch_evaluation evaluation;
    limn_patch_sample samples[2] = {{0, 0, 0.5, 0.5}, {6, 0, 0, 0}};
    limn_sample_status statuses[2];
    double points[3 * 256], results[18];
    limn_error error;
    CHECK(limn_control_mesh_create(&d, &mesh, &error) == LIMN_SUCCESS);
    CHECK(limn_plan_cache_create(&cache, &error) == LIMN_SUCCESS);
    REFUSED(limn_plan_cache_create(NULL, &error));
    REFUSED(limn_patch_table_create(NULL, NULL, NULL, &table, &error));
    REFUSED(limn_patch_table_create(mesh, NULL, NULL, NULL, &error));
    memset(&options, 0, sizeof options);
    REFUSED(limn_patch_table_create(mesh, &options, NULL, &table, &error));
    CHECK(limn_patch_table_create_channel(mesh, 0, NULL, NULL, &table, &error) == LIMN_ERROR_INDEX_OUT_OF_RANGE);
    options.struct_size = sizeof options;
    CHECK(limn_patch_table_create(mesh, &options, cache, &table, &error) == LIMN_SUCCESS);
    info.struct_size = 4;
    REFUSED(limn_patch_table_get_info(table, &info, &error));
    info.struct_size = sizeof info;
    REFUSED(limn_patch_table_get_info(NULL, &info, &error));
    REFUSED(limn_patch_table_get_info(table, NULL, &error));
    CHECK(limn_patch_table_get_info(table, &info, &error) == LIMN_SUCCESS);
    CHECK(info.control_count == 8 && info.ptex_face_count == 6 && info.surface_count == 24 && info.point_count <= 256);
    REFUSED(limn_patch_table_build_points(NULL, cube, 24, 3, points, 768, &error));
    REFUSED(limn_patch_table_build_points(table, NULL, 24, 3, points, 768, &error));
    REFUSED(limn_patch_table_build_points(table, cube, 23, 3, points, 768, &error));
    REFUSED(limn_patch_table_build_points(table, cube, 24, 0, points, 768, &error));
    REFUSED(limn_patch_table_build_points(table, cube, 24, 3, points, 3 * info.point_count - 1, &error));
    CHECK(limn_patch_table_build_points(table, cube, 24, 3, points, 768, &error) == LIMN_SUCCESS);
    memset(&evaluation, 0, sizeof evaluation);
    REFUSED(limn_patch_table_evaluate(table, NULL, &error));
    REFUSED(limn_patch_table_evaluate(table, &evaluation, &error));
    evaluation.struct_size = sizeof evaluation;
    evaluation.derivatives = LIMN_DERIVATIVES_FIRST;
    evaluation.samples = samples;
    evaluation.sample_count = 2;
    evaluation.points = points;
    evaluation.point_value_count = 768;
    evaluation.results = results;
    evaluation.result_value_count = 17;
    evaluation.statuses = statuses;
    evaluation.status_count = 2;
    REFUSED(limn_patch_table_evaluate(table, &evaluation, &error));
    evaluation.result_value_count = 18;
    REFUSED(limn_patch_table_evaluate(NULL, &evaluation, &error));
    CHECK(limn_patch_table_evaluate(table, &evaluation, &error) == LIMN_SUCCESS);
    CHECK(statuses[0] == LIMN_SAMPLE_VALID && statuses[1] == LIMN_SAMPLE_OUT_OF_RANGE);
    /* The middle of the side at z = 1: on the axis, its tangents in the plane. */
    CHECK(fabs(results[0]) < 1e-6 && fabs(results[1]) < 1e-6 && results[2] > 0.5 && results[2] < 1);
    CHECK(fabs(results[5]) < 1e-6 && results[3] > 0.5);
    limn_patch_table_destroy(table);
    limn_plan_cache_destroy(cache);
    limn_control_mesh_destroy(mesh);
    limn_patch_table_destroy(NULL);
    limn_plan_cache_destroy(NULL);
    limn_control_mesh_destroy(NULL);
}

/* A file holds what builders make. */
static void test_baked_file(void) {
    static const char path[] = "limn_c_test.limn";
    static const float positions[24] = {-1, -1, 1,  1, -1, 1,  -1, 1,  1,  1, 1,  1,
                                        -1, 1,  -1, 1, 1,  -1, -1, -1, -1, 1, -1, -1};
    limn_control_mesh_description d = describe_cube();
    limn_control_mesh* mesh;
    limn_patch_table* table;
    limn_baked_file* file = NULL;
    limn_patch_table_info built, baked;
    limn_tessellation_table_info topology;
    static double points[2][768]; /* what lies between control and level-1 points is not written */
    uint64_t count = 0;
    limn_error error;
    d.positions = positions;
    d.position_value_count = 24;
    CHECK(limn_baked_file_write(path, &d, NULL, &error) == LIMN_SUCCESS);
    REFUSED(limn_baked_file_write(NULL, &d, NULL, &error));
    REFUSED(limn_baked_file_write(path, NULL, NULL, &error));
    REFUSED(limn_baked_file_open(NULL, 0, &file, &error));
    REFUSED(limn_baked_file_open(path, 4, &file, &error));
    REFUSED(limn_baked_file_open(path, 0, NULL, &error));
    CHECK(limn_baked_file_open("no such file.limn", 0, &file, &error) == LIMN_ERROR_CANNOT_OPEN && file == NULL);
    CHECK(limn_baked_file_open(path, 0, &file, &error) == LIMN_SUCCESS);
    CHECK(limn_control_mesh_create(&d, &mesh, &error) == LIMN_SUCCESS);
    CHECK(limn_patch_table_create(mesh, NULL, NULL, &table, &error) == LIMN_SUCCESS);
    built.struct_size = baked.struct_size = sizeof built;
    topology.struct_size = sizeof topology;
    CHECK(limn_patch_table_get_info(table, &built, &error) == LIMN_SUCCESS);
    CHECK(limn_patch_table_get_info(limn_baked_file_get_patches(file), &baked, &error) == LIMN_SUCCESS);
    CHECK(memcmp(&built, &baked, sizeof built) == 0);
    CHECK(limn_tessellation_table_get_info(limn_baked_file_get_tessellation(file), &topology, &error) == LIMN_SUCCESS);
    CHECK(topology.face_count == 6 && topology.mesh_edge_count == 12 && topology.instance_count == 1);
    CHECK(limn_patch_table_build_points(table, cube, 24, 3, points[0], 3 * built.point_count, &error) == LIMN_SUCCESS);
    CHECK(limn_patch_table_build_points(limn_baked_file_get_patches(file), cube, 24, 3, points[1], 3 * built.point_count,
                                        &error) == LIMN_SUCCESS);
    CHECK(memcmp(points[0], points[1], 24 * built.point_count) == 0);
    CHECK(memcmp(limn_baked_file_get_positions(file, &count), positions, sizeof positions) == 0 && count == 24);
    CHECK(limn_baked_file_get_trees(file) != NULL && limn_baked_file_get_channel_trees(file, 0) == NULL);
    CHECK(limn_baked_file_get_patches(NULL) == NULL && limn_baked_file_get_positions(NULL, NULL) == NULL);
    limn_patch_table_destroy(table);
    limn_control_mesh_destroy(mesh);
    limn_baked_file_destroy(file);
    remove(path);
}

int main(void) {
    test_descriptions();
    test_surface();
    test_baked_file();
    return failures == 0 ? 0 : 1;
}
