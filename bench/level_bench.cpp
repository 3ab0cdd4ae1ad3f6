#include "level_bench.h"

#include "osd_gl.h"
#include "osd_stencils.h"

namespace limn::bench {
namespace {

constexpr Repetitions kRepetitions{3, 1000, 0.25};
constexpr double kMostBytes = 3.0 * (1 << 30);  // of memory, while a table is built

}  // namespace

LevelBench::LevelBench(const Session& session, const char* scenario, const BenchModel& model, uint32_t level,
                       double row_count)
    : session_(session) {
    row_.scenario = scenario;
    row_.model = model.name;
    row_.faces = model.mesh.face_count();
    row_.parameters = {{"level", level}};
    row_.items = row_count;  // of the last level: rates count what is asked for, not the way there
    row_.unit = "points";
    tolerance_ = tolerance_for(model.positions).in_float;
}

void LevelBench::set_truth(std::vector<double> truth) {
    truth_ = std::move(truth);
    row_.items = static_cast<double>(truth_.size() / 3);
}

void LevelBench::run(const Candidate& candidate) {
    const Options& options = session_.options;
    Row row = row_;
    row.evaluator = candidate.name;
    row.side = candidate.is_limn ? Side::limn : Side::peer;
    if (!candidate.frame())
        fail(options, {ErrorCode::unsupported, row_name(row) + ": cannot be evaluated"});
    const double difference = largest_difference(candidate.points(), truth_);
    if (!(difference <= tolerance_))
        fail(options,
             {ErrorCode::unsupported, row_name(row) + format(": points are wrong by %.3g, more than %.3g",
                                                             difference, tolerance_)});
    std::vector<double> device;
    const auto frame = [&] {
        const bool done = candidate.frame();
        if (candidate.device_milliseconds) device.push_back(candidate.device_milliseconds());
        return done;
    };
    row.timing = measure(options, frame, {}, kRepetitions);
    if (!device.empty())
        row.device = timing_of({device.begin() + 1, device.end()});  // without the warm-up
    row.bytes = static_cast<double>(candidate.bytes);
    row.flops = candidate.flops;
    row.copy_rate = candidate.copy_rate;
    if (candidate.dispatch_count != 0)
        row.note = std::to_string(candidate.dispatch_count) + " dispatches";
    session_.report.add(row);
}

void LevelBench::run_or_say(const Result<Candidate>& candidate, const std::string& name, Side side) {
    if (candidate) return run(*candidate);
    add_missing(name, side, candidate.error().message);
}

void LevelBench::add_missing(const std::string& name, Side side, const std::string& why) {
    Row row = row_;
    row.evaluator = name;
    row.side = side;
    row.note = why;
    session_.report.add(row);
}

bool LevelBench::fits(const std::string& name, Side side, double bytes) {
    if (bytes <= kMostBytes) return true;
    add_missing(name, side, format("left out: about %.1f GiB, more than 3", bytes / (1 << 30)));
    return false;
}

void run_osd(const Session& session, const BenchModel& model, LevelBench& bench,
             const std::shared_ptr<const OsdTable>& table) {
    const Machines& machines = session.machines;
    for (const uint32_t width : {3u, 4u}) {
        bench.run(make_osd_candidate(OsdEvaluator::cpu, table, model.positions, width, machines.copy.host));
        bench.run(make_osd_candidate(OsdEvaluator::omp, table, model.positions, width,
                                     machines.copy.host_all_cores));
        const std::string name = describe_osd_candidate("gl", *table, width).name;
        bench.run_or_say(
            machines.gl ? make_osd_gl_candidate(*machines.gl, table, model.positions, width, machines.copy.gl)
                        : Result<Candidate>(machines.gl.error()),
            name, Side::peer);
    }
}

}  // namespace limn::bench
