#include "machines.h"

#include <algorithm>
#include <thread>

#include "host.h"
#include "limn_stencils.h"

namespace limn::bench {
namespace {

std::string gigabytes(double rate) {
    return format("%.1f GB/s", rate / 1e9);
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

ReportData Machines::header(bool quick) const {
    ReportData data;
    data.cache_bytes = last_level_cache_bytes();
    data.device_copy_rate = copy.device;
    data.quick = quick;
    data.facts = {
        {"device", device_description(device())},
        {"peer GL", gl ? gl->description() : "n/a: " + gl.error().message},
        {"copies", "device " + gigabytes(copy.device) + ", one core " + gigabytes(copy.host) +
                       ", all cores " + gigabytes(copy.host_all_cores) + ", GL " + gigabytes(copy.gl)},
        {"host", processor_name()},
        {"cores", std::to_string(std::thread::hardware_concurrency())},
        {"cache", data.cache_bytes != 0
                      ? format("%.4g MiB, last level", static_cast<double>(data.cache_bytes) / (1 << 20))
                      : "unknown"},
        {"compiler", compiler_name()},
        {"commit", commit_name()},
        {"date", date_text()}};
    return data;
}

}  // namespace limn::bench
