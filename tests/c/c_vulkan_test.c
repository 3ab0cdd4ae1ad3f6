/* From a mesh to the command for vkCmdDrawIndexedIndirect, in C99: a cube, on limn's own device, validation layers on. */
#include <limn/c/limn_vulkan_changes.h>
#include <limn/c/limn_vulkan_schemes.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <vulkan/vulkan.h>

#include "cube.h"

#define CHECK(condition) \
    do { \
        if (!(condition)) { \
            printf("line %d: %s (%s)\n", __LINE__, #condition, error.message); \
            return 1; \
        } \
    } while (0)

enum { RATE = 6, TRIANGLES = 6 * 2 * RATE * RATE, VERTICES = 6 * RATE * RATE + 2, MAX_POINTS = 256, MAX_EDGES = 32 };

static const float cube[24] = CUBE_POINTS;
static const float height = 0.25f;

/* All that the device writes and reads here, in one host-visible buffer. */
typedef struct memory {
    float points[3 * MAX_POINTS];
    float positions[3 * VERTICES];
    float normals[3 * VERTICES];
    uint32_t indices[3 * TRIANGLES];
    VkDrawIndexedIndirectCommand command;
    limn_vk_tessellation_result result;
    float edge_rates[MAX_EDGES];
    float heights[3 * VERTICES];
} memory;

typedef struct gpu {
    limn_vk_context_info info;
    VkBuffer buffer;
    VkDeviceMemory device_memory;
    memory* mapped;
    VkCommandPool pool;
    VkCommandBuffer commands;
} gpu;

static int create_buffer(gpu* g) {
    VkBufferCreateInfo info = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
    VkMemoryAllocateInfo allocation = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
    VkMemoryRequirements needs;
    VkPhysicalDeviceMemoryProperties types;
    const VkMemoryPropertyFlags wanted = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    void* mapped;
    info.size = sizeof(memory);
    info.usage = LIMN_VK_SOURCE_USAGE;
    if (vkCreateBuffer(g->info.device, &info, NULL, &g->buffer) != VK_SUCCESS) return 0;
    vkGetBufferMemoryRequirements(g->info.device, g->buffer, &needs);
    vkGetPhysicalDeviceMemoryProperties(g->info.physical_device, &types);
    allocation.allocationSize = needs.size;
    while ((needs.memoryTypeBits >> allocation.memoryTypeIndex & 1) == 0 ||
           (types.memoryTypes[allocation.memoryTypeIndex].propertyFlags & wanted) != wanted)
        if (++allocation.memoryTypeIndex == types.memoryTypeCount) return 0;
    if (vkAllocateMemory(g->info.device, &allocation, NULL, &g->device_memory) != VK_SUCCESS ||
        vkBindBufferMemory(g->info.device, g->buffer, g->device_memory, 0) != VK_SUCCESS ||
        vkMapMemory(g->info.device, g->device_memory, 0, VK_WHOLE_SIZE, 0, &mapped) != VK_SUCCESS)
        return 0;
    g->mapped = mapped;
    return 1;
}

static int create_commands(gpu* g) {
    VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    VkCommandBufferAllocateInfo allocation = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
    pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
    pool.queueFamilyIndex = g->info.queue_family_index;
    if (vkCreateCommandPool(g->info.device, &pool, NULL, &g->pool) != VK_SUCCESS) return 0;
    allocation.commandPool = g->pool;
    allocation.commandBufferCount = 1;
    return vkAllocateCommandBuffers(g->info.device, &allocation, &g->commands) == VK_SUCCESS;
}

static void begin(gpu* g) {
    const VkCommandBufferBeginInfo info = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    vkBeginCommandBuffer(g->commands, &info);
}

static int submit_and_wait(gpu* g) {
    VkSubmitInfo info = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO};
    info.commandBufferCount = 1;
    info.pCommandBuffers = &g->commands;
    return vkEndCommandBuffer(g->commands) == VK_SUCCESS &&
           vkQueueSubmit(g->info.queue, 1, &info, VK_NULL_HANDLE) == VK_SUCCESS &&
           vkQueueWaitIdle(g->info.queue) == VK_SUCCESS;
}

static limn_vk_points points_at(const gpu* g, size_t offset) {
    limn_vk_points p;
    memset(&p, 0, sizeof p);
    p.buffer = g->buffer;
    p.offset_bytes = offset;
    return p;
}

static limn_vk_words words_at(const gpu* g, size_t offset) {
    limn_vk_words w;
    w.buffer = g->buffer;
    w.offset_bytes = offset;
    return w;
}

typedef struct tables {
    limn_control_mesh* mesh;
    limn_patch_table* patches;
    limn_patch_trees* trees;
    limn_tessellation_table* topology;
    limn_vk_patch_table* device_patches;
    limn_vk_tessellation_table* device_topology;
} tables;

/* Once per topology, on the CPU, by any thread. */
static int build_tables(tables* t) {
    limn_error error = {0};
    limn_patch_table_info info;
    limn_tessellation_table_info edges;
    const limn_control_mesh_description d = describe_cube();
    CHECK(limn_control_mesh_create(&d, &t->mesh, &error) == LIMN_SUCCESS);
    CHECK(limn_patch_table_create(t->mesh, NULL, NULL, &t->patches, &error) == LIMN_SUCCESS);
    CHECK(limn_patch_trees_create(t->patches, NULL, &t->trees, &error) == LIMN_SUCCESS);
    CHECK(limn_tessellation_table_create(t->mesh, NULL, &t->topology, &error) == LIMN_SUCCESS);
    info.struct_size = sizeof info;
    CHECK(limn_patch_table_get_info(t->patches, &info, &error) == LIMN_SUCCESS && info.point_count <= MAX_POINTS);
    edges.struct_size = sizeof edges;
    CHECK(limn_tessellation_table_get_info(t->topology, &edges, &error) == LIMN_SUCCESS && edges.rate_edge_count <= MAX_EDGES);
    return 0;
}

static int upload_tables(tables* t, const limn_vk_context* context, gpu* g) {
    limn_error error = {0};
    limn_vk_upload* upload;
    begin(g);
    CHECK(limn_vk_upload_create(context, g->commands, &upload, &error) == LIMN_SUCCESS);
    CHECK(limn_vk_patch_table_create(upload, t->patches, &t->device_patches, &error) == LIMN_SUCCESS);
    CHECK(limn_vk_tessellation_table_create(upload, t->topology, t->trees, NULL, 0, &t->device_topology, &error) ==
          LIMN_SUCCESS);
    CHECK(submit_and_wait(g));
    limn_vk_upload_destroy(upload);
    return 0;
}

/* `raised`: with a rate for each edge from a buffer, and moved along normals. */
static limn_vk_tessellation_info describe(const tables* t, const gpu* g, int raised) {
    limn_vk_tessellation_info info;
    memset(&info, 0, sizeof info);
    info.struct_size = sizeof info;
    info.patches = t->device_patches;
    info.table = t->device_topology;
    info.points = points_at(g, offsetof(memory, points));
    info.vertex_capacity = VERTICES;
    info.triangle_capacity = TRIANGLES;
    info.positions = points_at(g, offsetof(memory, positions));
    info.normals = points_at(g, offsetof(memory, normals));
    info.indices = words_at(g, offsetof(memory, indices));
    info.command = words_at(g, offsetof(memory, command));
    info.result = words_at(g, offsetof(memory, result));
    if (raised) {
        info.mode = LIMN_RATE_PER_EDGE;
        info.edge_rates = words_at(g, offsetof(memory, edge_rates));
        info.heights = points_at(g, offsetof(memory, heights));
    }
    return info;
}

/* Level-1 points, then the tessellation, with the barriers that the caller owes. */
static int draw(const tables* t, const limn_vk_context* context, gpu* g, int raised) {
    const limn_vk_stage_access writes = {LIMN_VK_KERNEL_STAGE, LIMN_VK_KERNEL_WRITES};
    const limn_vk_stage_access reads = {LIMN_VK_KERNEL_STAGE, LIMN_VK_KERNEL_READS};
    const limn_vk_stage_access host = {VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT};
    const limn_vk_tessellation_info info = describe(t, g, raised);
    limn_error error = {0};
    limn_vk_evaluator* evaluator;
    limn_vk_evaluation* evaluation;
    limn_vk_tessellator* tessellator;
    limn_vk_tessellation* tessellation;
    limn_vk_points_info points;
    limn_vk_rate_settings settings;
    memset(&points, 0, sizeof points);
    points.struct_size = sizeof points;
    points.patches = t->device_patches;
    points.points = info.points;
    memset(&settings, 0, sizeof settings);
    settings.struct_size = sizeof settings;
    settings.value = RATE;
    CHECK(limn_vk_evaluator_create(context, &evaluator, &error) == LIMN_SUCCESS);
    CHECK(limn_vk_tessellator_create(context, &tessellator, &error) == LIMN_SUCCESS);
    CHECK(limn_vk_evaluator_prepare_points(evaluator, &points, &evaluation, &error) == LIMN_SUCCESS);
    CHECK(limn_vk_tessellator_prepare(tessellator, &info, &tessellation, &error) == LIMN_SUCCESS);
    memcpy(g->mapped->points, cube, sizeof cube);
    begin(g);
    limn_vk_evaluation_record(evaluation, g->commands);
    limn_vk_record_barrier(context, g->commands, writes, reads);
    CHECK(limn_vk_tessellation_record(tessellation, g->commands, &settings, &error) == LIMN_SUCCESS);
    if (raised)
        CHECK(limn_vk_tessellation_record_passes(tessellation, g->commands, LIMN_VK_PASS_DISPLACEMENT, NULL, &error) ==
              LIMN_SUCCESS);
    limn_vk_record_barrier(context, g->commands, writes, host);
    CHECK(submit_and_wait(g));
    limn_vk_tessellation_destroy(tessellation);
    limn_vk_evaluation_destroy(evaluation);
    limn_vk_tessellator_destroy(tessellator);
    limn_vk_evaluator_destroy(evaluator);
    return 0;
}

/* Two frames: as it is, and raised by a height that is everywhere the same. */
static int draw_both(const tables* t, const limn_vk_context* context, gpu* g) {
    static float positions[3 * VERTICES], normals[3 * VERTICES];
    static uint32_t indices[3 * TRIANGLES];
    const limn_error error = {0};
    int i;
    if (draw(t, context, g, 0)) return 1;
    memcpy(positions, g->mapped->positions, sizeof positions);
    memcpy(normals, g->mapped->normals, sizeof normals);
    memcpy(indices, g->mapped->indices, sizeof indices);
    for (i = 0; i < MAX_EDGES; ++i) g->mapped->edge_rates[i] = RATE;
    for (i = 0; i < 3 * VERTICES; ++i) g->mapped->heights[i] = i % 3 == 0 ? height : 0;
    if (draw(t, context, g, 1)) return 1;
    CHECK(memcmp(indices, g->mapped->indices, sizeof indices) == 0);
    for (i = 0; i < 3 * VERTICES; ++i)
        CHECK(fabs(g->mapped->positions[i] - (positions[i] + height * normals[i])) < 1e-5);
    return 0;
}

static double dot(const float* a, const float* b) {
    return (double)a[0] * b[0] + (double)a[1] * b[1] + (double)a[2] * b[2];
}

/* Closed, of one piece with the sphere, facing outwards: six times the volume is positive, and each edge is there once in each
   direction. */
static int check_surface(const memory* m) {
    static unsigned char edges[VERTICES][VERTICES];
    const limn_error error = {0};
    double volume = 0;
    int i, k;
    CHECK(m->result.status == LIMN_TESSELLATION_COMPLETE && m->result.rate_scale == 1);
    CHECK(m->result.vertex_count == VERTICES && m->result.triangle_count == TRIANGLES);
    CHECK(m->command.indexCount == 3 * TRIANGLES && m->command.instanceCount == 1 && m->command.firstIndex == 0);
    for (i = 0; i < VERTICES; ++i) {
        CHECK(fabs(dot(m->normals + 3 * i, m->normals + 3 * i) - 1) < 1e-5);
        CHECK(dot(m->normals + 3 * i, m->positions + 3 * i) > 0.3);
    }
    for (i = 0; i < TRIANGLES; ++i) {
        const uint32_t* t = m->indices + 3 * i;
        const float *a, *b, *c;
        for (k = 0; k < 3; ++k) {
            CHECK(t[k] < VERTICES);
            ++edges[t[k]][t[(k + 1) % 3]];
        }
        a = m->positions + 3 * t[0], b = m->positions + 3 * t[1], c = m->positions + 3 * t[2];
        volume += (double)a[0] * (b[1] * c[2] - b[2] * c[1]) + (double)a[1] * (b[2] * c[0] - b[0] * c[2]) +
                  (double)a[2] * (b[0] * c[1] - b[1] * c[0]);
    }
    CHECK(volume > 6 && volume < 48);
    for (i = 0; i < VERTICES; ++i)
        for (k = 0; k < VERTICES; ++k) CHECK(edges[i][k] <= 1 && edges[i][k] == edges[k][i]);
    return 0;
}

int main(void) {
    limn_error error = {0};
    limn_vk_context* context;
    limn_vk_context_options options;
    tables t;
    gpu g;
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.flags = LIMN_VK_CONTEXT_VALIDATION;
    memset(&g, 0, sizeof g);
    CHECK(limn_vk_context_create(&options, &context, &error) == LIMN_SUCCESS);
    g.info.struct_size = sizeof g.info;
    CHECK(limn_vk_context_get_info(context, &g.info, &error) == LIMN_SUCCESS);
    printf("%s\n", g.info.device_name);
    CHECK(create_buffer(&g) && create_commands(&g));
    if (build_tables(&t) || upload_tables(&t, context, &g) || draw_both(&t, context, &g) || check_surface(g.mapped)) return 1;
    limn_vk_tessellation_table_destroy(t.device_topology);
    limn_vk_patch_table_destroy(t.device_patches);
    limn_tessellation_table_destroy(t.topology);
    limn_patch_trees_destroy(t.trees);
    limn_patch_table_destroy(t.patches);
    limn_control_mesh_destroy(t.mesh);
    vkDestroyCommandPool(g.info.device, g.pool, NULL);
    vkDestroyBuffer(g.info.device, g.buffer, NULL);
    vkFreeMemory(g.info.device, g.device_memory, NULL);
    CHECK(limn_vk_context_get_info(context, &g.info, &error) == LIMN_SUCCESS);
    CHECK(g.info.validation_message_count == 0);
    limn_vk_context_destroy(context);
    return 0;
}
