// Crowds that change in place, on the device: its tables hold what the host's do, word for word, though only
// changes were copied; and what is drawn of each instance is to the bit what a fresh merge draws.
#include "limn/vulkan/crowd_tables.h"

#include <map>

#include "limn/crowd_state.h"
#include "vulkan/crowd_fixture.h"

namespace limn::vk::test {
namespace {

using limn::test::RandomNumbers;

std::vector<Surfaces> some_meshes() {
    std::vector<TestMesh> shapes = {limn::test::make_cube(), limn::test::make_torus(6, 4),
                                    limn::test::make_prism(5), limn::test::make_globe(7, 2),
                                    limn::test::make_globe(70, 2)};
    for (uint64_t seed = 0; seed < 4; ++seed) shapes.push_back(limn::test::make_messy_torus(7, 6, seed));
    std::vector<Surfaces> out;
    for (const TestMesh& shape : shapes) out.push_back(surfaces_of(shape));
    return out;
}

/// An instance that should be there.
struct Expected {
    const Surfaces* mesh;
    float shift;  ///< of its control points
    bool hidden;
    /// Moved along, so that nothing computed in an earlier frame is right.
    std::vector<float> control(uint32_t frame) const {
        std::vector<float> out = mesh->control;
        for (float& x : out) x += shift + static_cast<float>(frame);
        return out;
    }
};

class ChangingCrowd : public CrowdTest {
  protected:
    void change(RandomNumbers& random);
    void expect_words(const Buffer& buffer, uint32_t offset, CrowdArray array);
    void expect_same_words_on_device();
    Buffer control_points();
    void make_outputs();
    void prepare();
    Drawn draw_updated();
    Drawn draw_merged();
    void expect_as_merged_afresh(const Drawn& drawn, const Drawn& merged);
    void run_changes(uint64_t seed, uint32_t steps);

    std::vector<Surfaces> meshes_ = some_meshes();
    limn::Crowd crowd_{{.max_rate = 8, .reserve = 0.5f}};
    std::map<uint32_t, Expected> expected_;
    DeviceCrowd tables_;
    Buffer points_, positions_, normals_, indices_, faces_, command_, commands_, result_, instances_;
    uint32_t vertex_capacity_ = 0, triangle_capacity_ = 0, in_place_ = 0, frame_ = 0;
    std::optional<StencilEvaluation> refined_;
    std::optional<Tessellation> tessellation_;
};

/// One to three instances come, or one goes; or one is hidden or shown.
void ChangingCrowd::change(RandomNumbers& random) {
    const auto any = [&] {
        return std::next(expected_.begin(), random.below(static_cast<uint32_t>(expected_.size())));
    };
    const uint32_t what = random.below(6);
    if (expected_.empty() || what < 3) {
        std::vector<BatchMesh> added;
        std::vector<Expected> came;
        for (uint32_t n = 1 + random.below(3); n-- != 0;) {
            const Surfaces& mesh = meshes_[random.below(static_cast<uint32_t>(meshes_.size()))];
            added.push_back({&mesh.patches, &mesh.topology});
            came.push_back({&mesh, static_cast<float>(random.below(16)), false});
        }
        const auto numbers = crowd_.add(added);
        ASSERT_TRUE(numbers);
        for (size_t i = 0; i < added.size(); ++i) expected_[(*numbers)[i]] = came[i];
    } else if (what < 5 && expected_.size() > 1) {
        const auto at = any();
        ASSERT_TRUE(crowd_.remove(at->first));
        expected_.erase(at);
    } else {
        const auto at = any();
        at->second.hidden = !at->second.hidden;
    }
}

void ChangingCrowd::expect_words(const Buffer& buffer, uint32_t offset, CrowdArray array) {
    const limn::Crowd::State::Words words = crowd_.state().words(array);
    const auto device = *download<uint32_t>(this->device(), buffer, words.count, uint64_t{4} * offset);
    EXPECT_TRUE(words.count == 0 || std::memcmp(device.data(), words.data, 4 * words.count) == 0)
        << "array " << array;
}

void ChangingCrowd::expect_same_words_on_device() {
    const DevicePatchTable& p = tables_.patches;
    const DeviceTessellationTable& t = tables_.topology;
    expect_words(p.words, p.offsets.ptex_surfaces, kPtexArray);
    expect_words(p.words, p.offsets.surfaces, kSurfaceArray);
    expect_words(p.words, p.offsets.ring_points, kRingArray);
    expect_words(p.words, p.offsets.plans, kPlanArray);
    expect_words(p.words, p.offsets.plan_nodes, kPlanNodeArray);
    expect_words(p.words, p.offsets.plan_points, kPlanPointArray);
    expect_words(p.words, p.offsets.plan_weights, kPlanWeightArray);
    expect_words(t.words, t.vertices.offsets.ptex_surfaces, kPtexArray);
    expect_words(t.words, t.vertices.offsets.surfaces, kTreeSurfaceArray);
    expect_words(t.words, t.vertices.offsets.nodes, kTreeNodeArray);
    expect_words(t.words, t.vertices.offsets.leaf_points, kLeafArray);
    expect_words(t.words, t.offsets.faces, kFaceArray);
    expect_words(t.words, t.offsets.rows, kRowArray);
    expect_words(t.words, t.offsets.corners, kCornerArray);
    expect_words(t.words, t.offsets.rate_edges, kRateEdgeArray);
    expect_words(t.words, t.offsets.copies, kCornerCopyArray);
    expect_words(t.words, t.offsets.copies + 2 * t.corner_copy_count, kRowCopyArray);
    expect_words(t.words, t.instances_offset, kInstanceArray);
    expect_words(p.points.data, 0, kPointArray);
    expect_words(t.vertices.local_points.words, 0, kTileArray);
    expect_words(t.vertices.local_points.weights, 0, kWeightArray);
}

/// With sevens where level-1 points will be.
Buffer ChangingCrowd::control_points() {
    std::vector<float> all(size_t{3} * crowd_.patches().point_count(), 7.0f);
    for (const auto& [number, instance] : expected_) {
        const std::vector<float> control = instance.control(frame_);
        std::copy(control.begin(), control.end(),
                  all.data() + 3 * size_t{crowd_.find(number)->patches.control_points.first});
    }
    return filled(std::as_bytes(std::span(all)));
}

void ChangingCrowd::make_outputs() {
    // As if every face were there: what there is room for.
    vertex_capacity_ =
        crowd_.topology().corner_count + 7 * crowd_.topology().row_count + 49 * crowd_.topology().face_count;
    triangle_capacity_ = 128 * crowd_.topology().face_count;
    positions_ = words(size_t{3} * vertex_capacity_);
    normals_ = words(size_t{3} * vertex_capacity_);
    indices_ = words(size_t{3} * triangle_capacity_);
    faces_ = words(triangle_capacity_);
    command_ = words(5);
    commands_ = words(size_t{5} * crowd_.instance_capacity());
    result_ = words(4);
    points_ = words(size_t{3} * crowd_.patches().point_count());
    instances_ = *create_buffer(device(), sizeof(TessellationInstance) * crowd_.instance_capacity(),
                                kPointUsage, MemoryUse::device);
}

void ChangingCrowd::prepare() {
    const PointBuffer points = {.buffer = points_.handle};
    auto refined = surfaces_->prepare_points({.patches = &tables_.patches, .points = points});
    ASSERT_TRUE(refined);
    refined_ = std::move(*refined);
    auto tessellation = tessellator_->prepare({.patches = &tables_.patches,
                                               .table = &tables_.topology,
                                               .points = points,
                                               .cull_backfaces = true,
                                               .instances = {instances_.handle},
                                               .vertex_capacity = vertex_capacity_,
                                               .triangle_capacity = triangle_capacity_,
                                               .fit_capacity = false,
                                               .positions = {.buffer = positions_.handle},
                                               .normals = {.buffer = normals_.handle},
                                               .indices = {indices_.handle},
                                               .triangle_faces = {faces_.handle},
                                               .command = {command_.handle},
                                               .instance_commands = {commands_.handle},
                                               .result = {result_.handle}});
    ASSERT_TRUE(tessellation);
    EXPECT_EQ(tessellation->state_bytes(), crowd_tessellation_memory(crowd_).device_bytes);
    tessellation_ = std::move(*tessellation);
}

TessellationInstance instance_of(const Expected* instance) {
    TessellationInstance out = {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, 1, 0, {0, 0}};
    if (instance == nullptr) return out;
    out.value_scale = instance->shift < 8 ? 1.0f : 0.5f;
    out.flags = instance->hidden ? shared::kInstanceHidden : 0;
    return out;
}

/// In one command buffer: the old state is drawn where it still can be, tables are brought up to date, the
/// new state is drawn.
Drawn ChangingCrowd::draw_updated() {
    const RateSettings settings = {.value = kTessellationRate, .max_rate = 8, .cull_backfaces = true};
    Result<Commands> commands = Commands::begin(device());
    if (tessellation_) {
        refined_->record(*commands);
        record_barrier(device(), *commands, kKernelWrites, kKernelReads);
        EXPECT_TRUE(tessellation_->record(*commands, settings));
        record_barrier(device(), *commands, kKernelWrites | kKernelReads, kKernelWrites);
    }
    const MemoryNeed need = *crowd_update_memory(device(), crowd_, tables_);
    const VkDeviceSize changed = crowd_.changed_bytes();
    const uint64_t layout = tables_.layout;
    auto update = *record_crowd_update(device(), *commands, crowd_, tables_);
    crowd_.forget_changes();
    if (layout == crowd_.layout()) {
        EXPECT_LE(changed, update.copied_bytes);  // ptex_surfaces are there twice
        EXPECT_LE(update.copied_bytes, 2 * changed);
        EXPECT_TRUE(update.replaced.empty());
        EXPECT_EQ(need.device_bytes, 0u);
        if (!update.prepare_again) ++in_place_;
    } else {
        EXPECT_EQ(need.device_bytes, tables_.bytes());
        EXPECT_EQ(need.buffer_count, 5u);
    }
    VkDeviceSize staged = 0;
    for (const Buffer& buffer : update.staging) staged += buffer.size_bytes;
    EXPECT_EQ(staged, need.staging_bytes);
    // Another frame's buffers where this one's are in use: those of the old state have to live until the
    // commands are done.
    std::optional<StencilEvaluation> old_refined;
    std::optional<Tessellation> old_tessellation;
    std::vector<Buffer> old_buffers;
    if (update.prepare_again) {
        std::swap(old_refined, refined_);
        std::swap(old_tessellation, tessellation_);
        for (Buffer* b : {&points_, &positions_, &normals_, &indices_, &faces_, &command_, &commands_,
                          &result_, &instances_})
            old_buffers.push_back(std::move(*b));
        make_outputs();
        prepare();
    }
    const Buffer control = control_points();
    const VkBufferCopy whole = {0, 0, VkDeviceSize{12} * crowd_.patches().point_count()};
    std::vector<TessellationInstance> all(crowd_.instance_capacity(), instance_of(nullptr));
    for (const auto& [number, instance] : expected_) all[number] = instance_of(&instance);
    const Buffer flags = filled(std::as_bytes(std::span(all)));
    const VkBufferCopy all_flags = {0, 0, sizeof(TessellationInstance) * all.size()};
    record_barrier(device(), *commands, kKernelReads, kCopyWrites);
    device().functions.CmdCopyBuffer(*commands, control.handle, points_.handle, 1, &whole);
    device().functions.CmdCopyBuffer(*commands, flags.handle, instances_.handle, 1, &all_flags);
    record_barrier(device(), *commands, kCopyWrites, kKernelReads | kKernelWrites);
    refined_->record(*commands);
    record_barrier(device(), *commands, kKernelWrites, kKernelReads);
    EXPECT_TRUE(tessellation_->record(*commands, settings));
    record_barrier(device(), *commands, kKernelWrites, kCopyReads);
    EXPECT_TRUE(commands->submit_and_wait());
    Drawn out;
    out.result = (*download<TessellationResult>(device(), result_, 1))[0];
    out.commands = read(commands_, 5 * size_t{crowd_.instance_capacity()});
    out.indices = read(indices_, 3 * size_t{out.result.triangle_count});
    out.triangle_faces = read(faces_, out.result.triangle_count);
    out.positions = read(positions_, 3 * size_t{out.result.vertex_count});
    out.normals = read(normals_, 3 * size_t{out.result.vertex_count});
    return out;
}

/// All instances merged afresh, in the order of their numbers; level-1 points by the device, too.
Drawn ChangingCrowd::draw_merged() {
    std::vector<Surfaces> all;
    std::vector<TessellationInstance> flags;
    for (const auto& [number, instance] : expected_) {
        all.push_back({instance.mesh->patches, instance.mesh->topology, instance.control(frame_), {}});
        flags.push_back(instance_of(&instance));
    }
    const Surfaces merged = merge(all).merged;
    const DevicePatchTable patches = *upload_patch_table(device(), merged.patches);
    std::vector<float> initial = merged.points;
    std::fill(initial.begin() + static_cast<ptrdiff_t>(merged.control.size()), initial.end(), 7.0f);
    const Buffer points = filled(std::as_bytes(std::span(initial)));
    const auto refined =
        surfaces_->prepare_points({.patches = &patches, .points = {.buffer = points.handle}});
    EXPECT_TRUE(refined);
    run([&](VkCommandBuffer commands) { refined->record(commands); });
    Drawn out;
    draw_triangles(merged, patches, points, out, {.instances = flags});
    return out;
}

/// So many triangles of both, from one number on, over vertices of the same bits that are shared in the same
/// way.
void expect_same_triangles(const Drawn& a, uint32_t first_a, const Drawn& b, uint32_t first_b,
                           uint32_t count) {
    std::map<uint32_t, uint32_t> to, back;
    for (uint32_t t = 0; t < count; ++t) {
        ASSERT_EQ(a.triangle_faces[first_a + t] - a.triangle_faces[first_a],
                  b.triangle_faces[first_b + t] - b.triangle_faces[first_b]);
        for (uint32_t k = 0; k < 3; ++k) {
            const uint32_t v = a.indices[3 * (first_a + t) + k], w = b.indices[3 * (first_b + t) + k];
            ASSERT_EQ(to.try_emplace(v, w).first->second, w);
            ASSERT_EQ(back.try_emplace(w, v).first->second, v);
            ASSERT_EQ(std::memcmp(&a.positions[3 * v], &b.positions[3 * w], 12), 0) << "vertex " << v;
            ASSERT_EQ(std::memcmp(&a.normals[3 * v], &b.normals[3 * w], 12), 0) << "vertex " << v;
        }
    }
}

void ChangingCrowd::expect_as_merged_afresh(const Drawn& drawn, const Drawn& merged) {
    EXPECT_EQ(drawn.result.status, TessellationStatus::complete);
    EXPECT_EQ(drawn.result.triangle_count, merged.result.triangle_count);
    uint32_t i = 0;
    for (uint32_t number = 0; number < crowd_.instance_capacity(); ++number) {
        const uint32_t* command = &drawn.commands[5 * size_t{number}];
        if (expected_.find(number) == expected_.end()) {
            EXPECT_EQ(command[0], 0u) << "instance " << number;
            continue;
        }
        SCOPED_TRACE(number);
        const uint32_t* fresh = &merged.commands[5 * size_t{i++}];
        EXPECT_EQ(command[4], number);
        ASSERT_EQ(command[0], fresh[0]);
        EXPECT_EQ(command[0] == 0, expected_[number].hidden);
        expect_same_triangles(drawn, command[2] / 3, merged, fresh[2] / 3, command[0] / 3);
    }
}

void ChangingCrowd::run_changes(uint64_t seed, uint32_t steps) {
    RandomNumbers random(seed);
    for (uint32_t step = 0; step < steps; ++step) {
        SCOPED_TRACE(step);
        for (uint32_t i = 0; i < 1 + step % 3; ++i) change(random);
        frame_ = step;
        const Drawn drawn = draw_updated();
        expect_same_words_on_device();
        if (step % 3 == 2) expect_as_merged_afresh(drawn, draw_merged());
        if (HasFatalFailure()) return;
    }
    EXPECT_GT(in_place_, steps / 3);
    EXPECT_LT(crowd_.layout(), steps);
}

TEST_F(ChangingCrowd, AfterUpdatesDrawsAsMergedAfresh) {
    run_changes(1, 24);
}

TEST_F(ChangingCrowd, ByStagingAndStorageBuffersToo) {
    pretend_gpu();
    run_changes(2, 12);
}

}  // namespace
}  // namespace limn::vk::test
