#include "viewer/panel.h"

#include <imgui.h>
#include <imgui_impl_glfw.h>
#include <imgui_impl_vulkan.h>

#include "limn/vulkan/buffer.h"
#include "viewer/pipelines.h"

namespace limn::viewer {
namespace {

Result<UniqueRenderPass> create_pass(VkDevice device) {
    VkAttachmentDescription attachment = {};
    attachment.format = kRawColorFormat;
    attachment.samples = VK_SAMPLE_COUNT_1_BIT;
    attachment.loadOp = VK_ATTACHMENT_LOAD_OP_LOAD;
    attachment.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    attachment.stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
    attachment.stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
    attachment.initialLayout = attachment.finalLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    const VkAttachmentReference color = {0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
    VkSubpassDescription subpass = {};
    subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
    subpass.colorAttachmentCount = 1;
    subpass.pColorAttachments = &color;
    constexpr VkPipelineStageFlags kStage = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT;
    constexpr VkAccessFlags kAccess =
        VK_ACCESS_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT;
    const VkSubpassDependency dependency = {
        VK_SUBPASS_EXTERNAL, 0, kStage, kStage, VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT, kAccess, 0};
    VkRenderPassCreateInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO;
    info.attachmentCount = 1;
    info.pAttachments = &attachment;
    info.subpassCount = 1;
    info.pSubpasses = &subpass;
    info.dependencyCount = 1;
    info.pDependencies = &dependency;
    return create_unique<UniqueRenderPass>(device, vkCreateRenderPass, info, "vkCreateRenderPass");
}

void set_style() {
    ImGui::StyleColorsDark();
    ImGuiStyle& style = ImGui::GetStyle();
    style.WindowRounding = 6;
    style.FrameRounding = 3;
    style.GrabRounding = 3;
    style.WindowBorderSize = 0;
    style.Colors[ImGuiCol_WindowBg] = ImVec4(0.09f, 0.10f, 0.12f, 0.86f);
}

void combo(const char* label, int& choice, std::span<const std::string> names) {
    if (!ImGui::BeginCombo(label, names[static_cast<size_t>(choice)].c_str())) return;
    for (size_t i = 0; i < names.size(); ++i)
        if (ImGui::Selectable(names[i].c_str(), static_cast<int>(i) == choice)) choice = static_cast<int>(i);
    ImGui::EndCombo();
}

void show_rates(PanelState& state) {
    static const std::string names[] = {"uniform rate", "pixel error", "edge length", "chord error"};
    int choice = static_cast<int>(state.rate_choice);
    combo("triangles", choice, names);
    state.rate_choice = static_cast<RateChoice>(choice);
    constexpr ImGuiSliderFlags kFlags = ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_Logarithmic;
    float& value = state.rate_values[choice];
    switch (state.rate_choice) {
        case RateChoice::uniform:
            ImGui::SliderFloat("rate", &value, 1, 64, "%.0f", kFlags);
            break;
        case RateChoice::pixel_error:
            ImGui::SliderFloat("pixels", &value, 0.02f, 4, "%.2f", kFlags);
            break;
        case RateChoice::edge_length:
            ImGui::SliderFloat("pixels", &value, 1, 64, "%.1f", kFlags);
            break;
        case RateChoice::chord_error:
            ImGui::SliderFloat("radii", &value, 1e-5f, 0.1f, "%.5f", kFlags);
            break;
    }
    ImGui::Checkbox("freeze rates", &state.frozen);
}

void show_times(const PanelFacts& facts) {
    if (!ImGui::BeginTable("times", 2, ImGuiTableFlags_RowBg | ImGuiTableFlags_BordersInnerV)) return;
    ImGui::TableSetupColumn("pass");
    ImGui::TableSetupColumn("ms");
    ImGui::TableHeadersRow();
    const auto row = [](const char* name, double milliseconds) {
        ImGui::TableNextRow();
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(name);
        ImGui::TableNextColumn();
        ImGui::Text("%.2f", milliseconds);
    };
    for (const PassTimer::Pass& pass : facts.passes) row(pass.name, pass.milliseconds);
    row("frame", facts.frame_milliseconds);
    ImGui::EndTable();
}

void show_facts(const PanelFacts& facts) {
    ImGui::TextUnformatted(facts.model);
    ImGui::TextDisabled("%s", facts.device);
    ImGui::Text("%llu vertices, %llu triangles", static_cast<unsigned long long>(facts.vertices),
                static_cast<unsigned long long>(facts.triangles));
    if (facts.message != nullptr && !facts.message->empty()) {
        ImGui::PushTextWrapPos(0);
        ImGui::TextColored(ImVec4(1, 0.55f, 0.4f, 1), "%s", facts.message->c_str());
        ImGui::PopTextWrapPos();
    }
}

}  // namespace

struct Panel::State {
    const vk::Device* device = nullptr;
    UniqueDescriptorPool pool;
    UniqueRenderPass pass;
    UniqueFramebuffer frame;
    VkImageView frame_view = VK_NULL_HANDLE;
    VkExtent2D frame_extent = {};
    bool glfw = false, vulkan = false;

    ~State() {
        if (vulkan) ImGui_ImplVulkan_Shutdown();
        if (glfw) ImGui_ImplGlfw_Shutdown();
        if (ImGui::GetCurrentContext() != nullptr) ImGui::DestroyContext();
    }
};

Panel::Panel(std::unique_ptr<State> state) : state_(std::move(state)) {}
Panel::Panel(Panel&&) noexcept = default;
Panel::~Panel() = default;

Result<Panel> Panel::create(const vk::Device& device, const Window& window) {
    auto state = std::make_unique<State>();
    state->device = &device;
    const VkDescriptorPoolSize size = {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 4};
    VkDescriptorPoolCreateInfo pool_info = {};
    pool_info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO;
    pool_info.flags = VK_DESCRIPTOR_POOL_CREATE_FREE_DESCRIPTOR_SET_BIT;
    pool_info.maxSets = 4;
    pool_info.poolSizeCount = 1;
    pool_info.pPoolSizes = &size;
    auto pool = create_unique<UniqueDescriptorPool>(device.handle, vkCreateDescriptorPool, pool_info,
                                                    "vkCreateDescriptorPool");
    if (!pool) return pool.error();
    state->pool = std::move(*pool);
    auto pass = create_pass(device.handle);
    if (!pass) return pass.error();
    state->pass = std::move(*pass);

    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;  // the panel is small: nothing to remember
    set_style();
    state->glfw = ImGui_ImplGlfw_InitForVulkan(window.handle(), true);
    ImGui_ImplVulkan_InitInfo info = {};
    info.Instance = device.instance;
    info.PhysicalDevice = device.physical_device;
    info.Device = device.handle;
    info.QueueFamily = device.queue_family_index;
    info.Queue = device.queue;
    info.PipelineCache = device.pipeline_cache;
    info.DescriptorPool = state->pool;
    info.MinImageCount = info.ImageCount = 2;
    info.MSAASamples = VK_SAMPLE_COUNT_1_BIT;
    state->vulkan = ImGui_ImplVulkan_Init(&info, state->pass);
    auto commands = vk::Commands::begin(device);
    if (!commands) return commands.error();
    if (!state->glfw || !state->vulkan || !ImGui_ImplVulkan_CreateFontsTexture(*commands))
        return Error{ErrorCode::vulkan_failure, "Dear ImGui could not be started"};
    if (auto done = commands->submit_and_wait(); !done) return done.error();
    ImGui_ImplVulkan_DestroyFontUploadObjects();
    return Panel(std::move(state));
}

void Panel::build(PanelState& state, const PanelFacts& facts, std::span<const std::string> schemes,
                  std::span<const std::string> colors) {
    ImGui_ImplVulkan_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    ImGui::SetNextWindowPos(ImVec2(12, 12), ImGuiCond_FirstUseEver);
    ImGui::Begin("limn", nullptr, ImGuiWindowFlags_AlwaysAutoResize);
    show_facts(facts);
    ImGui::PushItemWidth(150);
    ImGui::Separator();
    combo("scheme", state.scheme, schemes);
    show_rates(state);
    combo("colour", state.color, colors);
    ImGui::Checkbox("wireframe", &state.settings.wireframe);
    ImGui::SameLine();
    ImGui::Checkbox("control mesh", &state.settings.lines);
    ImGui::Checkbox("ground", &state.settings.ground);
    ImGui::SameLine();
    ImGui::Checkbox("animate", &state.animate);
    ImGui::SliderFloat("motion", &state.amplitude, 0, 2, "%.2f");
    ImGui::SliderInt("sky shadows", &state.sky_directions, 0, 64, "%d", ImGuiSliderFlags_AlwaysClamp);
    state.frame_all = ImGui::Button("frame all");
    ImGui::PopItemWidth();
    ImGui::Separator();
    show_times(facts);
    ImGui::TextDisabled("left: orbit   middle or right: pan   wheel: zoom");
    ImGui::End();
    ImGui::Render();
    state.settings.color = static_cast<ColorMode>(state.color);
    state.settings.sky_directions = static_cast<uint32_t>(state.sky_directions);
    state.settings.max_rate = 64;
}

Panel::Drag Panel::drag() const {
    Drag out;
    const ImGuiIO& io = ImGui::GetIO();
    if (io.WantCaptureMouse) return out;
    const bool pan =
        ImGui::IsMouseDown(ImGuiMouseButton_Right) || ImGui::IsMouseDown(ImGuiMouseButton_Middle);
    if (pan || ImGui::IsMouseDown(ImGuiMouseButton_Left)) {
        float(&into)[2] = pan ? out.pan : out.orbit;
        into[0] = io.MouseDelta.x;
        into[1] = io.MouseDelta.y;
    }
    out.zoom = io.MouseWheel;
    return out;
}

Result<void> Panel::record(VkCommandBuffer commands, VkImageView view, VkExtent2D extent) {
    State& state = *state_;
    if (view != state.frame_view || extent.width != state.frame_extent.width ||
        extent.height != state.frame_extent.height) {
        VkFramebufferCreateInfo info = {};
        info.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO;
        info.renderPass = state.pass;
        info.attachmentCount = 1;
        info.pAttachments = &view;
        info.width = extent.width;
        info.height = extent.height;
        info.layers = 1;
        auto frame = create_unique<UniqueFramebuffer>(state.device->handle, vkCreateFramebuffer, info,
                                                      "vkCreateFramebuffer");
        if (!frame) return frame.error();
        state.frame = std::move(*frame);
        state.frame_view = view;
        state.frame_extent = extent;
    }
    VkRenderPassBeginInfo info = {};
    info.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO;
    info.renderPass = state.pass;
    info.framebuffer = state.frame;
    info.renderArea.extent = extent;
    vkCmdBeginRenderPass(commands, &info, VK_SUBPASS_CONTENTS_INLINE);
    ImGui_ImplVulkan_RenderDrawData(ImGui::GetDrawData(), commands);
    vkCmdEndRenderPass(commands);
    return {};
}

}  // namespace limn::viewer
