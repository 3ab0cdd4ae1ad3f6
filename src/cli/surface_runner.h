// Where commands evaluate the limit surface at samples: a Vulkan device, or limn's own code on the host.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "cli/run_device.h"
#include "limn/vulkan/curvature.h"
#include "limn/vulkan/surface_evaluator.h"

namespace limn::cli {

/// A place as devices take it: samples of vk::SampleBuffer are these words.
struct SurfaceSample {
    uint32_t face;  ///< ptex face
    float u, v;
};

/// As evaluate_patches writes it: value_count(derivatives) * width numbers for each sample, zeros where the
/// status is not valid.
struct SurfaceValues {
    std::vector<float> numbers;
    std::vector<SampleStatus> statuses;
    /// What else was asked for: shared::kCurvatureFloats numbers for each sample, in the order of Curvature's
    /// members.
    std::vector<float> curvatures;
};

/// A patch table with its points, where they are evaluated.
struct RunSurface {
    const PatchTable* table = nullptr;
    uint32_t width = 0;
    std::vector<double> host_points;  ///< of the host
    vk::DevicePatchTable patches;     ///< of a device
    vk::Buffer points;
};

class SurfaceRunner {
  public:
    /// `device` outlives the runner and its surfaces.
    static Result<SurfaceRunner> create(const RunDevice& device);
    const std::string& name() const { return device_->name(); }

    /// Makes the level-1 points from `control_points`, table.control_count points of 1 to 4 floats; vertex
    /// data or values of a face-varying channel, as the table is. `table` outlives the surface.
    Result<RunSurface> prepare(const PatchTable& table, std::span<const float> control_points,
                               uint32_t width) const;

    /// Any number of samples: what devices hold at once is bounded. Curvature: of points of three components,
    /// with second derivatives.
    Result<SurfaceValues> run(const RunSurface& surface, std::span<const SurfaceSample> samples,
                              Derivatives derivatives, bool curvature = false) const;

  private:
    Result<void> run_pass(const RunSurface& surface, std::span<const SurfaceSample> samples,
                          Derivatives derivatives, bool curvature, SurfaceValues& out) const;

    const RunDevice* device_ = nullptr;
    std::optional<vk::SurfaceEvaluator> evaluator_;
    std::optional<vk::CurvatureEvaluator> curvature_;
};

}  // namespace limn::cli
