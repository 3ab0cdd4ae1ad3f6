#include "limn/crowd.h"

#include <algorithm>
#include <numeric>

#include "limn/crowd_layout.h"

namespace limn {
namespace {

Error at_mesh(Error error, size_t mesh) {
    error.element = mesh;
    return error;
}

/// What a mesh must have, whatever else is in the crowd.
Result<void> check(const CrowdOptions& options, const BatchMesh& mesh, const BatchMesh& first) {
    assert(mesh.patches != nullptr && mesh.topology != nullptr);
    const auto bad = [](const char* message) { return Error{ErrorCode::invalid_argument, message}; };
    if (!(options.reserve >= 0 && options.reserve <= 4))
        return bad("the reserve of a crowd is not within 0 and 4");
    if (options.max_rate < 2 || options.max_rate > 128)
        return bad("the largest rate of a crowd is not within 2 and 128");
    if (options.points_per_pass < 65536) return bad("passes hold 65,536 points or more");
    if (mesh.patches->options != first.patches->options || mesh.topology->options != first.patches->options)
        return bad("a mesh has other scheme options than the crowd");
    if (mesh.patches->plan_identities.size() != mesh.patches->plans.size())
        return bad("a mesh does not have an identity for each plan");
    if (mesh.patches->ptex_surfaces.size() != mesh.topology->face_count)
        return bad("tables are of different meshes");
    if (mesh.patches->end_cap != EndCap::exact)
        return Error{ErrorCode::unsupported, "tessellation of patch tables with Gregory end caps"};
    return {};
}

}  // namespace

Crowd::Crowd(const CrowdOptions& options) : state_(std::make_unique<State>()) {
    state_->options = options;
}
Crowd::Crowd(Crowd&&) noexcept = default;
Crowd& Crowd::operator=(Crowd&&) noexcept = default;
Crowd::~Crowd() = default;

Result<uint32_t> Crowd::add(const BatchMesh& mesh) {
    auto added = add(std::span(&mesh, 1));
    if (!added) return added.error();
    return added->front();
}

Result<std::vector<uint32_t>> Crowd::add(std::span<const BatchMesh> meshes) {
    for (size_t m = 0; m < meshes.size(); ++m) {
        const auto live =
            std::find_if(state_->slots.begin(), state_->slots.end(), [](const auto& s) { return s.is_live; });
        const BatchMesh& first = live != state_->slots.end() ? live->mesh : meshes[0];
        if (auto checked = check(state_->options, meshes[m], first); !checked)
            return at_mesh(checked.error(), m);
    }
    std::vector<uint32_t> numbers;
    bool fits = true;
    Error failed;
    for (const BatchMesh& mesh : meshes) {
        numbers.push_back(take_slot(*state_, mesh));
        if (!fits || !failed.message.empty()) continue;
        if (auto placed = place(*state_, numbers.back()); !placed)
            failed = placed.error();
        else
            fits = *placed;
    }
    if (!fits && failed.message.empty()) {
        auto anew = lay_out_anew(*state_);
        if (!anew)
            failed = anew.error();
        else
            state_ = std::move(*anew);
    }
    if (failed.message.empty()) {
        state_->instance_count += static_cast<uint32_t>(numbers.size());
        list_crowd_instances(*state_);
        return numbers;
    }
    for (const uint32_t number : numbers) take_away(*state_, number);
    state_->slots.resize(state_->instance_capacity);
    return failed;
}

Result<void> Crowd::remove(uint32_t instance) {
    if (find(instance) == nullptr)
        return Error{ErrorCode::index_out_of_range, "there is no instance " + std::to_string(instance),
                     instance};
    take_away(*state_, instance);
    --state_->instance_count;
    list_crowd_instances(*state_);
    return {};
}

Result<void> Crowd::compact() {
    auto anew = lay_out_anew(*state_);
    if (!anew) return anew.error();
    state_ = std::move(*anew);
    return {};
}

uint32_t Crowd::instance_capacity() const {
    return state_->instance_capacity;
}
uint32_t Crowd::instance_count() const {
    return state_->instance_count;
}
const CrowdInstance* Crowd::find(uint32_t instance) const {
    const bool is_one = instance < state_->slots.size() && state_->slots[instance].is_live;
    return is_one ? &state_->slots[instance].instance : nullptr;
}
uint64_t Crowd::layout() const {
    return state_->layout;
}
const PatchTable& Crowd::patches() const {
    return state_->patches;
}
const TessellationTable& Crowd::topology() const {
    return state_->topology;
}

uint64_t Crowd::bytes() const {
    uint64_t words = 0;
    for (uint32_t a = 0; a < kCrowdArrayCount; ++a) words += state_->words(static_cast<CrowdArray>(a)).count;
    return 4 * words;
}
uint64_t Crowd::changed_bytes() const {
    uint64_t words = 0;
    for (uint32_t a = 0; a < kCrowdArrayCount; ++a)
        for (const BatchRange& range : state_->changes(static_cast<CrowdArray>(a)).merged(kChangeGap))
            words += range.count;
    return 4 * words;
}
void Crowd::forget_changes() {
    for (WordChanges& changes : state_->own_changes) changes.ranges.clear();
    state_->tiles.changes.ranges.clear();
    state_->points.changes.ranges.clear();
}

}  // namespace limn
