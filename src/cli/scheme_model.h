// Models under the schemes that have no patches: refined evenly, by tables (limn/schemes/scheme_surface.h).
#pragma once

#include <optional>
#include <vector>

#include "cli/program.h"
#include "cli/run_device.h"
#include "limn/schemes/scheme_surface.h"
#include "limn/vulkan/scheme_evaluator.h"

namespace limn::cli {

/// The scheme that is asked for where it is none of those with patches (scheme_names); else null.
const SubdivisionScheme* scheme_without_patches(const SurfaceOptions& options);
/// And where it has none of this model: Doo-Sabin patches reach to no boundary. Null where the file cannot be read.
const SubdivisionScheme* scheme_drawn_evenly(const std::string& path, const SurfaceOptions& options);
/// The scheme that is asked for where the levels of refinement.h are not its own; else null.
const SubdivisionScheme* scheme_without_refinement(const SurfaceOptions& options);

/// Says on standard error what of the model a scheme leaves out: creases; and what tables without patches do.
void note_creases_left_out(const std::string& path, const LoadedModel& model, const SubdivisionScheme& scheme,
                           Progress& progress);
void note_left_out(const std::string& path, const LoadedModel& model, const SubdivisionScheme& scheme,
                   Progress& progress);

/// Steps for a rate, no more than kMostSchemeTriangles allows. Errors: too_large where even one step is too much.
inline constexpr uint64_t kMostSchemeTriangles = uint64_t{1} << 25;
Result<uint32_t> steps_within_reason(const LoadedModel& model, const SubdivisionScheme& scheme, double rate);

/// What the scheme takes at corners: knot intervals of the model's tags, or angles between its edges. Errors: missing_edge.
Result<std::vector<double>> corner_values_of(const LoadedModel& model, const SubdivisionScheme& scheme);

/// Errors name the model.
Result<SchemeSurface> build_model_surface(const std::string& path, const LoadedModel& model,
                                          const SubdivisionScheme& scheme, uint32_t level, Progress& progress);

/// Positions and normals on the device, or the host.
Result<SchemeVertices> run_scheme_surface(const RunDevice& device, const SchemeSurface& surface,
                                          std::span<const float> points);

/// Texture coordinates of the last level's corners, linear within the faces of the control mesh: for schemes that split
/// faces in four. Nothing where the model has none, or the scheme splits otherwise.
struct RefinedTexture {
    std::vector<float> values;          ///< 2 per value
    std::vector<uint32_t> face_values;  ///< one per corner
};
Result<RefinedTexture> refine_texture(const LoadedModel& model, const SubdivisionScheme& scheme, uint32_t level);

}  // namespace limn::cli
