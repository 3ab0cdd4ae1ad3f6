// What benchmarks measured: one row for each way to do each task, printed as they come and kept for files.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench.h"

namespace limn::bench {

enum class Side : uint8_t {
    limn,
    peer,  ///< OpenSubdiv, or a plain loop: evaluators whose names start with "loop"
};

/// Whether what a frame touches fits in the last level of the host's cache.
enum class CacheClass : uint8_t { unknown, below, above };

/// One evaluator at one task. Rows with equal scenario, model, parameters and task do the same work.
struct Row {
    std::string scenario = {};
    std::string model = {};
    uint32_t faces = 0;  ///< of the model
    std::vector<std::pair<std::string, double>>
        parameters;         ///< {"level", 4}: no two rows of a model differ in faces
    std::string task = {};  ///< where a scenario has several: "normals"
    std::string evaluator = {};
    Side side = Side::limn;
    Timing timing = {};                 ///< count 0: not measured, and the note says why
    std::optional<Timing> device = {};  ///< by the device's own clock
    double items = 0;                   ///< that one step makes
    std::string unit = {};              ///< what items are, in plural
    double bytes = 0;      ///< that must move at least: tables, points and results once each; 0: unknown
    double flops = 0;      ///< multiply-adds of the evaluation, counted as two; 0: unknown
    double copy_rate = 0;  ///< bytes per second of a plain copy on the same device; 0: unknown
    std::string note = {};

    bool measured() const { return timing.count != 0 && timing.median > 0; }
};

/// "grid_eval/rook/rate=7/normals", and then "/limn": unique in a report.
std::string group_name(const Row& row);
std::string row_name(const Row& row);
/// Of what a plain copy moves in the same time; 0 where unknown.
double copy_share(const Row& row);
CacheClass cache_class(const Row& row, uint64_t cache_bytes);
const char* to_text(CacheClass cache);
const char* to_text(Side side);

/// Lines of a header: name and text.
using Facts = std::vector<std::pair<std::string, std::string>>;

struct ReportData {
    Facts facts;
    uint64_t cache_bytes = 0;     ///< of the last level; 0: unknown
    double device_copy_rate = 0;  ///< bytes per second
    bool quick = false;
    std::vector<Row> rows;
    std::vector<std::string> findings;  ///< sentences: what was verified, what grows
};

class Report {
  public:
    /// Prints the header.
    Report(const Options& options, ReportData header);
    /// Prints the row. Its name must be new.
    void add(Row row);
    /// A line that is printed and kept.
    void add_finding(const std::string& line);
    const ReportData& data() const { return data_; }

  private:
    const Options& options_;
    ReportData data_;
    std::string scenario_;  ///< of the rows above
};

}  // namespace limn::bench
