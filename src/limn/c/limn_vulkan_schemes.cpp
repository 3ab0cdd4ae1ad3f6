// The C interface on Vulkan: surfaces of all schemes.
#include "limn/c/limn_vulkan_schemes.h"

#include "limn/c/scheme_interop.h"
#include "limn/c/vulkan_interop.h"

struct limn_vk_scheme_surface {
    limn::vk::DeviceSchemeSurface value;
};
struct limn_vk_scheme_evaluator {
    limn::vk::SchemeEvaluator value;
};

using namespace limn;
using namespace limn::c;

limn_result limn_vk_scheme_surface_create(limn_vk_upload* upload, const limn_scheme_surface* from,
                                          limn_vk_scheme_surface** surface, limn_error* error) noexcept {
    return upload_table(upload, from, surface, error, vk::record_scheme_surface_upload);
}
void limn_vk_scheme_surface_destroy(limn_vk_scheme_surface* surface) noexcept {
    delete surface;
}
VkBuffer limn_vk_scheme_surface_get_triangles(const limn_vk_scheme_surface* surface) noexcept {
    return surface != nullptr ? surface->value.triangles.handle : VK_NULL_HANDLE;
}

limn_result limn_vk_scheme_evaluator_create(const limn_vk_context* context, limn_vk_scheme_evaluator** evaluator,
                                            limn_error* error) noexcept {
    return create_on_device(context, evaluator, error, vk::SchemeEvaluator::create);
}
void limn_vk_scheme_evaluator_destroy(limn_vk_scheme_evaluator* evaluator) noexcept {
    delete evaluator;
}

limn_result limn_vk_scheme_evaluator_prepare(const limn_vk_scheme_evaluator* evaluator,
                                             const limn_vk_scheme_surface_info* info, limn_vk_evaluation** evaluation,
                                             limn_error* error) noexcept {
    return prepare(evaluator, info, evaluation, error, [&](const auto& i, uint32_t width, Reader& reader) {
        if (i.reserved != 0) reader.fail("reserved is not 0");
        return evaluator->value.prepare({.surface = value_of(i.surface),
                                         .points = read_points(reader, i.points, width),
                                         .positions = read_points(reader, i.positions, width),
                                         .normals = read_points(reader, i.normals, width)});
    });
}
