#include "patch_bench.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "patch_samples.h"

namespace limn::bench {
namespace {

constexpr uint32_t kIsolationLevel = 3;  // of OpenSubdiv's patches
constexpr double kMostDegrees = 0.1;     // that 999 of 1000 normals may be off

using Vector = std::array<double, 3>;

template <class T>
Vector vector_at(const std::vector<T>& values, size_t i) {
    return {static_cast<double>(values[3 * i]), static_cast<double>(values[3 * i + 1]),
            static_cast<double>(values[3 * i + 2])};
}
Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double dot(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
double length(const Vector& a) {
    return std::sqrt(dot(a, a));
}
double degrees_between(const Vector& a, const Vector& b) {
    const double angle = std::atan2(length(cross(a, b)), dot(a, b));
    // Where one is zero there is no angle, and none that is right.
    return length(a) * length(b) > 0 ? angle * 180 / std::numbers::pi : 180;
}

/// Zero where the tangents are nearly parallel, or far shorter than the mesh: a face that is no face.
Vector normal_of(const Vector& du, const Vector& dv, double size) {
    const double product = length(du) * length(dv);
    const Vector normal = cross(du, dv);
    return product > 1e-8 * size * size && length(normal) > 1e-2 * product ? normal : Vector{};
}

}  // namespace

PatchBench::PatchBench(const Session& session, const BenchModel& model, Row row, PatchTask task,
                       const PatchTableDouble& table, std::vector<PatchSample> samples)
    : session_(session),
      model_(model),
      row_(std::move(row)),
      task_(task),
      samples_(std::move(samples)),
      truth_(evaluate_samples(table, samples_, model.positions, Derivatives::first)) {
    row_.model = model.name;
    row_.faces = model.mesh.face_count();
    row_.unit = "samples";
    row_.items = static_cast<double>(samples_.size());
}

PatchBench::Difference PatchBench::compare(const PatchValues& values, const std::vector<double>& right) const {
    const size_t count = samples_.size();
    const bool has_normals = !values.normals.empty();
    const bool has_tangents = task_ != PatchTask::points;
    if (values.positions.size() != 3 * count || values.dv.size() != values.du.size() ||
        (has_tangents && (has_normals ? values.normals : values.du).size() != 3 * count))
        return {INFINITY, INFINITY, INFINITY};
    const double size = tolerance_for(model_.positions).size;
    Difference difference{};
    std::vector<double> degrees;
    for (size_t s = 0; s < count; ++s) {
        for (size_t axis = 0; axis < 3; ++axis) {
            const double d = std::abs(static_cast<double>(values.positions[3 * s + axis]) - right[9 * s + axis]) / size;
            difference.position = std::isfinite(d) ? std::max(difference.position, d) : INFINITY;
        }
        if (!has_tangents) continue;
        const Vector truth = normal_of(vector_at(right, 3 * s + 1), vector_at(right, 3 * s + 2), size);
        if (length(truth) == 0) continue;
        const Vector normal = has_normals ? vector_at(values.normals, s)
                                          : cross(vector_at(values.du, s), vector_at(values.dv, s));
        degrees.push_back(degrees_between(normal, truth));
    }
    if (degrees.empty()) return difference;
    std::sort(degrees.begin(), degrees.end());
    difference.most_normals = degrees[degrees.size() - 1 - degrees.size() / 1000];
    difference.normal = degrees.back();
    return difference;
}

void PatchBench::verify(const PatchCandidate& candidate, const std::vector<double>& right) const {
    const Difference difference = compare(candidate.values(), right);
    const Tolerance tolerance = tolerance_for(model_.positions);
    const double largest = tolerance.in_float / tolerance.size;
    if (difference.position <= largest && difference.most_normals <= kMostDegrees) return;
    fail(session_.options,
         {ErrorCode::unsupported,
          group_name(row_) + "/" + candidate.name +
              format(": positions are %.3g of the size off (allowed: %.3g), normals %.3g degrees (%.3g)",
                     difference.position, largest, difference.most_normals, kMostDegrees)});
}

void PatchBench::run(const PatchCandidate& candidate, const std::vector<double>& right) {
    const Options& options = session_.options;
    Row row = row_;
    row.evaluator = candidate.name;
    row.side = candidate.is_limn ? Side::limn : Side::peer;
    if (!candidate.frame()) fail(options, {ErrorCode::unsupported, row_name(row) + ": cannot be evaluated"});
    verify(candidate, right);
    const Difference difference = compare(candidate.values(), truth_);
    std::vector<double> device;
    row.timing = measure(options, [&] {
        const bool done = candidate.frame();
        if (candidate.device_milliseconds) device.push_back(candidate.device_milliseconds());
        return done;
    });
    if (!device.empty()) row.device = timing_of({device.begin() + 1, device.end()});  // without the warm-up
    row.bytes = static_cast<double>(candidate.bytes);
    row.flops = candidate.flops;
    row.copy_rate = candidate.copy_rate;
    row.note = format("off by %.1e of the size", difference.position);
    if (task_ != PatchTask::points)
        row.note +=
            format(", normals by %.2g degrees (99.9 %%: %.2g)", difference.normal, difference.most_normals);
    if (candidate.dispatch_count != 0)
        row.note += ", " + std::to_string(candidate.dispatch_count) + " dispatches";
    if (!candidate.note.empty()) row.note += ", " + candidate.note;
    session_.report.add(row);
}

void PatchBench::add_missing(const std::string& name, Side side, const std::string& why) {
    Row row = row_;
    row.evaluator = name;
    row.side = side;
    row.note = why;
    session_.report.add(row);
}

OsdSamples PatchBench::find_osd() const {
    return find_osd_samples(session_.options, model_, kIsolationLevel, samples_);
}

void PatchBench::run_osd(const OsdSamples& osd, bool gl) {
    const auto& places = osd.places;
    const Machines& machines = session_.machines;
    const auto& positions = model_.positions;
    for (const uint32_t width : {3u, 4u}) {
        run(make_osd_patch_candidate(OsdEvaluator::cpu, task_, places, positions, width, machines.copy.host), osd);
        run(make_osd_patch_candidate(OsdEvaluator::omp, task_, places, positions, width, machines.copy.host_all_cores),
            osd);
        if (!gl) continue;
        const Result<PatchCandidate> candidate =
            machines.gl
                ? make_osd_gl_patch_candidate(*machines.gl, task_, places, positions, width, machines.copy.gl)
                : Result<PatchCandidate>(machines.gl.error());
        if (candidate)
            run(*candidate, osd);
        else
            add_missing(describe_osd_patch_candidate("gl", task_, *places, width).name, Side::peer,
                        candidate.error().message);
    }
}

}  // namespace limn::bench
