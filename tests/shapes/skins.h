// Skins for tests: random influences and morph targets of given points, random poses, and the points in a pose computed
// from what the caller says, target after target, with no table in between.
#pragma once

#include <cmath>
#include <vector>

#include "limn/skinning.h"
#include "shapes/random_mesh.h"

namespace limn::test {

/// Owns what a SkinMesh refers to.
struct TestSkin {
    struct Target {
        std::vector<uint32_t> points;
        std::vector<float> deltas;
    };
    std::vector<float> rest_points;
    uint32_t influence_count = 0;
    std::vector<uint32_t> joints;
    std::vector<float> weights;
    std::vector<Target> targets;
    std::vector<MorphTarget> morph_targets;  ///< of `targets`: made by mesh()

    size_t point_count() const { return rest_points.size() / 3; }
    SkinMesh mesh() {
        morph_targets.clear();
        for (const Target& target : targets) morph_targets.push_back({target.points, target.deltas});
        return {rest_points, influence_count, joints, weights, morph_targets};
    }
};

/// Some targets dense, some of few points, one point twice. Weights of a point sum to one, but for rounding.
inline TestSkin make_skin(std::vector<float> rest_points, uint32_t influence_count, uint32_t joint_count,
                          uint32_t target_count, uint64_t seed) {
    RandomNumbers random(seed);
    TestSkin skin = {std::move(rest_points), influence_count, {}, {}, {}, {}};
    const auto point_count = static_cast<uint32_t>(skin.point_count());
    for (uint32_t p = 0; p < point_count; ++p) {
        std::vector<double> weights;
        double sum = 0;
        for (uint32_t k = 0; k < influence_count; ++k) sum += weights.emplace_back(random.uniform(0.1, 1));
        for (const double weight : weights) {
            skin.joints.push_back(random.below(joint_count));
            skin.weights.push_back(static_cast<float>(weight / sum));
        }
    }
    for (uint32_t t = 0; t < target_count; ++t) {
        TestSkin::Target& target = skin.targets.emplace_back();
        const bool dense = t % 2 == 0;
        if (!dense)
            for (uint32_t i = 0; i < point_count / 3 + 1; ++i) target.points.push_back(random.below(point_count));
        if (!dense) target.points.push_back(target.points[0]);
        target.deltas.resize(3 * (dense ? point_count : target.points.size()));
        for (float& x : target.deltas) x = static_cast<float>(random.uniform(-0.2, 0.2));
    }
    return skin;
}

/// Matrices that turn, stretch and move a little; weights between -1 and 1.
struct TestPose {
    std::vector<float> joint_matrices, morph_weights;
    SkinPose pose() const { return {joint_matrices, morph_weights}; }
};
inline TestPose make_pose(uint32_t joint_count, uint32_t weight_count, uint64_t seed) {
    RandomNumbers random(seed);
    TestPose pose;
    for (uint32_t j = 0; j < joint_count; ++j) {
        const double angle = random.uniform(-1, 1), size = random.uniform(0.9, 1.1);
        const double c = size * std::cos(angle), s = size * std::sin(angle);
        for (const double x : {c, -s, 0.1 * s, random.uniform(-1, 1), s, c, 0.0, random.uniform(-1, 1), 0.0, 0.1 * c, size,
                               random.uniform(-1, 1)})
            pose.joint_matrices.push_back(static_cast<float>(x));
    }
    for (uint32_t w = 0; w < weight_count; ++w) pose.morph_weights.push_back(static_cast<float>(random.uniform(-1, 1)));
    return pose;
}

/// 3 for each point of the mesh.
inline std::vector<double> skin_plainly(const TestSkin& skin, const TestPose& pose, uint32_t first_joint,
                                        uint32_t first_weight) {
    std::vector<double> morphed(skin.rest_points.begin(), skin.rest_points.end());
    for (size_t t = 0; t < skin.targets.size(); ++t)
        for (size_t i = 0; i < skin.targets[t].deltas.size(); ++i) {
            const size_t point = skin.targets[t].points.empty() ? i / 3 : skin.targets[t].points[i / 3];
            morphed[3 * point + i % 3] += double{pose.morph_weights[first_weight + t]} * skin.targets[t].deltas[i];
        }
    if (skin.influence_count == 0) return morphed;
    std::vector<double> skinned(morphed.size(), 0);
    for (size_t i = 0; i < skin.joints.size(); ++i) {
        const double* from = &morphed[3 * (i / skin.influence_count)];
        for (size_t row = 0; row < 3; ++row) {
            const float* m = &pose.joint_matrices[12 * (size_t{first_joint} + skin.joints[i]) + 4 * row];
            double x = m[3];
            for (int c = 0; c < 3; ++c) x += m[c] * from[c];
            skinned[3 * (i / skin.influence_count) + row] += skin.weights[i] * x;
        }
    }
    return skinned;
}

}  // namespace limn::test
