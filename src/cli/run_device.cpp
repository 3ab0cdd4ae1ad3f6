#include "cli/run_device.h"

namespace limn::cli {

Result<RunDevice> RunDevice::create(const DeviceOption& option) {
    RunDevice device;
    if (option.device == "cpu") return device;
    vk::ContextOptions options;
    options.validation = option.validation;
    if (option.device != "auto") options.device_index = static_cast<uint32_t>(std::stoul(option.device));
    Result<vk::Context> context = vk::Context::create(options);
    if (!context) return context.error();
    device.context_.emplace(std::move(*context));
    device.name_ = device.vulkan()->name();
    return device;
}

Result<void> RunDevice::check_validation() const {
    if (!context_ || context_->validation_message_count() == 0) return {};
    return Error{ErrorCode::vulkan_failure,
                 plural(context_->validation_message_count(), "validation message") +
                     ", the first: " + context_->first_validation_message()};
}

}  // namespace limn::cli
