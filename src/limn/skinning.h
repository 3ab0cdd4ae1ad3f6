// What moves control points: morph targets and joints. A table of both for meshes and their instances, made once; and
// the points in a pose on the CPU, in double: the reference for kernels. limn/vulkan/skinning.h does it every frame.
#pragma once

#include <cstdint>
#include <span>

#include "limn/array.h"
#include "limn/result.h"
#include "limn/shared/skin_params.h"

namespace limn {

inline constexpr uint32_t kMaxInfluences = 8;
inline constexpr uint32_t kMaxMorphTargets = 65'535;

/// Where points of a mesh go when a target's weight is 1, relative to where they rest: point points[i] by deltas[3 * i ..].
/// Without `points` the target is dense, point i by deltas[3 * i ..]; with neither it moves nothing. Targets add up.
struct MorphTarget {
    std::span<const uint32_t> points;  ///< in any order; a point that is there twice moves by both
    std::span<const float> deltas;     ///< 3 for each
};

/// Control points of a mesh at rest, and what moves them. The arrays are the caller's; they are read only while a table is
/// built. Influence k of point p is joint joints[p * influence_count + k], by weights[p * influence_count + k]: weights of
/// a point should sum to one, and are taken as they are. A point of fewer influences is filled up with weights of 0.
struct SkinMesh {
    std::span<const float> rest_points;  ///< 3 for each
    uint32_t influence_count = 0;        ///< of each point, up to kMaxInfluences; 0: no joint moves the mesh
    std::span<const uint32_t> joints;    ///< of the mesh, from 0 on
    std::span<const float> weights;
    std::span<const MorphTarget> morph_targets;  ///< up to kMaxMorphTargets
};

/// A mesh in a pose of its own: `mesh` is its number, `first_point` where its control points are among those of the batch
/// (PatchBatchMesh::control_points.first), `first_joint` its first matrix, `first_morph_weight` its first weight.
using SkinInstance = shared::SkinInstance;

/// Meshes, each once however many instances it has, and instances. Indices: limn/shared/skin_params.h.
struct SkinTable {
    uint32_t point_count = 0;         ///< up to the last point that an instance has
    uint32_t joint_count = 0;         ///< as many matrices a pose has at least
    uint32_t morph_weight_count = 0;  ///< as many weights a pose has at least
    Array<shared::SkinMeshRange> meshes;
    Array<SkinInstance> instances;
    Array<float> rest_points;  ///< 3 for each point of each mesh
    Array<shared::SkinInfluence> influences;
    Array<uint32_t> morph_offsets;    ///< morphs of point p are [morph_offsets[p], morph_offsets[p + 1]), by target
    Array<shared::SkinMorph> morphs;  ///< but for deltas of zero
};

/// Instances may lie in any order, with gaps between them. Errors: invalid_argument (lengths that do not agree,
/// influence_count; the element is the mesh; instances that share points: the element is one of them);
/// index_out_of_range (a target's point: the element is the mesh; an instance's mesh: the instance); not_finite (the
/// element is the mesh); too_large (2^32 points, influences, morphs, matrices or weights, more than kMaxMorphTargets).
Result<SkinTable> build_skin_table(std::span<const SkinMesh> meshes, std::span<const SkinInstance> instances);

/// Matrices take points of the mesh, at rest, to where the joint has them: joint_to_mesh * inverse bind matrix, 12 floats,
/// three rows of four. At least as many as the table says, of both.
struct SkinPose {
    std::span<const float> joint_matrices;
    std::span<const float> morph_weights;
};

/// Point p of an instance, in double: r = rest + sum over morph targets t of weight[t] * delta[t]; where the mesh has
/// influences, the sum over k of weight[k] * (matrix[joint[k]] * r), else r. It goes to points[3 * (first_point + p) ..];
/// `points` has 3 * table.point_count elements, and keeps those that are no instance's.
void skin_points(const SkinTable& table, const SkinPose& pose, std::span<double> points);

}  // namespace limn
