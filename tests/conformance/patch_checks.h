// limn's limit surface, evaluated in double, compared with OpenSubdiv and with itself across borders.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "conformance/osd_oracle.h"
#include "conformance/osd_patch_oracle.h"
#include "conformance/vectors.h"
#include "limn/evaluate.h"
#include "limn/topology.h"
#include "shapes/shapes.h"

namespace limn::test {

// Lengths are relative to the largest side of the bounding box; first derivatives at depth d also to 2^d,
// second ones to 4^d.
inline constexpr double kSurfaceTolerance = 1e-11;
// OpenSubdiv keeps the sharpness of edges, and the share of a rule that is fading, in float.
inline constexpr double kFadingSurfaceTolerance = 1e-7;
// Of the size of the end cap. Gregory patches put points elsewhere along the surface (by 5 % of their size at
// small valences, by more where rings shrink slowly), and hardly off it.
inline constexpr double kCapTolerance = 0.3;
inline constexpr double kCapNormalTolerance = 0.12;
inline constexpr double kBfrTolerance = 5e-5;
inline constexpr double kBorderTolerance = 1e-12;
inline constexpr double kBorderAngle = 0.01;  // degrees

// A surface of limn's with what is needed to evaluate and to name places on it.
struct SurfaceUnderTest {
    const TestMesh& mesh;
    Topology base;
    PatchTableDouble table;
    std::vector<double> control_points, points;
    double size = 1;
    bool triangles = false;
    struct PtexFace {
        uint32_t face, corner;
        bool whole;  // the ptex face is the face; else its corner's part
    };
    std::vector<PtexFace> ptex_faces;
    std::vector<uint32_t> first_ptex;  // of each face

    SurfaceUnderTest(const TestMesh& mesh, bool compatible);

    struct Values {
        uint32_t count;               // per sample: P, du, dv and, of second derivatives, duu, duv, dvv
        std::vector<double> numbers;  // 3 * count per sample
        std::vector<SampleStatus> statuses;
        Vector at(size_t sample, size_t value) const { return vector_at(numbers, count * sample + value); }
        Vector normal(size_t sample) const { return cross(at(sample, 1), at(sample, 2)); }
        // Sine of the angle between the tangents.
        double sine(size_t sample) const;
    };
    Values evaluate(std::span<const PatchSample> samples, Derivatives derivatives) const;

    // The place on the edge that begins at corner c of face f, at t from there.
    PatchSample place_on_edge(uint32_t f, uint32_t c, double t) const;
};

// Meshes of many faces have many alike: every how manieth of `count` is looked at.
inline uint32_t stride_of(uint32_t count) {
    return 1 + count / 300;
}

// Places all over, half of them within 2^-13 .. 1 of the ptex faces' corners.
std::vector<PatchSample> scattered_places(uint32_t ptex_face_count, bool triangles, uint64_t seed);

// Every corner of every face of a uniform refinement: its vertex, and where it is on the base face.
struct RefinedCorner {
    uint32_t vertex;
    PatchSample place;
};
std::vector<RefinedCorner> refined_corners(const OsdOracle& oracle, bool triangles);

// The comparisons. Differences are failures; `worst` keeps the largest ones, `left_out` counts what they do
// not look at, by name.
struct PatchCheckLog {
    double regular[6] = {};   // by value, in the units of kSurfaceTolerance
    double cap_position = 0;  // of the cap's size
    double cap_off_surface = 0;
    double cap_normal = 0;  // of the bound
    double bfr = 0, limits = 0, limit_normal = 0, border = 0, border_normal = 0;
    uint64_t regular_count = 0, cap_count = 0, cap_normal_count = 0, bfr_count = 0, limit_count = 0,
             limit_normal_count = 0, border_count = 0, border_normal_count = 0;
};
PatchCheckLog& patch_check_log(bool exact);
void leave_out(const std::string& name, uint64_t count = 1);
void print_patch_check_log();

// Degrees by which limn's normal may be off at smooth vertices, extraordinary or not.
inline constexpr double kLimitNormalTolerance = 1e-5, kFadingLimitNormalTolerance = 1e-3;

// Building blocks, public so that tests can show them to be able to fail.
testing::AssertionResult same_regular_places(const SurfaceUnderTest& surface,
                                             const SurfaceUnderTest::Values& ours,
                                             std::span<const OsdPlace> theirs, double tolerance,
                                             PatchCheckLog& log);
testing::AssertionResult near_caps(const SurfaceUnderTest& surface, std::span<const PatchSample> samples,
                                   const SurfaceUnderTest::Values& ours, std::span<const OsdPlace> theirs,
                                   PatchCheckLog& log);
testing::AssertionResult near_bfr(const SurfaceUnderTest& surface, const SurfaceUnderTest::Values& ours,
                                  std::span<const OsdPlace> far, std::span<const OsdPlace> bfr,
                                  PatchCheckLog& log);
testing::AssertionResult same_borders(const SurfaceUnderTest& surface, const SurfaceUnderTest::Values& one,
                                      const SurfaceUnderTest::Values& other, std::span<const uint8_t> smooth,
                                      PatchCheckLog& log);

}  // namespace limn::test
