// What patch_eval_bench and grid_eval_bench share: every candidate is verified at all samples, then timed.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "limn/evaluate.h"
#include "osd_samples.h"
#include "patch_candidate.h"
#include "session.h"

namespace limn::bench {

/// One model: candidates run one after the other, so that only one of them takes memory.
class PatchBench {
  public:
    /// Evaluates the truth, in double. Rows are like `row`, but for what a candidate says.
    PatchBench(const Session& session, const BenchModel& model, Row row, PatchTask task,
               const PatchTableDouble& table, std::vector<PatchSample> samples);

    const std::vector<PatchSample>& samples() const { return samples_; }

    /// Verifies, fails where it is wrong, times, and adds a row.
    void run(const PatchCandidate& candidate) { run(candidate, truth_); }
    /// The same of what evaluates OpenSubdiv's tables: it is verified against those, its distance from the limit noted.
    void run(const PatchCandidate& candidate, const OsdSamples& osd) { run(candidate, osd.values); }
    /// A row without times.
    void add_missing(const std::string& name, Side side, const std::string& why);
    /// OpenSubdiv's patches at the samples.
    OsdSamples find_osd() const;
    /// OpenSubdiv's evaluators on the host and, where `gl`, its GL evaluator; for points of three floats and
    /// padded to four.
    void run_osd(const OsdSamples& osd, bool gl = true);
    void run_osd(bool gl = true) { run_osd(find_osd(), gl); }

  private:
    /// Largest differences from what is right: of positions, as a share of the mesh's size; and of normals, in
    /// degrees, at nearly all samples and at all, where the truth is not degenerate.
    struct Difference {
        double position, most_normals, normal;
    };
    Difference compare(const PatchValues& values, const std::vector<double>& right) const;
    void verify(const PatchCandidate& candidate, const std::vector<double>& right) const;
    void run(const PatchCandidate& candidate, const std::vector<double>& right);

    const Session& session_;
    const BenchModel& model_;
    Row row_;
    PatchTask task_;
    std::vector<PatchSample> samples_;
    std::vector<double> truth_;  ///< the limit: position, du, dv of each sample
};

}  // namespace limn::bench
