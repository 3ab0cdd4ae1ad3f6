#include <algorithm>
#include <cmath>

#include "limn/vulkan/tessellation_state.h"

namespace limn::vk {
namespace {

/// The camera's place in homogeneous coordinates: what all of x, y and w of clip space are zero at. w is 1, or 0 for
/// one that is infinitely far, towards which xyz then point.
std::array<float, 4> find_eye(const Camera& camera) {
    double m[3][4];
    for (int j = 0; j < 4; ++j) {
        m[0][j] = camera.matrix[4 * j];
        m[1][j] = camera.matrix[4 * j + 1];
        m[2][j] = camera.matrix[4 * j + 3];
    }
    std::array<double, 4> eye = {};
    for (int i = 0; i < 4; ++i) {
        int c[3], count = 0;
        for (int j = 0; j < 4; ++j)
            if (j != i) c[count++] = j;
        const double minor = m[0][c[0]] * (m[1][c[1]] * m[2][c[2]] - m[1][c[2]] * m[2][c[1]]) -
                             m[0][c[1]] * (m[1][c[0]] * m[2][c[2]] - m[1][c[2]] * m[2][c[0]]) +
                             m[0][c[2]] * (m[1][c[0]] * m[2][c[1]] - m[1][c[1]] * m[2][c[0]]);
        eye[static_cast<size_t>(i)] = i % 2 == 0 ? minor : -minor;
    }
    const double length = std::hypot(eye[0], eye[1], eye[2]);
    double scale = 1;
    if (std::abs(eye[3]) > 1e-12 * length) {
        scale = 1 / eye[3];
    } else {
        eye[3] = 0;
        double depth = 0;  // what is nearer has the smaller z
        for (int j = 0; j < 3; ++j) depth += camera.matrix[4 * j + 2] * eye[static_cast<size_t>(j)];
        scale = (depth > 0 ? -1 : 1) / (length > 0 ? length : 1);
    }
    std::array<float, 4> out = {};
    for (size_t i = 0; i < 4; ++i) out[i] = static_cast<float>(eye[i] * scale);
    return out;
}

void set_camera(const Camera& camera, float* payload) {
    for (int j = 0; j < 4; ++j) {
        payload[j] = camera.matrix[4 * j];
        payload[4 + j] = camera.matrix[4 * j + 1];
        payload[8 + j] = camera.matrix[4 * j + 3];
    }
}

template <class Change>
Dispatch changed(const Dispatch& dispatch, const Change& change) {
    Dispatch copy = dispatch;
    TessParams params;
    std::memcpy(&params, copy.push_constants.data(), sizeof(params));
    change(params);
    std::memcpy(copy.push_constants.data(), &params, sizeof(params));
    return copy;
}

}  // namespace

Tessellation::Tessellation() : state_(std::make_unique<State>()) {}
Tessellation::Tessellation(Tessellation&&) noexcept = default;
Tessellation& Tessellation::operator=(Tessellation&&) noexcept = default;
Tessellation::~Tessellation() = default;
VkDeviceSize Tessellation::state_bytes() const {
    VkDeviceSize sum = state_->words.size_bytes;
    for (const Buffer& buffer : state_->local) sum += buffer.size_bytes;
    return sum + state_->own_heights.size_bytes;
}
VkBuffer Tessellation::state_buffer() const {
    return state_->words.handle;
}

/// With a barrier behind it. The state also says how many workgroups dispatches have.
void Tessellation::State::record_stage(VkCommandBuffer commands, std::span<const Dispatch> stage) const {
    sets.record(commands, stage);
    record_barrier(device(), commands, kKernelWrites, kKernelReads | kKernelWrites | kIndirectReads);
}

uint32_t Tessellation::largest_rate(const RateSettings& settings) const {
    const bool bounded = state_->mode == RateMode::uniform && !state_->has_instances && settings.value > 0 &&
                         settings.value < static_cast<float>(settings.max_rate);
    const uint32_t least = state_->spacing == TessellationSpacing::fractional ? 2 : 1;
    return bounded ? std::max(least, static_cast<uint32_t>(std::ceil(settings.value))) : settings.max_rate;
}

/// llvmpipe runs 8 invocations as one. Where faces have about the same rate, these are 8 faces, and none of them is idle (a
/// torus of 11,025 faces: a third, at rate 16 four fifths of the frame's CPU time with 8 a face). Else faces would wait for
/// each other; and what an invocation does has to stay short, since there all its loops end after 65,535 rounds together.
Lanes Tessellation::State::lanes_for(uint32_t largest_rate) const {
    Lanes lanes = {.rows = 8, .faces = 32, .triangles = 32};
    if (cpu_device) {
        const bool alike = largest_rate <= (mode == RateMode::uniform ? 16u : 8u);
        lanes = alike ? Lanes{.rows = 1, .faces = 1, .triangles = 1} : Lanes{.rows = 2, .faces = 8, .triangles = 4};
    }
    if (largest_rate == 1) lanes.rows = 0;  // rows of one segment have no vertices
    return lanes;
}

void Tessellation::State::record_items(VkCommandBuffer commands, const Recording& recording, const ItemStage& stage,
                                       uint32_t largest_rate) const {
    const Lanes lanes = lanes_for(largest_rate);
    Recording::Bound bound;
    for (const ItemDispatch& items : stage) {
        const uint32_t each = lanes.*items.lanes;
        if (each == 0) continue;
        Dispatch dispatch = changed(items.dispatch, [&](TessParams& params) {
            params.payload[shared::kTessLanesPayload] = word(static_cast<uint32_t>(std::countr_zero(each)));
        });
        recording.set_groups(dispatch, (uint64_t{items.item_count} * each - 1) / shared::kTessWorkgroupSize + 1);
        recording.record(commands, dispatch, bound);
    }
}

void Tessellation::record_points(VkCommandBuffer command_buffer) const {
    const State& s = *state_;
    // After what was recorded of it before.
    const StageAccess both = {VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                              VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT};
    record_barrier(s.device(), command_buffer, both, both);
    for (const SurfaceEvaluation& points : s.local_points) points.record(command_buffer);
    record_barrier(s.device(), command_buffer, kKernelWrites, kKernelReads);
}

void Tessellation::record_triangles(VkCommandBuffer command_buffer, uint32_t largest_rate) const {
    state_->record_items(command_buffer, state_->sets, state_->triangles, largest_rate);
}

void Tessellation::State::record_positions(VkCommandBuffer commands, const PositionPass& pass, uint32_t largest_rate) const {
    record_items(commands, sets, pass.vertices, largest_rate);
    if (pass.copies.empty()) return;
    record_barrier(device(), commands, kKernelWrites, kKernelReads);
    record_items(commands, sets, pass.copies, largest_rate);
}

void Tessellation::record_vertices(VkCommandBuffer command_buffer, uint32_t largest_rate) const {
    state_->record_positions(command_buffer, state_->plain, largest_rate);
}

void Tessellation::record_heights(VkCommandBuffer command_buffer, uint32_t largest_rate) const {
    state_->record_items(command_buffer, state_->height_sets, state_->heights, largest_rate);
}

void Tessellation::record_displacement(VkCommandBuffer command_buffer, uint32_t largest_rate) const {
    state_->record_positions(command_buffer, state_->displaced, largest_rate);
}

Result<void> Tessellation::record(VkCommandBuffer command_buffer, const RateSettings& settings) const {
    const uint32_t largest = largest_rate(settings);
    record_points(command_buffer);
    auto recorded = record_rates(command_buffer, settings);
    record_triangles(command_buffer, largest);
    record_vertices(command_buffer, largest);
    if (state_->heights.empty()) return recorded;
    const StageAccess both = {VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                              VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT};
    record_heights(command_buffer, largest);
    record_barrier(state_->device(), command_buffer, kKernelWrites, both);
    record_displacement(command_buffer, largest);
    return recorded;
}

Result<void> Tessellation::record_rates(VkCommandBuffer command_buffer, const RateSettings& given) const {
    const State& s = *state_;
    RateSettings settings = given;
    settings.mode = s.mode;
    settings.spacing = s.spacing;
    settings.cull_outside = s.cull_outside;
    settings.cull_backfaces = s.cull_backfaces;
    Result<void> checked = check_rate_settings(settings);
    if (checked && settings.max_rate > s.max_rate)
        checked = bad_argument("the largest rate is larger than that which the patch trees were built for");
    if (!checked) settings = {.max_rate = s.max_rate};  // kernels run, for what they leave, and must end
    const auto patched = [&](const Dispatch& dispatch, const auto& change) {
        return changed(dispatch, [&](TessParams& params) {
            params.max_rate = settings.max_rate;
            change(params.payload);
        });
    };
    const uint32_t status = checked ? shared::kTessComplete : shared::kTessBadSettings;
    const Dispatch begin = patched(s.begin, [&](float* payload) { payload[3] = word(status); });
    s.record_stage(command_buffer, {&begin, 1});
    const Dispatch targets = patched(s.targets, [&](float* payload) {
        set_camera(settings.camera, payload);
        payload[12] = settings.camera.width;
        payload[13] = settings.camera.height;
        payload[14] = settings.value;
    });
    s.record_stage(command_buffer, {&targets, 1});
    const Dispatch drawn = patched(s.drawn, [&](float* payload) {
        set_camera(settings.camera, payload);
        const auto eye = find_eye(settings.camera);
        std::copy(eye.begin(), eye.end(), payload + 12);
        payload[16] = settings.bound;
    });
    s.record_stage(command_buffer, {&drawn, 1});
    const auto record_stages = [&](std::span<const Stage> stages) {
        for (const Stage& stage : stages) {
            Stage copies = stage;
            for (Dispatch& dispatch : copies) dispatch = patched(dispatch, [](float*) {});
            s.record_stage(command_buffer, copies);
        }
    };
    record_stages(s.rates);
    record_stages(s.scaled);
    if (!s.instance_commands.empty()) record_stages({&s.instance_commands, 1});
    return checked;
}

Tessellator::Tessellator() = default;
Tessellator::Tessellator(Tessellator&&) noexcept = default;
Tessellator& Tessellator::operator=(Tessellator&&) noexcept = default;
Tessellator::~Tessellator() = default;

Result<Tessellator> Tessellator::create(const Device& device) {
    auto surfaces = SurfaceEvaluator::create(device);
    if (!surfaces) return surfaces.error();
    Tessellator tessellator;
    tessellator.state_ = std::make_unique<State>(std::move(*surfaces));
    State& state = *tessellator.state_;
    state.device = &device;
    state.texel = reads_texels(device);
    std::vector<VkDescriptorType> bindings(shared::kTessBindingCount, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER);
    if (state.texel)
        for (const uint32_t b : {shared::kTessWordsBinding, shared::kTessWordGroupsBinding, shared::kTessLocalBinding,
                                 shared::kTessSecondBinding, shared::kTessSettledBinding})
            bindings[b] = VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
    for (uint32_t k = 0; k < kTessKernelCount; ++k) {
        if (k == kTessHeightKernel) bindings[shared::kTessSecondBinding] = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
        auto kernel = create_kernel(device, {tess_kernel_spirv(static_cast<TessKernel>(k), state.texel), bindings,
                                             sizeof(TessParams)});
        if (!kernel) return kernel.error();
        state.kernels[k] = std::move(*kernel);
    }
    return tessellator;
}

}  // namespace limn::vk
