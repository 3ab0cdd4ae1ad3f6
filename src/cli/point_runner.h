// Where commands evaluate points: a Vulkan device, or limn's own code on the host.
#pragma once

#include <optional>
#include <vector>

#include "cli/run_device.h"
#include "limn/stencil_table.h"
#include "limn/vulkan/evaluator.h"

namespace limn::cli {

struct LimitPoints {
    std::vector<float> positions, tangents1, tangents2;  ///< 3 per vertex
};

class PointRunner {
  public:
    /// `device` outlives the runner.
    static Result<PointRunner> create(const RunDevice& device);
    const std::string& name() const { return device_->name(); }

    /// Applies tables one after the other. `source`: tables[0].source_count points of `width` floats.
    Result<std::vector<float>> run(std::span<const StencilTable> tables, std::span<const float> source,
                                   uint32_t width) const;

    /// Applies a limit table with tangents to points of 3 floats.
    Result<LimitPoints> run_limits(const StencilTable& table, std::span<const float> source) const;

  private:
    const RunDevice* device_ = nullptr;
    std::optional<vk::Evaluator> evaluator_;
};

}  // namespace limn::cli
