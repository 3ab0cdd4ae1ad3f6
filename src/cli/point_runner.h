// Where commands evaluate points: a Vulkan device, or limn's own code on the host.
#pragma once

#include <optional>
#include <vector>

#include "cli/program.h"
#include "limn/stencil_table.h"
#include "limn/vulkan/evaluator.h"

namespace limn::cli {

struct LimitPoints {
    std::vector<float> positions, tangents1, tangents2;  ///< 3 per vertex
};

class PointRunner {
  public:
    static Result<PointRunner> create(const DeviceOption& option);

    /// Name of the device, or "the host".
    const std::string& name() const { return name_; }
    bool is_host() const { return !context_.has_value(); }

    /// Applies tables one after the other. `source`: tables[0].source_count points of `width` floats.
    Result<std::vector<float>> run(std::span<const StencilTable> tables, std::span<const float> source,
                                   uint32_t width) const;

    /// Applies a limit table with tangents to points of 3 floats.
    Result<LimitPoints> run_limits(const StencilTable& table, std::span<const float> source) const;

    /// An error when the validation layer had anything to say.
    Result<void> check_validation() const;

  private:
    std::string name_ = "the host";
    std::optional<vk::Context> context_;
    std::optional<vk::Evaluator> evaluator_;
};

}  // namespace limn::cli
