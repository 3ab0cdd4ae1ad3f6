// What every scenario gets.
#pragma once

#include "machines.h"
#include "models.h"
#include "report.h"

namespace limn::bench {

struct Session {
    const Options& options;
    const Machines& machines;
    const std::vector<BenchModel>& models;
    Report& report;
};

}  // namespace limn::bench
