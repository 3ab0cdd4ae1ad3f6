#include "viewer/view.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "viewer/deformer.h"
#include "viewer/panel.h"
#include "viewer/renderer.h"
#include "viewer/scheme_mesh.h"
#include "viewer/surface_mesh.h"

namespace limn::viewer {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kMostEvenTriangles = 4e6;

/// A CameraView that the mouse moves.
struct Orbit {
    CameraView view;
    glm::vec3 pan = glm::vec3(0);  ///< of the target, from the middle of the surface

    /// Distances become explicit: `camera` is what the view has been framed to.
    void follow(const Panel::Drag& drag, const Camera& camera, const Bounds& bounds, float height) {
        view.azimuth -= 0.3f * drag.orbit[0];
        view.elevation = std::clamp(view.elevation + 0.3f * drag.orbit[1], -89.0f, 89.0f);
        const glm::vec3 back = camera.eye - camera.target;
        const float distance = glm::length(back);
        if (drag.zoom != 0)
            view.distance =
                std::clamp(distance / bounds.radius() * std::pow(0.9f, drag.zoom), 0.05f, 1000.0f);
        const glm::vec3 right = glm::normalize(glm::cross(glm::vec3(0, 1, 0), back));
        const glm::vec3 up = glm::normalize(glm::cross(back, right));
        const float pixel = 2 * distance * std::tan(0.5f * glm::radians(camera.fov)) / height;
        pan += pixel * (up * drag.pan[1] - right * drag.pan[0]);
    }

    Camera camera(const Bounds& bounds, float aspect) const {
        Camera out = Camera::frame(bounds, view, aspect);
        out.target += pan;
        out.eye += pan;
        return out;
    }
};

class Session {
  public:
    Session(const ViewOptions& options, const GraphicsDevice& graphics, const Window& window)
        : options_(options), device_(graphics.device()), window_(window), timer_(graphics.device()) {}

    Result<void> start();
    /// One frame. False when the window has been closed.
    Result<bool> step(uint32_t frame);
    Picture picture() const { return renderer_->read_picture(); }

  private:
    Result<void> rebuild();
    Result<void> rebuild_surface(const BakedMesh& model);
    Result<void> rebuild_evenly(const ViewModel& model);
    void adopt(const Bounds& bounds);
    RateSettings rates() const;
    Result<void> follow_rates();
    Result<void> record_surface(VkCommandBuffer commands);
    void try_rebuild();
    Result<bool> follow_size();
    void choose(uint32_t frame);
    Result<void> record(VkCommandBuffer commands, bool read_back);
    Result<void> draw(bool read_back);
    VkExtent2D extent() const { return renderer_->extent(); }

    const ViewOptions& options_;
    const vk::Device& device_;
    const Window& window_;
    PassTimer timer_;
    std::optional<Renderer> renderer_;
    std::optional<Swapchain> swapchain_;
    std::optional<Panel> panel_;
    std::optional<Deformer> deformer_;
    std::optional<SurfaceKernels> kernels_;
    std::optional<vk::SchemeEvaluator> evaluator_;
    // One of the two.
    std::optional<SurfaceMesh> surface_;
    std::optional<SchemeMesh> even_;
    uint32_t even_rate_ = 0;  ///< what even_ was made for
    vk::TessellationResult triangles_ = {};
    std::optional<RateSettings> tessellated_;  ///< what the triangles there were made for
    Bounds bounds_;                            ///< at rest
    uint32_t max_rate_ = 0;                    ///< that tables are made for
    Bounds reach_;                             ///< of the surface as it moves
    PanelState state_;
    PanelState built_;  ///< what surface_ was made for
    PanelState drawn_;  ///< what shadows were drawn for
    Orbit orbit_;
    Camera camera_;
    std::string message_;
    bool surface_changed_ = true;  ///< and its shadows
    bool retessellated_ = false;   ///< in this frame
    float seconds_ = 0;
    Clock::time_point last_frame_ = Clock::now();
    double frame_milliseconds_ = 0;
};

RateMode mode_of(RateChoice choice) {
    constexpr RateMode kModes[] = {RateMode::uniform, RateMode::pixel_error, RateMode::screen_length,
                                   RateMode::chord_error};
    return kModes[static_cast<int>(choice)];
}

/// Triangles made for `a` are right for `b`.
bool same_rates(const RateSettings& a, const RateSettings& b) {
    if (a.mode != b.mode || a.value != b.value) return false;
    if (a.mode == RateMode::uniform || a.mode == RateMode::chord_error) return true;
    return std::memcmp(&a.camera, &b.camera, sizeof a.camera) == 0;
}

Result<void> Session::start() {
    auto renderer = Renderer::create(device_);
    if (!renderer) return renderer.error();
    renderer_.emplace(std::move(*renderer));
    if (auto sized = renderer_->resize(window_.framebuffer_size()); !sized) return sized.error();
    auto swapchain = Swapchain::create(device_, device_.instance, window_);
    if (!swapchain) return swapchain.error();
    swapchain_.emplace(std::move(*swapchain));
    auto deformer = Deformer::create(device_);
    if (!deformer) return deformer.error();
    deformer_.emplace(std::move(*deformer));
    auto panel = Panel::create(device_, window_);
    if (!panel) return panel.error();
    panel_.emplace(std::move(*panel));
    auto kernels = SurfaceKernels::create(device_);
    if (!kernels) return kernels.error();
    kernels_.emplace(std::move(*kernels));
    auto evaluator = vk::SchemeEvaluator::create(device_);
    if (!evaluator) return evaluator.error();
    evaluator_.emplace(std::move(*evaluator));
    orbit_.view = options_.camera;
    state_.settings = options_.settings;
    state_.scheme = options_.scheme;
    for (int choice = 0; choice < 4; ++choice)
        if (mode_of(static_cast<RateChoice>(choice)) == options_.rates.mode) {
            state_.rate_choice = static_cast<RateChoice>(choice);
            state_.rate_values[choice] = options_.rates.value;
        }
    state_.color = static_cast<int>(options_.settings.color);
    state_.animate = options_.animate;
    // A software device has better things to do.
    const bool slow = device_.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
    state_.sky_directions = slow ? 32 : 64;
    return rebuild();
}

/// Tables and buffers for what is chosen now. On an error what was there stays.
Result<void> Session::rebuild() {
    const auto model = options_.load(options_.schemes[static_cast<size_t>(state_.scheme)]);
    if (!model) return model.error();
    return model->tables != nullptr ? rebuild_surface(*model->tables) : rebuild_evenly(*model);
}

Result<void> Session::rebuild_surface(const BakedMesh& model) {
    auto surface = SurfaceMesh::create(device_, *kernels_, model, {});
    if (!surface) return surface.error();
    const RateSettings few = {.value = std::min(4.0f, static_cast<float>(model.trees.max_rate)),
                              .max_rate = model.trees.max_rate};
    if (const auto done = surface->tessellate(few); !done) return done.error();
    const auto bounds = surface->measure();
    if (!bounds) return bounds.error();
    const std::span<const float> points(model.positions.data(), model.positions.size());
    if (auto set = deformer_->set_points(points, surface->control_points()); !set) return set.error();
    renderer_->set_scene(surface->mesh(), surface->control_lines());
    surface_.emplace(std::move(*surface));
    even_.reset();
    max_rate_ = few.max_rate;
    adopt(*bounds);
    return {};
}

/// As many steps as the uniform rate asks for, and a few million triangles allow.
Result<void> Session::rebuild_evenly(const ViewModel& model) {
    const auto rate = static_cast<uint32_t>(std::lround(state_.rate_values[0]));
    const double growth = std::pow(segments_per_step(*model.scheme), 2);
    const double corners = std::max(1.0, static_cast<double>(model.mesh.face_vertices.size()));
    const auto most = static_cast<uint32_t>(std::log(std::max(1.0, kMostEvenTriangles / (2 * corners))) / std::log(growth));
    const uint32_t level = std::min(steps_for_rate(*model.scheme, rate), most);
    const auto tables = build_scheme_surface(model.mesh, *model.scheme, {level}, model.corner_values);
    if (!tables) return tables.error();
    auto even = SchemeMesh::create(device_, *evaluator_, *tables, model.positions);
    if (!even) return even.error();
    const auto bounds = even->evaluate();
    if (!bounds) return bounds.error();
    if (auto set = deformer_->set_points(model.positions, even->control_points()); !set) return set.error();
    renderer_->set_scene(even->mesh(), even->control_lines());
    even_.emplace(std::move(*even));
    surface_.reset();
    state_.rate_choice = RateChoice::uniform;
    even_rate_ = rate;
    triangles_ = {};
    triangles_.vertex_count = even_->vertex_count();
    triangles_.triangle_count = even_->triangle_count();
    adopt(*bounds);
    return {};
}

/// What is there now is what is drawn.
void Session::adopt(const Bounds& bounds) {
    bounds_ = bounds;
    tessellated_.reset();
    built_ = state_;
    surface_changed_ = true;
}

void Session::try_rebuild() {
    message_.clear();
    if (auto built = rebuild(); !built) {
        message_ = built.error().message;
        state_.scheme = built_.scheme;
        even_rate_ = static_cast<uint32_t>(std::lround(state_.rate_values[0]));  // no second try
    }
}

/// False while there is nothing to draw to.
Result<bool> Session::follow_size() {
    const VkExtent2D size = window_.framebuffer_size();
    if (size.width == 0 || size.height == 0) return false;
    if (size.width == extent().width && size.height == extent().height) return true;
    if (auto sized = swapchain_->resize(size); !sized) return sized.error();
    if (auto sized = renderer_->resize(size); !sized) return sized.error();
    return true;
}

/// What the user wants, and what follows from it.
void Session::choose(uint32_t frame) {
    const std::string* message = &message_;
    panel_->build(state_,
                  {.model = options_.title.c_str(),
                   .device = device_.name(),
                   .vertices = triangles_.vertex_count,
                   .triangles = triangles_.triangle_count,
                   .frame_milliseconds = frame_milliseconds_,
                   .passes = timer_.read(),
                   .message = message},
                  options_.schemes, options_.colors);
    if (state_.frame_all) orbit_ = {{.azimuth = orbit_.view.azimuth, .elevation = orbit_.view.elevation}};
    if (even_) {
        state_.rate_choice = RateChoice::uniform;
        if (needs_places(state_.settings.color) || state_.settings.color == ColorMode::rate)
            state_.settings.color = ColorMode::clay;  // there are no patches
    }
    const bool finer = even_ && std::lround(state_.rate_values[0]) != static_cast<long>(even_rate_);
    if (state_.scheme != built_.scheme || finer) try_rebuild();
    const auto now = Clock::now();
    const double passed = std::chrono::duration<double>(now - last_frame_).count();
    last_frame_ = now;
    frame_milliseconds_ = 1000 * passed;
    const bool counted = options_.frame_count != 0;
    if (state_.animate) seconds_ += counted ? (frame != 0 ? 1 / 60.0f : 0) : static_cast<float>(passed);
    const bool moving = state_.animate || state_.amplitude != drawn_.amplitude;
    surface_changed_ = surface_changed_ || moving || state_.sky_directions != drawn_.sky_directions;
    // A twist stays within a turned box.
    reach_ = bounds_;
    const float room = state_.animate || seconds_ > 0 ? 0.12f * bounds_.radius() : 0;
    reach_.low -= glm::vec3(room, 0, room);
    reach_.high += glm::vec3(room, 0, room);
    const float aspect = static_cast<float>(extent().width) / static_cast<float>(extent().height);
    camera_ = orbit_.camera(bounds_, aspect);
    orbit_.follow(panel_->drag(), camera_, bounds_, static_cast<float>(extent().height));
    camera_ = orbit_.camera(bounds_, aspect);
}

/// As the panel has them, for what the camera sees.
RateSettings Session::rates() const {
    RateSettings settings;
    settings.mode = mode_of(state_.rate_choice);
    settings.value = state_.rate_values[static_cast<int>(state_.rate_choice)];
    if (state_.rate_choice == RateChoice::chord_error) settings.value *= bounds_.radius();
    settings.max_rate = std::min(settings.max_rate, max_rate_);
    if (state_.rate_choice == RateChoice::uniform)
        settings.value = std::min(std::round(settings.value), static_cast<float>(settings.max_rate));
    settings.camera = rate_camera(camera_, extent().width, extent().height);
    return settings;
}

/// Room for the triangles that are asked for now, and what is shown of them.
Result<void> Session::follow_rates() {
    if (even_) return {};
    SurfaceMeshOptions wanted = surface_->options();
    wanted.mode = mode_of(state_.rate_choice);
    wanted.places = wanted.places || needs_places(state_.settings.color);
    if (tessellated_ && triangles_.status != vk::TessellationStatus::complete)
        wanted.triangle_capacity = std::min(surface_->max_triangle_capacity(), 4 * wanted.triangle_capacity);
    if (wanted == surface_->options()) return {};
    if (auto made = surface_->prepare(wanted); !made) return made.error();
    renderer_->set_scene(surface_->mesh(), surface_->control_lines());
    tessellated_.reset();
    return {};
}

Result<void> Session::record_surface(VkCommandBuffer commands) {
    if (surface_changed_ && (state_.animate || seconds_ > 0)) {
        deformer_->record(commands, bounds_, seconds_, state_.amplitude);
        timer_.record_mark(commands, "control points");
    }
    if (even_) {
        if (surface_changed_) even_->record(commands, &timer_);
        return {};
    }
    const RateSettings wanted = rates();
    const bool keep_rates = tessellated_ && (state_.frozen || same_rates(*tessellated_, wanted));
    // Moving points change what is measured.
    const bool measured = wanted.mode != RateMode::uniform;
    if (keep_rates && (state_.frozen || !measured || !surface_changed_)) {
        if (!surface_changed_) return {};
        surface_->record_vertices(commands, &timer_);
        return {};
    }
    if (auto recorded = surface_->record(commands, wanted, &timer_); !recorded) return recorded.error();
    tessellated_ = wanted;
    retessellated_ = true;
    return {};
}

Result<void> Session::record(VkCommandBuffer commands, bool read_back) {
    timer_.record_begin(commands);
    if (auto recorded = record_surface(commands); !recorded) return recorded.error();
    renderer_->record(
        commands,
        {.camera = camera_, .bounds = reach_, .settings = state_.settings, .keep_shadows = !surface_changed_},
        &timer_);
    if (auto drawn = panel_->record(commands, renderer_->view(), extent()); !drawn) return drawn.error();
    timer_.record_mark(commands, "user interface");
    renderer_->record_finish(commands);
    swapchain_->record_copy(commands, renderer_->image(), extent());
    timer_.record_mark(commands, "copy to window");
    if (read_back) renderer_->record_readback(commands);
    return {};
}

Result<void> Session::draw(bool read_back) {
    const auto acquired = swapchain_->acquire();
    if (!acquired) return acquired.error();
    if (!*acquired) return swapchain_->resize(window_.framebuffer_size());
    const auto commands = swapchain_->begin();
    if (!commands) return commands.error();
    if (auto recorded = record(*commands, read_back); !recorded) return recorded.error();
    const auto presented = swapchain_->submit_and_present();
    if (!presented) return presented.error();
    surface_changed_ = false;
    drawn_ = state_;
    if (std::exchange(retessellated_, false)) {
        const auto outcome = surface_->result();
        if (!outcome) return outcome.error();
        triangles_ = *outcome;
    }
    if (!*presented) return swapchain_->resize(window_.framebuffer_size());
    return {};
}

Result<bool> Session::step(uint32_t frame) {
    if (!window_.poll()) return false;
    const auto visible = follow_size();
    if (!visible) return visible.error();
    if (!*visible) return true;
    choose(frame);
    if (auto followed = follow_rates(); !followed) return followed.error();
    if (auto drawn = draw(frame + 1 == options_.frame_count); !drawn) return drawn.error();
    return true;
}

}  // namespace

Result<std::optional<Picture>> view(const ViewOptions& options) {
    auto window = Window::open(options.size, "limn - " + options.title);
    if (!window) return window.error();
    GraphicsDeviceOptions device_options = window->device_options();
    device_options.device_index = options.device_index;
    device_options.validation = options.validation;
    auto graphics = GraphicsDevice::create(device_options);
    if (!graphics) return graphics.error();
    std::optional<Picture> picture;
    {
        Session session(options, *graphics, *window);
        if (auto started = session.start(); !started) return started.error();
        for (uint32_t frame = 0; options.frame_count == 0 || frame < options.frame_count; ++frame) {
            const auto going = session.step(frame);
            if (!going) return going.error();
            if (!*going) break;
            if (frame + 1 == options.frame_count) picture = session.picture();
        }
    }
    if (auto silent = graphics->check_validation(); !silent) return silent.error();
    return picture;
}

}  // namespace limn::viewer
