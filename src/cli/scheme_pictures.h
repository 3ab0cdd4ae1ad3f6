// Pictures of models under schemes without patches.
#pragma once

#include <string>

#include "cli/picture_options.h"
#include "cli/scheme_model.h"
#include "viewer/renderer.h"
#include "viewer/scheme_mesh.h"

namespace limn::cli {

/// Segments of an edge where nothing is said.
inline constexpr float kEvenRate = 16;

/// What of the options takes a scheme with patches; empty where nothing does.
std::string check_even_look(const LookOptions& look, bool hardware);

/// One picture of a scene whose buffers are written. Errors: vulkan_failure.
Result<viewer::Picture> draw_scene(const vk::Device& device, viewer::Renderer& renderer, const viewer::RenderMesh& mesh,
                                   const viewer::RenderLines& lines, const viewer::Renderer::View& view,
                                   viewer::PassTimer& timer);

struct SchemePictureInfo {
    const std::string& path;
    const LoadedModel& model;
    const SubdivisionScheme& scheme;
    float rate;
    const LookOptions& look;
    const viewer::Bounds* frame = nullptr;  ///< what the camera sees all of; null: the surface
};
struct SchemePicture {
    viewer::Picture picture;
    viewer::Bounds bounds = {};
    uint32_t vertex_count = 0, triangle_count = 0;
};
/// Of the renderer's size. Errors name the model.
Result<SchemePicture> draw_scheme(const SchemePictureInfo& info, const vk::Device& device,
                                  const vk::SchemeEvaluator& evaluator, viewer::Renderer& renderer,
                                  viewer::PassTimer& timer, Progress& progress);

}  // namespace limn::cli
