/* The C interface as C99 sees it: a cube's limit surface on the CPU, and everything that has to be refused. */
#include <limn/c/limn.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static int failures = 0;
#define CHECK(condition) \
    do { \
        if (!(condition)) { \
            printf("line %d: %s\n", __LINE__, #condition); \
            ++failures; \
        } \
    } while (0)
#define REFUSED(call) CHECK((call) == LIMN_ERROR_INVALID_ARGUMENT && error.code == LIMN_ERROR_INVALID_ARGUMENT)

static const uint32_t sizes[6] = {4, 4, 4, 4, 4, 4};
static const uint32_t faces[24] = {0, 1, 3, 2, 2, 3, 5, 4, 4, 5, 7, 6, 6, 7, 1, 0, 1, 7, 5, 3, 6, 0, 2, 4};
static const double cube[24] = {-1, -1, 1,  1, -1, 1,  -1, 1,  1,  1, 1,  1,
                                -1, 1,  -1, 1, 1,  -1, -1, -1, -1, 1, -1, -1};

static limn_control_mesh_description describe(void) {
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

static void test_descriptions(void) {
    struct {
        limn_control_mesh_description known;
        uint64_t later;
    } newer;
    limn_control_mesh_description d = describe();
    limn_control_mesh* mesh = (limn_control_mesh*)&d;
    limn_error error;
    memset(&error, 0, sizeof error);
    REFUSED(limn_control_mesh_create(NULL, &mesh, &error));
    CHECK(mesh == NULL);
    REFUSED(limn_control_mesh_create(&d, NULL, &error));
    d.struct_size = 0;
    REFUSED(limn_control_mesh_create(&d, &mesh, &error));
    d = describe();
    d.face_sizes = NULL;
    REFUSED(limn_control_mesh_create(&d, &mesh, &error));
    CHECK(strcmp(error.message, "face_sizes is null") == 0);
    d = describe();
    d.scheme = 3;
    REFUSED(limn_control_mesh_create(&d, &mesh, &error));
    d = describe();
    d.flags = 4;
    REFUSED(limn_control_mesh_create(&d, &mesh, &error));
    d = describe();
    d.vertex_count = 7;
    CHECK(limn_control_mesh_create(&d, &mesh, &error) == LIMN_ERROR_INDEX_OUT_OF_RANGE && error.element == 2);
    CHECK(limn_control_mesh_create(&d, &mesh, NULL) == LIMN_ERROR_INDEX_OUT_OF_RANGE);
    newer.known = describe();
    newer.known.struct_size = sizeof newer;
    newer.later = 1;
    CHECK(limn_control_mesh_create(&newer.known, &mesh, &error) == LIMN_ERROR_UNSUPPORTED && mesh == NULL);
    newer.later = 0;
    CHECK(limn_control_mesh_create(&newer.known, &mesh, &error) == LIMN_SUCCESS && mesh != NULL);
    limn_control_mesh_destroy(mesh);
}

static void test_surface(void) {
    const limn_control_mesh_description d = describe();
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

int main(void) {
    test_descriptions();
    test_surface();
    return failures == 0 ? 0 : 1;
}
