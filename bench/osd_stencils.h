// OpenSubdiv's evaluators on the host, as stencil_eval_bench times them.
#pragma once

#include <memory>
#include <vector>

#include "candidate.h"
#include "osd.h"

namespace limn::bench {

enum class OsdEvaluator { cpu, omp };

/// `width`: 3, or 4 with padding, for which OpenSubdiv has loops of its own. omp runs on all cores.
Candidate make_osd_candidate(OsdEvaluator evaluator, const std::shared_ptr<const OsdTable>& table,
                             const std::vector<float>& positions, uint32_t width, double copy_rate);

/// Name and counts; `what`: cpu, omp or gl.
Candidate describe_osd_candidate(const std::string& what, const OsdTable& table, uint32_t width);

}  // namespace limn::bench
