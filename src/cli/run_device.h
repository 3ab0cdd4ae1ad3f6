// What --device chose: a Vulkan device, or the host.
#pragma once

#include <optional>
#include <string>

#include "cli/program.h"
#include "limn/vulkan/context.h"

namespace limn::cli {

/// Outlives the runners and all else that is made from its device.
class RunDevice {
  public:
    static Result<RunDevice> create(const DeviceOption& option);

    /// Name of the device, or "the host".
    const std::string& name() const { return name_; }
    bool is_host() const { return !context_.has_value(); }
    /// Null for the host. Moving this does not move the device.
    const vk::Device* vulkan() const { return context_ ? &context_->device() : nullptr; }

    /// An error when the validation layer had anything to say.
    Result<void> check_validation() const;

  private:
    std::string name_ = "the host";
    std::optional<vk::Context> context_;
};

}  // namespace limn::cli
