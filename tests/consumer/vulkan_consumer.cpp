// Names the devices, with limn::vulkan; having none is no failure of the package.
#include <cstdio>
#include <limn/vulkan/evaluator.h>

int main() {
    const auto devices = limn::vk::list_devices();
    if (!devices) return std::puts(devices.error().message.c_str()), 0;
    for (const limn::vk::DeviceInfo& device : *devices) std::puts(device.name.c_str());
    const auto context = limn::vk::Context::create();
    if (!context) return std::puts(context.error().message.c_str()), 0;
    return limn::vk::Evaluator::create(context->device()) ? 0 : 1;
}
