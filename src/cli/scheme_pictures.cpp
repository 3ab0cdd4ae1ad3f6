#include "cli/scheme_pictures.h"

#include "limn/file.h"

namespace limn::cli {

std::string check_even_look(const LookOptions& look, bool hardware) {
    const char* cause = " takes a scheme with patches: others are drawn evenly, by --rate";
    if (look.pixel_error) return std::string("--pixel-error") + cause;
    if (look.edge_pixels) return std::string("--edge-pixels") + cause;
    if (look.chord_error) return std::string("--chord-error") + cause;
    if (hardware) return std::string("--hardware-tessellation") + cause;
    for (const char* color : {"kind", "level", "rate"})
        if (look.color == color) return "--color " + look.color + cause;
    return {};
}

Result<viewer::Picture> draw_scene(const vk::Device& device, viewer::Renderer& renderer, const viewer::RenderMesh& mesh,
                                   const viewer::RenderLines& lines, const viewer::Renderer::View& view,
                                   viewer::PassTimer& timer) {
    renderer.set_scene(mesh, lines);
    auto commands = vk::Commands::begin(device);
    if (!commands) return commands.error();
    timer.record_begin(*commands);
    renderer.record(*commands, view, &timer);
    renderer.record_finish(*commands);
    renderer.record_readback(*commands);
    if (auto done = commands->submit_and_wait(); !done) return done.error();
    return renderer.read_picture();
}

Result<SchemePicture> draw_scheme(const SchemePictureInfo& info, const vk::Device& device,
                                  const vk::SchemeEvaluator& evaluator, viewer::Renderer& renderer,
                                  viewer::PassTimer& timer, Progress& progress) {
    const auto name_model = [&](Error error) {
        error.message = printable(info.path) + ": " + error.message;
        return error;
    };
    const auto level = steps_within_reason(info.model, info.scheme, static_cast<double>(info.rate));
    if (!level) return name_model(level.error());
    auto surface = build_model_surface(info.path, info.model, info.scheme, *level, progress);
    if (!surface) return surface.error();
    auto mesh = viewer::SchemeMesh::create(device, evaluator, *surface, info.model.model.positions);
    if (!mesh) return name_model(mesh.error());
    const auto bounds = mesh->evaluate();
    if (!bounds) return name_model(bounds.error());
    const viewer::CameraView camera = camera_view(info.look);
    const VkExtent2D extent = renderer.extent();
    const float aspect = static_cast<float>(extent.width) / static_cast<float>(extent.height);
    const viewer::Renderer::View view = {viewer::Camera::frame(info.frame != nullptr ? *info.frame : *bounds, camera, aspect), *bounds,
                                         settings_of(info.look, camera)};
    progress.show(std::string("drawing ") + info.scheme.title);
    auto picture = draw_scene(device, renderer, mesh->mesh(), mesh->control_lines(), view, timer);
    if (!picture) return picture.error();
    return SchemePicture{std::move(*picture), *bounds, mesh->vertex_count(), mesh->triangle_count()};
}

}  // namespace limn::cli
