#include "machines.h"

#include <algorithm>
#include <cstdio>
#include <thread>

#include "limn_stencils.h"

namespace limn::bench {
namespace {

std::string gigabytes(double rate) {
    char text[32];
    std::snprintf(text, sizeof text, "%.1f GB/s", rate / 1e9);
    return text;
}

}  // namespace

Machines open_machines(const Options& options) {
    Machines machines{value_or_fail(options, vk::Context::create({.device_index = options.device_index,
                                                                  .validation = false})),
                      GlContext::create(),
                      {}};
    machines.copy = {
        .device = value_or_fail(options, measure_device_copy(options, machines.device())),
        .host = measure_host_copy(options, 1),
        .host_all_cores = measure_host_copy(options, std::max(1u, std::thread::hardware_concurrency())),
        .gl = machines.gl ? machines.gl->measure_copy(options) : 0};
    return machines;
}

Report::Facts Machines::facts() const {
    return {{"device", device_description(device())},
            {"peer GL", gl ? gl->description() : "n/a: " + gl.error().message},
            {"copies", "device " + gigabytes(copy.device) + ", one core " + gigabytes(copy.host) +
                           ", all cores " + gigabytes(copy.host_all_cores) + ", GL " + gigabytes(copy.gl)}};
}

}  // namespace limn::bench
