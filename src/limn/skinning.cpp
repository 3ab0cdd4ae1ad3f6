#include "limn/skinning.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

namespace limn {
namespace {

constexpr uint64_t kMost = 0xffffffffu;

Error error_of(ErrorCode code, const char* kind, size_t element, const char* what) {
    return {code, std::string(kind) + " " + std::to_string(element) + ": " + what, element};
}

bool are_finite(std::span<const float> values) {
    return std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); });
}

/// Sizes agree, indices are in range, numbers are finite.
Result<void> check_target(const MorphTarget& target, size_t point_count, size_t mesh) {
    const auto fail = [&](ErrorCode code, const char* what) { return error_of(code, "mesh", mesh, what); };
    const size_t moved = target.points.empty() ? point_count : target.points.size();
    if (target.points.empty() && target.deltas.empty()) return {};
    if (target.deltas.size() % 3 != 0 || target.deltas.size() / 3 != moved)
        return fail(ErrorCode::invalid_argument, "a morph target has not three deltas for each point");
    if (!are_finite(target.deltas)) return fail(ErrorCode::not_finite, "a morph target is not finite");
    for (const uint32_t point : target.points)
        if (point >= point_count) return fail(ErrorCode::index_out_of_range, "a morph target moves a point past the end");
    return {};
}

Result<void> check_mesh(const SkinMesh& mesh, size_t number) {
    const auto fail = [&](ErrorCode code, const char* what) { return error_of(code, "mesh", number, what); };
    if (mesh.rest_points.size() % 3 != 0)
        return fail(ErrorCode::invalid_argument, "rest_points are not three floats a point");
    const size_t point_count = mesh.rest_points.size() / 3;
    if (mesh.influence_count > kMaxInfluences) return fail(ErrorCode::invalid_argument, "more than 8 influences a point");
    if (point_count > kMost) return fail(ErrorCode::too_large, "2^32 points or more");
    const size_t influences = point_count * mesh.influence_count;
    if (mesh.joints.size() != influences || mesh.weights.size() != influences)
        return fail(ErrorCode::invalid_argument, "joints and weights are not influence_count a point");
    if (!are_finite(mesh.rest_points) || !are_finite(mesh.weights))
        return fail(ErrorCode::not_finite, "a rest point or a weight is not finite");
    if (mesh.morph_targets.size() > kMaxMorphTargets) return fail(ErrorCode::too_large, "more than 65,535 morph targets");
    for (const MorphTarget& target : mesh.morph_targets)
        if (auto checked = check_target(target, point_count, number); !checked) return checked;
    return {};
}

/// f(point of the mesh, its delta), but for deltas of zero.
template <class Visit>
void visit_target(const MorphTarget& target, const Visit& visit) {
    for (size_t i = 0; i < target.deltas.size() / 3; ++i) {
        const float* delta = &target.deltas[3 * i];
        if (delta[0] != 0 || delta[1] != 0 || delta[2] != 0)
            visit(target.points.empty() ? static_cast<uint32_t>(i) : target.points[i], delta);
    }
}

Result<void> add_mesh_ranges(std::span<const SkinMesh> meshes, SkinTable& table) {
    uint64_t points = 0, influences = 0, morphs = 0;
    table.meshes.allocate(meshes.size());
    for (size_t m = 0; m < meshes.size(); ++m) {
        if (auto checked = check_mesh(meshes[m], m); !checked) return checked;
        const size_t count = meshes[m].rest_points.size() / 3;
        table.meshes[m] = {static_cast<uint32_t>(points), static_cast<uint32_t>(count), static_cast<uint32_t>(influences),
                           meshes[m].influence_count};
        points += count;
        influences += meshes[m].joints.size();
        for (const MorphTarget& target : meshes[m].morph_targets) visit_target(target, [&](auto...) { ++morphs; });
        if (points >= kMost || influences > kMost || morphs > kMost)
            return error_of(ErrorCode::too_large, "mesh", m, "2^32 points, influences or morphs of it and those before");
    }
    table.rest_points.allocate(3 * points);
    table.influences.allocate(influences);
    table.morph_offsets.assign(points + 1, 0);
    table.morphs.allocate(morphs);
    return {};
}

void add_mesh(const SkinMesh& mesh, const shared::SkinMeshRange& range, SkinTable& table) {
    std::copy(mesh.rest_points.begin(), mesh.rest_points.end(), table.rest_points.data() + size_t{3} * range.first_point);
    for (size_t i = 0; i < mesh.joints.size(); ++i)
        table.influences[range.first_influence + i] = {mesh.joints[i], mesh.weights[i]};
}

/// From targets, each over points, to points, each with its targets: counted, summed, filled in.
void add_morphs(std::span<const SkinMesh> meshes, SkinTable& table) {
    const auto visit = [&](const auto& use) {
        for (size_t m = 0; m < meshes.size(); ++m)
            for (size_t t = 0; t < meshes[m].morph_targets.size(); ++t)
                visit_target(meshes[m].morph_targets[t], [&](uint32_t point, const float* delta) {
                    use(table.meshes[m].first_point + point, static_cast<uint32_t>(t), delta);
                });
    };
    visit([&](uint32_t point, uint32_t, const float*) { ++table.morph_offsets[point + 1]; });
    std::partial_sum(table.morph_offsets.begin(), table.morph_offsets.end(), table.morph_offsets.begin());
    std::vector<uint32_t> next(table.morph_offsets.begin(), table.morph_offsets.end());
    visit([&](uint32_t point, uint32_t target, const float* delta) {
        table.morphs[next[point]++] = {target, {delta[0], delta[1], delta[2]}};
    });
}

/// As many as the largest joint of the mesh asks for.
uint64_t count_joints(const SkinMesh& mesh) {
    return mesh.joints.empty() ? 0 : uint64_t{1} + *std::max_element(mesh.joints.begin(), mesh.joints.end());
}

/// What instances have of points, matrices and weights.
Result<void> add_instances(std::span<const SkinMesh> meshes, std::span<const SkinInstance> instances, SkinTable& table) {
    std::vector<uint64_t> joint_counts;
    for (const SkinMesh& mesh : meshes) joint_counts.push_back(count_joints(mesh));
    const auto extend = [](uint32_t& count, uint64_t end) {
        count = std::max(count, static_cast<uint32_t>(std::min(end, kMost)));
        return end < kMost;
    };
    for (size_t i = 0; i < instances.size(); ++i) {
        const SkinInstance& instance = instances[i];
        if (instance.mesh >= meshes.size())
            return error_of(ErrorCode::index_out_of_range, "instance", i, "there is no such mesh");
        const uint64_t points = table.meshes[instance.mesh].point_count, joints = joint_counts[instance.mesh],
                       targets = meshes[instance.mesh].morph_targets.size();
        if (!extend(table.point_count, points == 0 ? 0 : instance.first_point + points) ||
            !extend(table.joint_count, joints == 0 ? 0 : instance.first_joint + joints) ||
            !extend(table.morph_weight_count, targets == 0 ? 0 : instance.first_morph_weight + targets))
            return error_of(ErrorCode::too_large, "instance", i, "its points, matrices or weights end past 2^32");
    }
    table.instances.allocate(instances.size());
    std::copy(instances.begin(), instances.end(), table.instances.begin());
    return {};
}

Result<void> check_apart(const SkinTable& table) {
    std::vector<uint32_t> order;
    for (uint32_t i = 0; i < table.instances.size(); ++i)
        if (table.meshes[table.instances[i].mesh].point_count != 0) order.push_back(i);
    std::sort(order.begin(), order.end(),
              [&](uint32_t a, uint32_t b) { return table.instances[a].first_point < table.instances[b].first_point; });
    for (size_t i = 1; i < order.size(); ++i) {
        const SkinInstance& before = table.instances[order[i - 1]];
        if (before.first_point + table.meshes[before.mesh].point_count > table.instances[order[i]].first_point)
            return error_of(ErrorCode::invalid_argument, "instance", order[i], "it shares points with another one");
    }
    return {};
}

struct Point {
    double x[3];
};

Point load_point(const float* p) {
    return {{p[0], p[1], p[2]}};
}

Point morph_point(const SkinTable& table, uint32_t point, uint64_t first_weight, std::span<const float> weights) {
    Point sum = load_point(&table.rest_points[size_t{3} * point]);
    for (uint32_t m = table.morph_offsets[point]; m < table.morph_offsets[point + 1]; ++m) {
        const shared::SkinMorph& morph = table.morphs[m];
        const double weight = weights[first_weight + morph.target];
        for (int i = 0; i < 3; ++i) sum.x[i] += weight * morph.delta[i];
    }
    return sum;
}

Point skin_point(const Point& point, std::span<const shared::SkinInfluence> influences, uint64_t first_joint,
                 std::span<const float> matrices) {
    Point sum = {};
    for (const shared::SkinInfluence& influence : influences) {
        const float* row = &matrices[12 * (first_joint + influence.joint)];
        for (int i = 0; i < 3; ++i, row += 4)
            sum.x[i] += influence.weight * (row[0] * point.x[0] + row[1] * point.x[1] + row[2] * point.x[2] + row[3]);
    }
    return sum;
}

}  // namespace

Result<SkinTable> build_skin_table(std::span<const SkinMesh> meshes, std::span<const SkinInstance> instances) {
    SkinTable table;
    if (meshes.size() > kMost || instances.size() > kMost)
        return Error{ErrorCode::too_large, "2^32 meshes or instances, or more"};
    if (auto added = add_mesh_ranges(meshes, table); !added) return added.error();
    if (auto added = add_instances(meshes, instances, table); !added) return added.error();
    if (auto checked = check_apart(table); !checked) return checked.error();
    for (size_t m = 0; m < meshes.size(); ++m) add_mesh(meshes[m], table.meshes[m], table);
    add_morphs(meshes, table);
    return table;
}

void skin_points(const SkinTable& table, const SkinPose& pose, std::span<double> points) {
    assert(pose.joint_matrices.size() / 12 >= table.joint_count && pose.morph_weights.size() >= table.morph_weight_count);
    assert(points.size() >= size_t{3} * table.point_count);
    for (const SkinInstance& instance : table.instances) {
        const shared::SkinMeshRange& mesh = table.meshes[instance.mesh];
        const uint32_t count = mesh.influence_count;
        for (uint32_t p = 0; p < mesh.point_count; ++p) {
            Point point = morph_point(table, mesh.first_point + p, instance.first_morph_weight, pose.morph_weights);
            if (count != 0)
                point = skin_point(point, {table.influences.data() + mesh.first_influence + size_t{p} * count, count},
                                   instance.first_joint, pose.joint_matrices);
            std::copy(point.x, point.x + 3, points.data() + 3 * (size_t{instance.first_point} + p));
        }
    }
}

}  // namespace limn
