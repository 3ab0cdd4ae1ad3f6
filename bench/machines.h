// Where candidates run: limn's Vulkan device, the host's cores, OpenSubdiv's GL context; and how fast each
// copies.
#pragma once

#include "bench.h"
#include "limn/vulkan/context.h"
#include "osd_gl.h"
#include "report.h"

namespace limn::bench {

struct Machines {
    vk::Context context;
    Result<GlContext> gl;
    struct CopyRates {
        double device, host, host_all_cores, gl;  ///< bytes per second that a plain copy reads and writes
    } copy;

    const vk::Device& device() const { return context.device(); }
    /// What a report says before its rows.
    ReportData header(bool quick) const;
};

/// Fails without a Vulkan device.
Machines open_machines(const Options& options);

}  // namespace limn::bench
