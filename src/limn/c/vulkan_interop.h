// What implementations of the C interface on Vulkan share. Not part of the public interface.
#pragma once

#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "limn/c/interop.h"
#include "limn/c/limn_vulkan.h"
#include "limn/vulkan/surface_evaluator.h"
#include "limn/vulkan/tessellator.h"

struct limn_vk_context {
    limn_vk_allocator allocator;  ///< what the device's allocator refers to
    std::optional<limn::vk::Context> value;
};
struct limn_vk_upload {
    const limn::vk::Device& device;
    VkCommandBuffer commands;
    std::vector<limn::vk::Buffer> staging;
};
struct limn_vk_patch_table {
    limn::vk::DevicePatchTable value;
};
struct limn_vk_patch_trees {
    limn::vk::DevicePatchTrees value;
};
struct limn_vk_tessellation_table {
    limn::vk::DeviceTessellationTable value;
};
struct limn_vk_grid_table {
    limn::vk::DeviceGridTable value;
};
struct limn_vk_stencil_table {
    limn::vk::DeviceStencilTable value;
};
struct limn_vk_refined_grid {
    limn::vk::DeviceRefinedGrid value;
};
struct limn_vk_tessellation {
    limn::vk::Tessellation value;
    limn::RateMode mode;
    limn::TessellationSpacing spacing;
    const limn::vk::Device& device;
};
struct limn_vk_evaluation {
    std::variant<limn::vk::StencilEvaluation, limn::vk::SurfaceEvaluation> value;
};

namespace limn::c {

/// What the object holds, or null where there is none.
template <class Object>
auto value_of(const Object* object) -> decltype(&object->value) {
    return object != nullptr ? &object->value : nullptr;
}

/// `width`: the stride where none is given.
inline vk::PointBuffer read_points(Reader& reader, const limn_vk_points& p, uint32_t width) {
    if (p.reserved != 0) reader.fail("reserved is not 0");
    return {p.buffer, p.offset_bytes, p.first, p.stride != 0 ? p.stride : width};
}

}  // namespace limn::c
