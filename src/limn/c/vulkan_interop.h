// What implementations of the C interface on Vulkan share. Not part of the public interface.
#pragma once

#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "limn/c/interop.h"
#include "limn/c/limn_vulkan.h"
#include "limn/vulkan/curvature.h"
#include "limn/vulkan/scheme_evaluator.h"
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
    std::variant<limn::vk::StencilEvaluation, limn::vk::SurfaceEvaluation, limn::vk::SchemeEvaluation,
                 limn::vk::CurvatureEvaluation>
        value;
};

namespace limn::c {

/// `width`: the stride where none is given.
inline vk::PointBuffer read_points(Reader& reader, const limn_vk_points& p, uint32_t width) {
    if (p.reserved != 0) reader.fail("reserved is not 0");
    return {p.buffer, p.offset_bytes, p.first, p.stride != 0 ? p.stride : width};
}

/// `record(device, commands)` returns a table and the staging memory that it is read from.
template <class Object, class From, class Record>
limn_result upload_table(limn_vk_upload* upload, const From* from, Object** table, limn_error* error,
                         const Record& record) {
    return create(table, error, [&]() -> Result<decltype(Object::value)> {
        if (upload == nullptr) return bad_argument("upload is null");
        if (from == nullptr) return bad_argument("the table to upload is null");
        auto recorded = record(upload->device, upload->commands, from->value);
        if (!recorded) return recorded.error();
        if constexpr (std::is_same_v<decltype(recorded->staging), vk::Buffer>)
            upload->staging.push_back(std::move(recorded->staging));
        else
            for (vk::Buffer& buffer : recorded->staging) upload->staging.push_back(std::move(buffer));
        return std::move(recorded->table);
    });
}

/// An object that `make(device)` makes what it holds of.
template <class Object, class Make>
limn_result create_on_device(const limn_vk_context* context, Object** out, limn_error* error, const Make& make) {
    return create(out, error, [&]() -> Result<decltype(Object::value)> {
        if (context == nullptr) return bad_argument("context is null");
        return make(context->value->device());
    });
}

/// Reads the info, and has `make(info, width, reader)` prepare what it says.
template <class Evaluator, class Info, class Make>
limn_result prepare(const Evaluator* evaluator, const Info* given, limn_vk_evaluation** evaluation, limn_error* error,
                    const Make& make) {
    return create(evaluation, error, [&]() -> Result<decltype(limn_vk_evaluation::value)> {
        if (evaluator == nullptr) return bad_argument("evaluator is null");
        const auto info = read_struct(given);
        if (!info) return info.error();
        Reader reader;
        uint32_t width = 3;
        if constexpr (requires { info->width; })
            if (info->width != 0) width = info->width;
        auto made = make(*info, width, reader);
        if (!reader.state) return reader.state.error();
        if (!made) return made.error();
        return decltype(limn_vk_evaluation::value)(std::move(*made));
    });
}

}  // namespace limn::c
