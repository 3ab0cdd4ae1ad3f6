// limn devices: what Vulkan offers.
#include "cli/program.h"
#include "limn/vulkan/context.h"

namespace limn::cli {
namespace {

const char* type_name(VkPhysicalDeviceType type) {
    switch (type) {
        case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
            return "discrete GPU";
        case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
            return "integrated GPU";
        case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
            return "virtual GPU";
        case VK_PHYSICAL_DEVICE_TYPE_CPU:
            return "CPU";
        default:
            return "other";
    }
}

int run() {
    const auto devices = vk::list_devices();
    if (!devices) return fail(devices.error());
    for (const vk::DeviceInfo& device : *devices)
        std::printf("%u  %s (%s), Vulkan %u.%u%s\n", device.index, device.name.c_str(),
                    type_name(device.type), VK_API_VERSION_MAJOR(device.api_version),
                    VK_API_VERSION_MINOR(device.api_version),
                    device.usable ? "" : "  not usable: needs Vulkan 1.2 and a compute queue");
    return 0;
}

}  // namespace

void add_devices(CLI::App& program, int& status) {
    CLI::App* command = program.add_subcommand("devices", "List the Vulkan devices that --device takes");
    command->callback([&status] { status = run(); });
}

}  // namespace limn::cli
