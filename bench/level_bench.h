// What stencil_eval_bench and osd_interop_bench share: the points of one level, by candidates that are verified, then timed.
#pragma once

#include <memory>

#include "candidate.h"
#include "osd.h"
#include "session.h"

namespace limn::bench {

/// One model at one level: verifies and times candidates one after the other, so that only one of them takes
/// memory.
class LevelBench {
  public:
    LevelBench(const Session& session, const char* scenario, const BenchModel& model, uint32_t level, double row_count);

    /// x y z of the level's points.
    void set_truth(std::vector<double> truth);
    void run(const Candidate& candidate);
    /// Times what could be made; says why it could not be.
    void run_or_say(const Result<Candidate>& candidate, const std::string& name, Side side);
    void add_missing(const std::string& name, Side side, const std::string& why);
    /// False where tables and points would take too much; a row says so.
    bool fits(const std::string& name, Side side, double bytes);

  private:
    const Session& session_;
    Row row_;
    std::vector<double> truth_;
    double tolerance_ = 0;
};

/// OpenSubdiv's evaluators of stencils: on one core, on all, by GL; points of three floats and padded to four.
void run_osd(const Session& session, const BenchModel& model, LevelBench& bench,
             const std::shared_ptr<const OsdTable>& table);

}  // namespace limn::bench
