/* The C interface as C99 sees it: a cube's limit surface on the CPU, and everything that has to be refused. */
#define _POSIX_C_SOURCE 200809L
#include <dirent.h>
#include <limn/c/limn_changes.h>
#include <limn/c/limn_schemes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

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
    d.scheme = 4;
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

/* How many files are in a folder; they go where `clear`. */
static int count_files(const char* folder, int clear) {
    DIR* open = opendir(folder);
    const struct dirent* entry;
    char path[512];
    int count = 0;
    while (open != NULL && (entry = readdir(open)) != NULL) {
        if (entry->d_name[0] == '.') continue;
        ++count;
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        if (clear) remove(path);
    }
    if (open != NULL) closedir(open);
    return count;
}

/* A folder of files by content: the second time there is nothing to bake. */
static void test_cache(void) {
    static const char folder[] = "limn_c_test_cache";
    limn_control_mesh_description d = describe_cube();
    limn_bake_options options;
    limn_baked_file* file[2] = {NULL, NULL};
    limn_tessellation_table_info topology;
    limn_error error;
    int i;
    mkdir(folder, 0777);
    count_files(folder, 1);
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.flags = LIMN_BAKE_NO_TREES;
    REFUSED(limn_baked_file_load_or_bake(NULL, &d, NULL, 0, &file[0], &error));
    REFUSED(limn_baked_file_load_or_bake(folder, NULL, NULL, 0, &file[0], &error));
    REFUSED(limn_baked_file_load_or_bake(folder, &d, NULL, 4, &file[0], &error));
    REFUSED(limn_baked_file_load_or_bake(folder, &d, NULL, 0, NULL, &error));
    CHECK(limn_baked_file_load_or_bake("no such folder", &d, NULL, 0, &file[0], &error) == LIMN_ERROR_CANNOT_OPEN);
    for (i = 0; i < 2; ++i) {
        CHECK(limn_baked_file_load_or_bake(folder, &d, &options, 0, &file[i], &error) == LIMN_SUCCESS);
        topology.struct_size = sizeof topology;
        CHECK(limn_tessellation_table_get_info(limn_baked_file_get_tessellation(file[i]), &topology, &error) == LIMN_SUCCESS);
        CHECK(topology.face_count == 6 && count_files(folder, 0) == 1);
    }
    options.max_rate = 8; /* which is of no account without trees: the same file */
    limn_baked_file_destroy(file[1]);
    CHECK(limn_baked_file_load_or_bake(folder, &d, &options, 0, &file[1], &error) == LIMN_SUCCESS);
    CHECK(count_files(folder, 0) == 1);
    for (i = 0; i < 2; ++i) limn_baked_file_destroy(file[i]);
    count_files(folder, 1);
    rmdir(folder);
}

/* What a build reads and makes. */
typedef struct job {
    limn_control_mesh* mesh;
    limn_patch_table* table;
    limn_result forced; /* in place of building */
} job;

static limn_result build_table(void* user, limn_build_control* control, limn_error* error) {
    job* j = user;
    limn_patch_table_options options;
    if (j->forced != LIMN_SUCCESS) return j->forced;
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.control = control;
    return limn_patch_table_create(j->mesh, &options, NULL, &j->table, error);
}

/* Jobs that wait to be run. */
typedef struct queue {
    void (*job)(void* data);
    void* data;
} queue;
static void enqueue(void* user, void (*run)(void* data), void* data) {
    queue* q = user;
    q->job = run;
    q->data = data;
}

static void test_async_builds(void) {
    const limn_control_mesh_description d = describe_cube();
    queue q = {NULL, NULL};
    limn_job_system jobs = {&q, enqueue};
    const limn_job_system bad = {&q, NULL};
    job j = {NULL, NULL, LIMN_SUCCESS};
    limn_async_build* build;
    limn_error error;
    CHECK(limn_control_mesh_create(&d, &j.mesh, &error) == LIMN_SUCCESS);
    REFUSED(limn_async_build_start(NULL, &j, NULL, &build, &error));
    REFUSED(limn_async_build_start(build_table, &j, &bad, &build, &error));
    REFUSED(limn_async_build_start(build_table, &j, NULL, NULL, &error));
    /* On a thread of its own. */
    CHECK(limn_async_build_start(build_table, &j, NULL, &build, &error) == LIMN_SUCCESS);
    CHECK(limn_async_build_wait(build, &error) == LIMN_SUCCESS && limn_async_build_wait(build, &error) == LIMN_SUCCESS);
    CHECK(limn_async_build_is_ready(build) == 1 && limn_async_build_get_progress(build) == 1 && j.table != NULL);
    limn_async_build_destroy(build);
    limn_patch_table_destroy(j.table);
    /* As a job of the caller's, which has not begun. */
    j.table = NULL;
    CHECK(limn_async_build_start(build_table, &j, &jobs, &build, &error) == LIMN_SUCCESS);
    CHECK(limn_async_build_is_ready(build) == 0 && j.table == NULL);
    q.job(q.data);
    CHECK(limn_async_build_is_ready(build) == 1 && j.table != NULL);
    limn_async_build_destroy(build);
    limn_patch_table_destroy(j.table);
    /* Cancelled before it began. */
    j.table = NULL;
    CHECK(limn_async_build_start(build_table, &j, &jobs, &build, &error) == LIMN_SUCCESS);
    limn_async_build_cancel(build);
    q.job(q.data);
    CHECK(limn_async_build_wait(build, &error) == LIMN_ERROR_CANCELLED && error.code == LIMN_ERROR_CANCELLED);
    CHECK(j.table == NULL);
    limn_async_build_destroy(build);
    /* Errors are those of the build. */
    limn_control_mesh_destroy(j.mesh);
    j.mesh = NULL;
    CHECK(limn_async_build_start(build_table, &j, NULL, &build, &error) == LIMN_SUCCESS);
    REFUSED(limn_async_build_wait(build, &error));
    CHECK(strcmp(error.message, "mesh is null") == 0);
    limn_async_build_destroy(build);
    j.forced = 99;
    CHECK(limn_async_build_start(build_table, &j, NULL, &build, &error) == LIMN_SUCCESS);
    REFUSED(limn_async_build_wait(build, &error));
    limn_async_build_destroy(build);
    REFUSED(limn_async_build_wait(NULL, &error));
    limn_async_build_cancel(NULL);
    limn_async_build_destroy(NULL);
    CHECK(limn_async_build_is_ready(NULL) == 0 && limn_async_build_get_progress(NULL) == 0);
}

/* An edge of the cube is creased, and two cubes are there where one was. */
static void test_changes(void) {
    static const uint32_t edge[2] = {0, 1};
    static const float sharpness = 10;
    const limn_control_mesh_description d = describe_cube();
    limn_control_mesh* mesh;
    limn_editable_mesh* edited;
    limn_crowd* crowd;
    limn_mesh_edit edit;
    limn_edit_work work;
    limn_crowd_info info;
    limn_crowd_instance instance;
    limn_crowd_mesh cubes[2];
    uint32_t numbers[2];
    limn_error error;
    CHECK(limn_control_mesh_create(&d, &mesh, &error) == LIMN_SUCCESS);
    CHECK(limn_editable_mesh_create(mesh, NULL, NULL, &edited, &error) == LIMN_SUCCESS);
    memset(&edit, 0, sizeof edit);
    edit.struct_size = sizeof edit;
    edit.crease_vertices = edge;
    edit.crease_vertex_count = 2;
    edit.crease_sharpness = &sharpness;
    edit.crease_sharpness_count = 1;
    work.struct_size = sizeof work;
    CHECK(limn_editable_mesh_edit(edited, &edit, &work, &error) == LIMN_SUCCESS);
    CHECK(work.face_count == 6 && work.tessellation == 1);
    CHECK(limn_crowd_create(NULL, &crowd, &error) == LIMN_SUCCESS);
    cubes[0].patches = cubes[1].patches = limn_editable_mesh_get_patches(edited);
    cubes[0].tessellation = cubes[1].tessellation = limn_editable_mesh_get_tessellation(edited);
    CHECK(limn_crowd_add(crowd, cubes, 2, numbers, &error) == LIMN_SUCCESS && numbers[0] == 0 && numbers[1] == 1);
    info.struct_size = sizeof info;
    CHECK(limn_crowd_get_info(crowd, &info, &error) == LIMN_SUCCESS && info.instance_count == 2 && info.layout == 1);
    instance.struct_size = sizeof instance;
    CHECK(limn_crowd_get_instance(crowd, 1, &instance, &error) == LIMN_SUCCESS);
    CHECK(instance.control_points.count == 8 && instance.ptex_faces.count == 6 && instance.mesh_edges.count == 12);
    CHECK(limn_crowd_remove(crowd, 0, &error) == LIMN_SUCCESS);
    CHECK(limn_crowd_get_instance(crowd, 0, &instance, &error) == LIMN_ERROR_INDEX_OUT_OF_RANGE && error.element == 0);
    limn_crowd_destroy(crowd);
    limn_editable_mesh_destroy(edited);
    limn_control_mesh_destroy(mesh);
}

/* Interpolation: the first eight vertices of Kobbelt's surface are the cube's. */
static void test_schemes(void) {
    static float points[24], positions[3 * 26];
    const limn_control_mesh_description d = describe_cube();
    limn_control_mesh* mesh;
    limn_scheme_surface* surface;
    limn_scheme_surface_options options;
    limn_scheme_surface_info info;
    limn_error error;
    int i;
    for (i = 0; i < 24; ++i) points[i] = (float)cube[i];
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.scheme = "kobbelt";
    options.level = 1;
    CHECK(limn_control_mesh_create(&d, &mesh, &error) == LIMN_SUCCESS);
    CHECK(limn_scheme_surface_create(mesh, &options, &surface, &error) == LIMN_SUCCESS);
    info.struct_size = sizeof info;
    CHECK(limn_scheme_surface_get_info(surface, &info, &error) == LIMN_SUCCESS);
    CHECK(info.vertex_count == 26 && info.face_count == 24 && info.triangle_count == 48 && info.edge_count == 12);
    CHECK(limn_scheme_surface_apply(surface, points, 24, positions, 78, NULL, 0, &error) == LIMN_SUCCESS);
    for (i = 0; i < 24; ++i) CHECK(fabs(positions[i] - points[i]) < 1e-6);
    limn_scheme_surface_destroy(surface);
    limn_control_mesh_destroy(mesh);
}

int main(void) {
    test_changes();
    test_schemes();
    test_descriptions();
    test_surface();
    test_baked_file();
    test_cache();
    test_async_builds();
    return failures == 0 ? 0 : 1;
}
