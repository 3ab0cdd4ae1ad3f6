// What tests of the C interface on Vulkan share: objects that go by themselves, an allocator, a surface's tables.
#pragma once

#include "c/c_vulkan_scene.h"
#include "c/objects.h"
#include "limn/c/limn_vulkan.h"

namespace limn::vk::test {
using limn::test::Objects, limn::test::sized;

/// The caller's allocator: memory of kernels is not mapped, so that uploads are staged.
struct CountingAllocator {
    const Device& device;
    int live = 0, staged = 0;

    static VkResult allocate(void* user, const VkMemoryRequirements* needs, limn_vk_memory_use use,
                             limn_vk_memory_block* block) {
        auto& self = *static_cast<CountingAllocator*>(user);
        constexpr VkMemoryPropertyFlags kHost =
            VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
        VkMemoryAllocateInfo info = {};
        info.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
        info.allocationSize = needs->size;
        const auto fits = [&](uint32_t type) {
            return (needs->memoryTypeBits >> type & 1) != 0 &&
                   (self.device.memory_properties.memoryTypes[type].propertyFlags & kHost) == kHost;
        };
        while (!fits(info.memoryTypeIndex))
            if (++info.memoryTypeIndex == self.device.memory_properties.memoryTypeCount)
                return VK_ERROR_OUT_OF_DEVICE_MEMORY;
        const Functions& f = self.device.functions;
        const VkResult result = f.AllocateMemory(self.device.handle, &info, nullptr, &block->memory);
        if (result != VK_SUCCESS) return result;
        ++self.live;
        block->user = &self;
        if (use == LIMN_VK_MEMORY_DEVICE) return VK_SUCCESS;
        ++self.staged;
        return f.MapMemory(self.device.handle, block->memory, 0, VK_WHOLE_SIZE, 0, &block->mapped);
    }
    static void release(void* user, const limn_vk_memory_block* block) {
        auto& self = *static_cast<CountingAllocator*>(user);
        EXPECT_EQ(block->user, user);
        --self.live;
        self.device.functions.FreeMemory(self.device.handle, block->memory, nullptr);
    }
};

inline limn_vk_points points_of(const Buffer& buffer, VkDeviceSize offset = 0) {
    return {buffer.handle, offset, 0, 0, 0};
}

inline limn_control_mesh_description describe_in_c(const limn_face_varying_channel& channel) {
    auto d = sized<limn_control_mesh_description>();
    d.vertex_count = kVertexCount;
    d.channel_count = 1;
    d.channels = &channel;
    d.face_sizes = kSizes, d.face_count = 3;
    d.face_vertices = kFaces, d.face_vertex_count = 11;
    d.crease_vertices = kCrease, d.crease_vertex_count = 2;
    d.crease_sharpness = kSharpness, d.crease_sharpness_count = 1;
    return d;
}

/// `get`: of the device's functions; null: what the instance gives.
inline limn_vk_context* borrow_in_c(Objects& objects, const Device& device, CountingAllocator& allocator,
                                    PFN_vkGetDeviceProcAddr get = nullptr) {
    auto handles = sized<limn_vk_borrowed_handles>();
    handles.queue_family_index = device.queue_family_index;
    handles.instance = device.instance;
    handles.physical_device = device.physical_device;
    handles.device = device.handle;
    handles.get_instance_proc_addr = device.functions.GetInstanceProcAddr;
    handles.get_device_proc_addr = get;
    handles.allocator = {&allocator, CountingAllocator::allocate, CountingAllocator::release};
    return LIMN_NEW(objects, limn_vk_context, limn_vk_context_borrow, &handles);
}

/// All that is made once per topology.
struct CTables {
    limn_control_mesh* mesh;
    limn_patch_table *patches, *channel;
    limn_patch_trees *trees, *channel_trees, *sample_trees;
    limn_tessellation_table* topology;
    limn_grid_table* grid;
    limn_stencil_table* stencils;
    limn_refined_grid_table *refined, *refined_channel;
};
inline CTables build_in_c(Objects& objects) {
    CTables t = {};
    const limn_face_varying_channel channel = {kValues, 11, kValueCount, LIMN_FACE_VARYING_ALL};
    const limn_control_mesh_description description = describe_in_c(channel);
    t.mesh = LIMN_NEW(objects, limn_control_mesh, limn_control_mesh_create, &description);
    auto* one = LIMN_NEW(objects, limn_patch_table, limn_patch_table_create, t.mesh, nullptr, nullptr);
    auto* one_channel =
        LIMN_NEW(objects, limn_patch_table, limn_patch_table_create_channel, t.mesh, 0, nullptr, nullptr);
    const limn_patch_table* const twice[] = {one, one};
    const limn_patch_table* const channel_twice[] = {one_channel, one_channel};
    t.patches = LIMN_NEW(objects, limn_patch_table, limn_patch_table_create_merged, twice, 2);
    t.channel = LIMN_NEW(objects, limn_patch_table, limn_patch_table_create_merged, channel_twice, 2);
    auto topology = sized<limn_tessellation_table_options>();
    topology.channels = kChannels, topology.channel_count = 1;
    const limn_tessellation_table* const one_topology =
        LIMN_NEW(objects, limn_tessellation_table, limn_tessellation_table_create, t.mesh, &topology);
    const limn_tessellation_table* const topology_twice[] = {one_topology, one_topology};
    t.topology =
        LIMN_NEW(objects, limn_tessellation_table, limn_tessellation_table_create_merged, topology_twice, 2);
    t.trees = LIMN_NEW(objects, limn_patch_trees, limn_patch_trees_create, t.patches, nullptr);
    t.channel_trees = LIMN_NEW(objects, limn_patch_trees, limn_patch_trees_create, t.channel, nullptr);
    auto trees = sized<limn_patch_trees_options>();
    trees.max_rate = 16;
    trees.flags = LIMN_PATCH_TREES_RELATIVE;
    t.sample_trees = LIMN_NEW(objects, limn_patch_trees, limn_patch_trees_create, t.patches, &trees);
    auto grid = sized<limn_grid_table_options>();
    grid.rate = kGridRate;
    t.grid = LIMN_NEW(objects, limn_grid_table, limn_grid_table_create, t.patches, &grid);
    auto stencils = sized<limn_stencil_table_options>();
    stencils.level = kLevel;
    stencils.flags = LIMN_STENCIL_TABLE_LIMIT | LIMN_STENCIL_TABLE_TANGENTS;
    t.stencils = LIMN_NEW(objects, limn_stencil_table, limn_stencil_table_create, t.mesh, &stencils);
    auto refined = sized<limn_refined_grid_table_options>();
    refined.level = kLevel;
    t.refined = LIMN_NEW(objects, limn_refined_grid_table, limn_refined_grid_table_create, t.mesh, &refined);
    t.refined_channel =
        LIMN_NEW(objects, limn_refined_grid_table, limn_refined_grid_table_create_channel, t.mesh, 0, &refined);
    return t;
}

struct CDeviceTables {
    limn_vk_patch_table *patches, *channel;
    limn_vk_tessellation_table* topology;
    limn_vk_patch_trees* sample_trees;
    limn_vk_grid_table* grid;
    limn_vk_stencil_table* stencils;
    limn_vk_refined_grid *refined, *refined_channel;
};
inline CDeviceTables upload_in_c(Objects& objects, limn_vk_upload* upload, const CTables& t) {
    const limn_patch_trees* const channels[] = {t.channel_trees};
    return {LIMN_NEW(objects, limn_vk_patch_table, limn_vk_patch_table_create, upload, t.patches),
            LIMN_NEW(objects, limn_vk_patch_table, limn_vk_patch_table_create, upload, t.channel),
            LIMN_NEW(objects, limn_vk_tessellation_table, limn_vk_tessellation_table_create, upload,
                     t.topology, t.trees, channels, 1),
            LIMN_NEW(objects, limn_vk_patch_trees, limn_vk_patch_trees_create, upload, t.sample_trees),
            LIMN_NEW(objects, limn_vk_grid_table, limn_vk_grid_table_create, upload, t.grid),
            LIMN_NEW(objects, limn_vk_stencil_table, limn_vk_stencil_table_create, upload, t.stencils),
            LIMN_NEW(objects, limn_vk_refined_grid, limn_vk_refined_grid_create, upload, t.refined),
            LIMN_NEW(objects, limn_vk_refined_grid, limn_vk_refined_grid_create, upload, t.refined_channel)};
}

}  // namespace limn::vk::test
