// The limit surface on the CPU, in double: the reference for kernels.
#pragma once

#include <cstdint>
#include <span>

#include "limn/patch_table.h"

namespace limn {

/// A place on the surface: `face` is the ptex face, (u, v) in the unit square (Loop: the triangle u + v <= 1)
/// with (0, 0) at the face's (for other than the scheme's own size: the corner's) vertex and u along the edge
/// to the next one.
struct PatchSample {
    uint32_t face;
    double u, v;
};

enum class SampleStatus : uint8_t {
    valid,
    hole,          ///< the face is not part of the surface
    out_of_range,  ///< no such ptex face, or (u, v) not within it or not finite
};

/// How much evaluate_patches writes for each sample.
enum class Derivatives : uint8_t { none, first, second };

/// Values per sample and component: 1, 3 or 6, in the order value, du, dv, duu, duv, dvv.
inline uint32_t value_count(Derivatives derivatives) {
    return derivatives == Derivatives::none ? 1 : derivatives == Derivatives::first ? 3 : 6;
}

/// Evaluates the surface at each sample, in double, with the weights of the table. `points`:
/// table.point_count() * width values, control points followed by those that build_patch_points makes of
/// them. Sample s's value k, component i goes to results[(s * value_count + k) * width + i]; where the status
/// is not valid all are zero. Derivatives are with respect to the ptex face's u and v. Exactly at an
/// extraordinary vertex, where they do not exist or vanish, du and dv are two limit tangents (their lengths
/// carry no meaning, du x dv points along the normal) and second derivatives are zero.
template <class Real>
void evaluate_patches(const BasicPatchTable<Real>& table, std::span<const PatchSample> samples,
                      std::span<const double> points, uint32_t width, Derivatives derivatives,
                      std::span<double> results, std::span<SampleStatus> statuses);

/// Where a sample is: the surface, and the node (of the plan's, counted from Plan::first_node) in whose
/// coordinates it is at (u, v). Exactly at an extraordinary vertex the node is the root of the plan, whose
/// corner 0 that is.
struct SurfacePlace {
    uint32_t surface, plan, node;
    double u, v;
};

/// places[s] is that of samples[s], all zero where the status is not valid.
template <class Real>
void locate_patches(const BasicPatchTable<Real>& table, std::span<const PatchSample> samples,
                    std::span<SurfacePlace> places, std::span<SampleStatus> statuses);

/// Control points -> control points and level-1 points: point_count() * width values.
template <class Real>
void build_patch_points(const BasicPatchTable<Real>& table, std::span<const double> control_points,
                        uint32_t width, std::span<double> points);

}  // namespace limn
