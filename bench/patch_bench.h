// What patch_eval_bench and grid_eval_bench share: every candidate is verified at all samples, then timed.
#pragma once

#include <string>
#include <vector>

#include "bench.h"
#include "limn/evaluate.h"
#include "machines.h"
#include "models.h"
#include "patch_candidate.h"

namespace limn::bench {

/// One model: candidates run one after the other, so that only one of them takes memory.
class PatchBench {
  public:
    /// Evaluates the truth, in double. Rows are named `prefix` and then the candidate.
    PatchBench(const Options& options, const BenchModel& model, Report& report, std::string prefix,
               const PatchTableDouble& table, std::vector<PatchSample> samples);

    const std::vector<PatchSample>& samples() const { return samples_; }

    /// Verifies, fails where it is wrong, times, and adds a row.
    void run(const PatchCandidate& candidate);
    /// A row without times.
    void add_missing(const std::string& name, bool is_limn, const std::string& why);
    /// OpenSubdiv's evaluators on all machines, for points of three floats and padded to four.
    void run_osd(const Machines& machines);
    /// The best of limn on a device against the best of OpenSubdiv, and of its GL evaluator, which runs on
    /// the same kind of device.
    void finish();

  private:
    struct Measured {
        std::string name;
        bool is_limn;
        Timing timing;
    };
    /// Largest differences from the truth: of positions, as a share of the mesh's size; and of normals, in
    /// degrees, at nearly all samples and at all, where the truth is not degenerate.
    struct Difference {
        double position, most_normals, normal;
    };
    Difference compare(const PatchValues& values) const;
    void verify(const PatchCandidate& candidate, const Difference& difference) const;
    const Measured* find_best(bool is_limn, const char* prefix) const;

    const Options& options_;
    const BenchModel& model_;
    Report& report_;
    std::string prefix_;
    std::vector<PatchSample> samples_;
    std::vector<double> truth_;  ///< position, du, dv of each sample
    std::vector<Measured> measured_;
};

}  // namespace limn::bench
