// limn for C, on Vulkan: surfaces of all schemes, every frame. What limn_vulkan.h says holds here, too;
// limn/vulkan/scheme_evaluator.h says the rest.
#ifndef LIMN_C_LIMN_VULKAN_SCHEMES_H
#define LIMN_C_LIMN_VULKAN_SCHEMES_H

#include "limn/c/limn_schemes.h"
#include "limn/c/limn_vulkan.h"

#ifdef __cplusplus
extern "C" {
#endif

/// Where its triangles are drawn a barrier from copies to index reads is owed after the upload.
typedef struct limn_vk_scheme_surface limn_vk_scheme_surface;
limn_result limn_vk_scheme_surface_create(limn_vk_upload* upload, const limn_scheme_surface* from,
                                          limn_vk_scheme_surface** surface, limn_error* error) LIMN_C_NOEXCEPT;
void limn_vk_scheme_surface_destroy(limn_vk_scheme_surface* surface) LIMN_C_NOEXCEPT;
/// 3 vertex indices (uint32) for each triangle of limn_scheme_surface_info, to be bound as an index buffer. The
/// surface's own; null of null.
VkBuffer limn_vk_scheme_surface_get_triangles(const limn_vk_scheme_surface* surface) LIMN_C_NOEXCEPT;

typedef struct limn_vk_scheme_evaluator limn_vk_scheme_evaluator;
limn_result limn_vk_scheme_evaluator_create(const limn_vk_context* context, limn_vk_scheme_evaluator** evaluator,
                                            limn_error* error) LIMN_C_NOEXCEPT;
void limn_vk_scheme_evaluator_destroy(limn_vk_scheme_evaluator* evaluator) LIMN_C_NOEXCEPT;

/// limn::vk::SchemeEvaluationInfo: 3 floats a point.
typedef struct limn_vk_scheme_surface_info {
    uint32_t struct_size;
    uint32_t reserved;  ///< 0
    const limn_vk_scheme_surface* surface;
    limn_vk_points points;     ///< control points; LIMN_VK_SOURCE_USAGE
    limn_vk_points positions;  ///< of each vertex
    limn_vk_points normals;    ///< optional: a null buffer
} limn_vk_scheme_surface_info;

/// Barriers between its own dispatches are included. Recorded into one command buffer after the other, a barrier from
/// kernel writes in between: points of the levels are the evaluation's own.
limn_result limn_vk_scheme_evaluator_prepare(const limn_vk_scheme_evaluator* evaluator,
                                             const limn_vk_scheme_surface_info* info, limn_vk_evaluation** evaluation,
                                             limn_error* error) LIMN_C_NOEXCEPT;

#ifdef __cplusplus
}
#endif
#endif
