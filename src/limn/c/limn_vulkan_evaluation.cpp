// The C interface on Vulkan: points, stencils, grids, samples, curvatures.
#include "limn/c/vulkan_interop.h"

struct limn_vk_evaluator {
    limn::vk::Evaluator stencils;
    limn::vk::SurfaceEvaluator surfaces;
};
struct limn_vk_curvature_evaluator {
    limn::vk::CurvatureEvaluator value;
};

namespace limn::c {
namespace {

Result<limn_vk_evaluator> create_evaluator(const limn_vk_context* context) {
    if (context == nullptr) return bad_argument("context is null");
    auto stencils = vk::Evaluator::create(context->value->device());
    if (!stencils) return stencils.error();
    auto surfaces = vk::SurfaceEvaluator::create(context->value->device());
    if (!surfaces) return surfaces.error();
    return limn_vk_evaluator{std::move(*stencils), std::move(*surfaces)};
}

}  // namespace
}  // namespace limn::c

using namespace limn;
using namespace limn::c;

limn_result limn_vk_evaluator_create(const limn_vk_context* context, limn_vk_evaluator** evaluator,
                                     limn_error* error) noexcept {
    if (evaluator == nullptr) return report(bad_argument("evaluator is null"), error);
    *evaluator = nullptr;
    auto made = create_evaluator(context);
    if (!made) return report(made.error(), error);
    *evaluator = new (std::nothrow) limn_vk_evaluator(std::move(*made));
    return *evaluator != nullptr ? LIMN_SUCCESS : report(out_of_memory(), error);
}
void limn_vk_evaluator_destroy(limn_vk_evaluator* evaluator) noexcept {
    delete evaluator;
}

void limn_vk_evaluation_record(const limn_vk_evaluation* evaluation, VkCommandBuffer commands) noexcept {
    if (evaluation == nullptr || commands == VK_NULL_HANDLE) return;
    std::visit([&](const auto& e) { e.record(commands); }, evaluation->value);
}
void limn_vk_evaluation_destroy(limn_vk_evaluation* evaluation) noexcept {
    delete evaluation;
}

limn_result limn_vk_evaluator_prepare_points(const limn_vk_evaluator* evaluator,
                                             const limn_vk_points_info* info, limn_vk_evaluation** evaluation,
                                             limn_error* error) noexcept {
    return prepare(evaluator, info, evaluation, error, [&](const auto& i, uint32_t width, Reader& reader) {
        return evaluator->surfaces.prepare_points(
            {.patches = value_of(i.patches), .width = width, .points = read_points(reader, i.points, width)});
    });
}

limn_result limn_vk_evaluator_prepare_stencils(const limn_vk_evaluator* evaluator,
                                               const limn_vk_stencils_info* info,
                                               limn_vk_evaluation** evaluation, limn_error* error) noexcept {
    return prepare(evaluator, info, evaluation, error, [&](const auto& i, uint32_t width, Reader& reader) {
        return evaluator->stencils.prepare({.table = value_of(i.table),
                                            .width = width,
                                            .source = read_points(reader, i.source, width),
                                            .destination = read_points(reader, i.destination, width),
                                            .tangent1 = read_points(reader, i.tangent1, width),
                                            .tangent2 = read_points(reader, i.tangent2, width),
                                            .first_row = i.first_row,
                                            .row_count = i.row_count != 0 ? i.row_count : ~uint32_t{0}});
    });
}

limn_result limn_vk_evaluator_prepare_grid(const limn_vk_evaluator* evaluator, const limn_vk_grid_info* info,
                                           limn_vk_evaluation** evaluation, limn_error* error) noexcept {
    return prepare(evaluator, info, evaluation, error, [&](const auto& i, uint32_t width, Reader& reader) {
        if (i.reserved != 0) reader.fail("reserved is not 0");
        return evaluator->surfaces.prepare_grid({.patches = value_of(i.patches),
                                                 .grid = value_of(i.grid),
                                                 .width = width,
                                                 .points = read_points(reader, i.points, width),
                                                 .values = read_points(reader, i.values, width),
                                                 .normals = read_points(reader, i.normals, i.packed_normals != 0 ? 1 : 3),
                                                 .packed_normals = i.packed_normals != 0,
                                                 .du = read_points(reader, i.du, width),
                                                 .dv = read_points(reader, i.dv, width)});
    });
}

limn_result limn_vk_evaluator_prepare_local_points(const limn_vk_evaluator* evaluator,
                                                   const limn_vk_local_points_info* info,
                                                   limn_vk_evaluation** evaluation,
                                                   limn_error* error) noexcept {
    return prepare(evaluator, info, evaluation, error, [&](const auto& i, uint32_t width, Reader& reader) {
        return evaluator->surfaces.prepare_local_points({.patches = value_of(i.patches),
                                                         .trees = value_of(i.trees),
                                                         .width = width,
                                                         .points = read_points(reader, i.points, width),
                                                         .local_points = i.local_points});
    });
}

limn_result limn_vk_evaluator_prepare_samples(const limn_vk_evaluator* evaluator,
                                              const limn_vk_samples_info* info,
                                              limn_vk_evaluation** evaluation, limn_error* error) noexcept {
    constexpr Derivatives kDerivatives[] = {Derivatives::none, Derivatives::first, Derivatives::second};
    return prepare(evaluator, info, evaluation, error, [&](const auto& i, uint32_t width, Reader& reader) {
        const Derivatives derivatives = reader.choice(i.derivatives, kDerivatives, "number of derivatives");
        return evaluator->surfaces.prepare_samples(
            {.patches = value_of(i.patches),
             .derivatives = derivatives,
             .width = width,
             .points = read_points(reader, i.points, width),
             .samples = {i.samples, i.samples_offset_bytes, i.sample_count},
             .results = read_points(reader, i.results, value_count(derivatives) * width),
             .statuses = read_points(reader, i.statuses, 1),
             .trees = value_of(i.trees),
             .local_points = i.local_points});
    });
}

limn_result limn_vk_evaluator_prepare_locations(const limn_vk_evaluator* evaluator,
                                                const limn_vk_locations_info* info,
                                                limn_vk_evaluation** evaluation, limn_error* error) noexcept {
    return prepare(evaluator, info, evaluation, error, [&](const auto& i, uint32_t, Reader& reader) {
        return evaluator->surfaces.prepare_locations({.patches = value_of(i.patches),
                                                      .samples = {i.samples, i.samples_offset_bytes, i.sample_count},
                                                      .places = read_points(reader, i.places, 5),
                                                      .statuses = read_points(reader, i.statuses, 1)});
    });
}

limn_result limn_vk_evaluator_prepare_refined(const limn_vk_evaluator* evaluator, const limn_vk_refined_info* info,
                                              limn_vk_evaluation** evaluation, limn_error* error) noexcept {
    return prepare(evaluator, info, evaluation, error, [&](const auto& i, uint32_t width, Reader& reader) {
        return evaluator->surfaces.prepare_refined({.table = value_of(i.grid),
                                                    .width = width,
                                                    .source = read_points(reader, i.source, width),
                                                    .refined = read_points(reader, i.refined, width)});
    });
}

limn_result limn_vk_curvature_evaluator_create(const limn_vk_context* context, limn_vk_curvature_evaluator** evaluator,
                                               limn_error* error) noexcept {
    return create_on_device(context, evaluator, error, vk::CurvatureEvaluator::create);
}
void limn_vk_curvature_evaluator_destroy(limn_vk_curvature_evaluator* evaluator) noexcept {
    delete evaluator;
}

limn_result limn_vk_curvature_evaluator_prepare(const limn_vk_curvature_evaluator* evaluator,
                                                const limn_vk_curvature_info* info, limn_vk_evaluation** evaluation,
                                                limn_error* error) noexcept {
    return prepare(evaluator, info, evaluation, error, [&](const auto& i, uint32_t width, Reader& reader) {
        if (i.reserved != 0) reader.fail("reserved is not 0");
        return evaluator->value.prepare({.sample_count = i.sample_count,
                                         .width = width,
                                         .values = read_points(reader, i.values, 6 * width),
                                         .curvatures = read_points(reader, i.curvatures, shared::kCurvatureFloats),
                                         .quotients = read_points(reader, i.quotients, 18)});
    });
}
