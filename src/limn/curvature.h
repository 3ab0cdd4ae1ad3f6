// Curvatures of the limit surface, from the derivatives that evaluation gives: on the CPU, in double, the
// reference for devices.
#pragma once

#include <cstdint>
#include <span>

#include "limn/result.h"
#include "limn/shared/curvature_params.h"

namespace limn {

/// How the surface bends at a place, in the space of its points. Normal curvatures are positive where it
/// bends away from its normal, du x dv: of a sphere of radius r, faces counter-clockwise seen from outside, 1
/// / r. They do not depend on how the surface is parameterised.
struct Curvature {
    double gaussian;       ///< first * second; negative at a saddle
    double mean;           ///< (first + second) / 2
    double first, second;  ///< the principal curvatures, first >= second
    /// Unit tangents along which they are reached, first_direction x second_direction along the normal. Where
    /// both curvatures are equal (an umbilic) any would do: the first is along du.
    double first_direction[3], second_direction[3];
};

/// The curvature of each sample from its six values, as evaluate_patches (Derivatives::second) gives them:
/// component i of value k of sample s is values[(s * 6 + k) * width + i]. Width 3; of width 4 they are
/// homogeneous (x, y and z times a weight, and the weight), divided first. Precondition: values of as many
/// samples as curvatures.
///
/// All of a curvature is zero where there is none: where du and dv have no length or are parallel to 1e-6 (a
/// sample that is not valid, for one), and where a weight is 0. Exactly at an extraordinary vertex, where
/// second derivatives are given as zero, curvatures are zero, too; beside it they are right, and may grow
/// without bound as it comes closer.
void evaluate_curvature(std::span<const double> values, uint32_t width, std::span<Curvature> curvatures);

}  // namespace limn
