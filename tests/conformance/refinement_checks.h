// Everything that limn's refinement and stencil tables say about a mesh, compared with OpenSubdiv.
#pragma once

#include <gtest/gtest.h>

#include <span>
#include <vector>

#include "conformance/osd_oracle.h"
#include "limn/refinement.h"
#include "limn/stencil_table.h"
#include "shapes/shapes.h"

namespace limn::test {

// Tolerances, relative to the largest side of the bounding box (weights: absolute).
inline constexpr double kDoubleTolerance = 1e-12;
inline constexpr double kFloatWeightTolerance = 1e-6;
// OpenSubdiv takes the share of a rule that is fading out from float arithmetic, and 1/6 from a float
// constant in the limits of face-varying creases.
inline constexpr double kFadingTolerance = 1e-7;
inline constexpr double kFaceVaryingLimitTolerance = 1e-7;
// Sine of the angle between normals.
inline constexpr double kNormalTolerance = 1e-9;
inline constexpr double kFadingNormalTolerance = 1e-5;

// The building blocks. Each reports the first and the worst difference. They are public so that tests can
// show them to be able to fail.
testing::AssertionResult same_numbers(std::span<const double> ours, std::span<const double> theirs,
                                      double tolerance);
testing::AssertionResult same_indices(std::span<const uint32_t> ours, std::span<const uint32_t> theirs);
testing::AssertionResult same_rows(std::span<const SparseRow> ours, std::span<const SparseRow> theirs,
                                   double tolerance, double* worst = nullptr);
// Compares directions of tangents1 x tangents2 for the vertices where `compared` is 1 and neither product
// vanishes.
testing::AssertionResult same_normals(const OsdOracle::Limits& ours, const OsdOracle::Limits& theirs,
                                      std::span<const uint8_t> compared, double tolerance,
                                      double* worst = nullptr);
testing::AssertionResult same_topology(const Topology& ours, const OsdOracle& theirs, uint32_t level);

// Array sizes agree, indices are within range and not repeated in a row, weights sum to one.
testing::AssertionResult well_formed(const StencilTable& table);
testing::AssertionResult well_formed(const StencilTableDouble& table);
// Rows as sorted maps; zeros are left out.
std::vector<SparseRow> rows_of(const StencilTable& table);
std::vector<SparseRow> rows_of(const StencilTableDouble& table);

// Points of every level, one step table after the other; level 0 is the input.
std::vector<std::vector<double>> refine_by_steps(const Refinement& refinement,
                                                 std::span<const double> control_values, uint32_t width,
                                                 Interpolation interpolation);
std::vector<double> apply(const StencilTableDouble& table, std::span<const double> source, uint32_t width);
// Positions and tangents of the last level.
OsdOracle::Limits apply_limit_table(const StencilTableDouble& table, std::span<const double> control_points);

// True where OpenSubdiv's float arithmetic on sharpness rounds: not so for sums and halves of small multiples
// of 1/16.
bool has_inexact_fading(const TestMesh& mesh);

// The worst differences seen, for the log: of meshes where OpenSubdiv's arithmetic on sharpness is exact, and
// of others.
struct WorstErrors {
    double points = 0, rows = 0, face_varying = 0, limits = 0, face_varying_limits = 0, normals = 0;
};
WorstErrors& worst_errors(bool exact);
void print_worst_errors();

struct CheckLimits {
    uint32_t max_level = 5;
    uint64_t max_vertices = 200000;    // of the last level refined
    uint64_t max_stencil_rows = 3000;  // of the last level whose rows are compared one by one
    uint32_t max_face_varying_level = 4;
};

// The comparisons; differences are failures of the running test. The mesh is taken with opensubdiv_compatible
// on for exact agreement, and off with the known deviations of OpenSubdiv left out, which are
//   - limits at vertices where one infinitely sharp edge ends (it uses the smooth mask),
//   - limits at interior Catmull-Clark vertices of two faces (it uses the corner mask),
//   - normals at creases and boundaries that are not regular (its masks belong to other rules),
//   - normals at corners (it takes the first two edges, limn the first sector),
//   - limits of bilinear face-varying channels along seams (it smooths them; in both modes limn does not),
//   - Chaikin creasing where an edge of sharpness above 1 has a smooth child (it extrapolates).
void check_against_oracle(const TestMesh& mesh, const CheckLimits& limits);

}  // namespace limn::test
