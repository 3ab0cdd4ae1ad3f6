// Tessellation on the CPU: the reference for kernels, and for files.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "limn/evaluate.h"
#include "limn/shared/tess_rate.h"
#include "limn/tessellation_table.h"

namespace limn {

enum class TessellationSpacing : uint8_t {
    integer = shared::kSpacingInteger,
    power_of_two = shared::kSpacingPowerOfTwo,
    /// Rates are real numbers of 2 or more; vertices come and go without a jump as they change.
    fractional = shared::kSpacingFractional,
};

/// What decides the rate of an edge. RateSettings::value is
enum class RateMode : uint8_t {
    uniform = shared::kRateUniform,             ///< the rate of all edges
    per_edge = shared::kRatePerEdge,            ///< not used: the caller gives a rate for each rate edge
    screen_length = shared::kRateScreenLength,  ///< how long a segment should be on screen, in pixels
    pixel_error = shared::kRatePixelError,      ///< by how many pixels a chord may miss the surface
    chord_error = shared::kRateChordError,      ///< by what length a chord may miss the surface
    distance = shared::kRateDistance,  ///< the distance (clip w) at which the rate is 1; it is 2 at half of that
};

/// A camera: from points to Vulkan's clip space.
struct Camera {
    /// Column-major: clip[i] = sum over j of matrix[4 * j + i] * point[j], point[3] = 1. The depth range is 0 .. w.
    float matrix[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    float width = 1, height = 1;  ///< of the viewport, in pixels
};

struct RateSettings {
    RateMode mode = RateMode::uniform;
    float value = 8;
    TessellationSpacing spacing = TessellationSpacing::integer;
    uint32_t max_rate = 64;  ///< 2 .. 128 segments of an edge, and of sub-face edges half of that; not more than
                             ///< PatchTreeOptions::max_rate
    Camera camera = {};      ///< of modes that look through it, and of culling
    /// Leave out what lies outside the camera's frustum; what faces away from it. Rates, and with them all edges
    /// between what is drawn, are the same as without. Displacement may move the surface by `bound`.
    bool cull_outside = false;
    bool cull_backfaces = false;
    float bound = 0;
};

/// Errors: invalid_argument (value, max_rate), not_finite (camera), each with a message.
Result<void> check_rate_settings(const RateSettings& settings);

/// Rates in fixed point, kRateOne = 1: what each rate edge has, or each half of it where it has halves. 0 where
/// the mode's rate is not positive, or no number. `points`: build_patch_points, width 3. `edge_rates`: one per
/// rate edge in mode per_edge, else empty. Rates are multiplied by `scale` before they are rounded.
Result<std::vector<uint32_t>> compute_rates(const PatchTable& patches, const TessellationTable& table,
                                            const RateSettings& settings, std::span<const double> points,
                                            std::span<const float> edge_rates = {}, double scale = 1);

/// Vertices and triangles of a tessellation, before they have positions. A face one of whose edges has rate 0 is
/// left out.
struct Tessellation {
    std::vector<PatchSample> places;        ///< of each vertex
    std::vector<uint32_t> position_sources; ///< whose position each vertex has: itself, or the one it copies
    std::vector<uint32_t> indices;          ///< 3 per triangle, counter-clockwise as the control mesh is
    std::vector<uint32_t> triangle_faces;   ///< the ptex face of each triangle
    uint32_t vertex_count() const { return static_cast<uint32_t>(places.size()); }
};
/// How many there will be: closed forms of the rates, in time linear in the faces. `rates`: one per rate edge.
struct TessellationCounts {
    uint64_t vertices = 0, triangles = 0;
};
TessellationCounts count_tessellation(const TessellationTable& table, std::span<const uint32_t> rates,
                                      TessellationSpacing spacing);

/// Errors: invalid_argument (fewer rates than edges), too_large (2^32 vertices or indices).
Result<Tessellation> tessellate(const TessellationTable& table, std::span<const uint32_t> rates,
                                TessellationSpacing spacing);

/// Positions and, unless empty, unit normals: 3 per vertex, in double. `points` as in compute_rates.
void evaluate_tessellation(const PatchTable& patches, const Tessellation& tessellation,
                           std::span<const double> points, std::span<double> positions, std::span<double> normals);

/// The displaced surface: vertex i moves along its normal by heights[3 * i]; heights[3 * i + 1] and + 2 are how that
/// changes with u and v of the ptex face of its place. `step`: of the differences that normals are made of
/// (limn/shared/tess_steps.h), step_size(max_rate) on devices.
void displace_tessellation(const PatchTable& patches, const Tessellation& tessellation, std::span<const double> points,
                           std::span<const double> heights, double step, std::span<double> positions,
                           std::span<double> normals);

/// Values of a face-varying channel, whose seams the table was built with: width per vertex. `points`: of the
/// channel's own table.
void evaluate_tessellation_channel(const PatchTable& channel, const Tessellation& tessellation,
                                   std::span<const double> points, uint32_t width, std::span<double> values);

}  // namespace limn
