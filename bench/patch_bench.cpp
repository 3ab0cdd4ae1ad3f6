#include "patch_bench.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "osd_patches.h"
#include "patch_samples.h"

namespace limn::bench {
namespace {

constexpr uint32_t kIsolationLevel = 3;  // of OpenSubdiv's patches

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

PatchBench::PatchBench(const Options& options, const BenchModel& model, Report& report, std::string prefix,
                       const PatchTableDouble& table, std::vector<PatchSample> samples)
    : options_(options),
      model_(model),
      report_(report),
      prefix_(std::move(prefix)),
      samples_(std::move(samples)),
      truth_(evaluate_samples(table, samples_, model.positions, Derivatives::first)) {}

PatchBench::Difference PatchBench::compare(const PatchValues& values) const {
    const size_t count = samples_.size();
    const bool has_normals = !values.normals.empty();
    if (values.positions.size() != 3 * count ||
        (has_normals ? values.normals : values.du).size() != 3 * count ||
        values.dv.size() != values.du.size())
        return {INFINITY, INFINITY, INFINITY};
    const double size = tolerance_for(model_.positions).size;
    Difference difference{};
    std::vector<double> degrees;
    for (size_t s = 0; s < count; ++s) {
        for (size_t axis = 0; axis < 3; ++axis) {
            const double d =
                std::abs(static_cast<double>(values.positions[3 * s + axis]) - truth_[9 * s + axis]) / size;
            difference.position = std::isfinite(d) ? std::max(difference.position, d) : INFINITY;
        }
        const Vector truth = normal_of(vector_at(truth_, 3 * s + 1), vector_at(truth_, 3 * s + 2), size);
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

void PatchBench::verify(const PatchCandidate& candidate, const Difference& difference) const {
    const Tolerance tolerance = tolerance_for(model_.positions);
    const double largest =
        candidate.is_limn ? tolerance.in_float / tolerance.size : largest_osd_error(kIsolationLevel);
    // Those of OpenSubdiv's approximate ends are printed only.
    const double most_degrees = candidate.is_limn ? 0.1 : 180;
    char text[200];
    std::snprintf(text, sizeof text,
                  ": positions are %.3g of the size off (allowed: %.3g), normals %.3g degrees",
                  difference.position, largest, difference.most_normals);
    if (!(difference.position <= largest) || !(difference.most_normals <= most_degrees))
        fail(options_, {ErrorCode::unsupported, prefix_ + candidate.name + text});
}

void PatchBench::run(const PatchCandidate& candidate) {
    if (!candidate.frame())
        fail(options_, {ErrorCode::unsupported, prefix_ + candidate.name + ": cannot be evaluated"});
    const Difference difference = compare(candidate.values());
    verify(candidate, difference);
    std::vector<double> device;
    const Timing timing = measure(options_, [&] {
        const bool done = candidate.frame();
        if (candidate.device_milliseconds) device.push_back(candidate.device_milliseconds());
        return done;
    });
    Row row{.name = prefix_ + candidate.name};
    (candidate.is_limn ? row.limn : row.peer) = timing;
    if (!device.empty()) row.device = timing_of({device.begin() + 1, device.end()});  // without the warm-up
    row.items = static_cast<double>(candidate.sample_count);
    row.bytes = static_cast<double>(candidate.bytes);
    row.copy_rate = candidate.copy_rate;
    char text[120];
    std::snprintf(text, sizeof text, "off by %.1e of the size, normals by %.2g degrees (99.9 %%: %.2g)",
                  difference.position, difference.normal, difference.most_normals);
    row.note = text;
    if (candidate.dispatch_count != 0)
        row.note += ", " + std::to_string(candidate.dispatch_count) + " dispatches";
    if (!candidate.note.empty()) row.note += ", " + candidate.note;
    report_.add(row);
    // limn's arithmetic on the host is there for comparison: best rows are about devices.
    if (!candidate.is_limn || candidate.dispatch_count != 0)
        measured_.push_back({candidate.name, candidate.is_limn, timing});
}

void PatchBench::add_missing(const std::string& name, bool is_limn, const std::string& why) {
    Row row{.name = prefix_ + name, .note = why};
    (is_limn ? row.limn : row.peer) = Timing{};
    report_.add(row);
}

void PatchBench::run_osd(const Machines& machines) {
    const auto places = std::make_shared<OsdPlaces>();
    places->patches = build_osd_patches(OsdMesh(model_.mesh), kIsolationLevel);
    if (places->patches) places->places = find_osd_patches(*places->patches, samples_);
    if (places->places.size() != samples_.size())
        fail(options_, {ErrorCode::unsupported, model_.name + ": OpenSubdiv has no patch at some place"});
    for (const uint32_t width : {3u, 4u}) {
        run(make_osd_patch_candidate(OsdEvaluator::cpu, places, model_.positions, width, machines.copy.host));
        run(make_osd_patch_candidate(OsdEvaluator::omp, places, model_.positions, width,
                                     machines.copy.host_all_cores));
        const Result<PatchCandidate> gl =
            machines.gl
                ? make_osd_gl_patch_candidate(*machines.gl, places, model_.positions, width, machines.copy.gl)
                : Result<PatchCandidate>(machines.gl.error());
        if (gl)
            run(*gl);
        else
            add_missing(describe_osd_patch_candidate("gl", *places, width).name, false, gl.error().message);
    }
}

const PatchBench::Measured* PatchBench::find_best(bool is_limn, const char* prefix) const {
    const Measured* best = nullptr;
    for (const Measured& m : measured_)
        if (m.is_limn == is_limn && m.timing.count != 0 && m.name.rfind(prefix, 0) == 0 &&
            (best == nullptr || m.timing.median < best->timing.median))
            best = &m;
    return best;
}

void PatchBench::finish() {
    const Measured* limn = find_best(true, "");
    for (const auto& [name, peers] : {std::pair{"best_gl", "osd_gl"}, std::pair{"best", "osd"}}) {
        const Measured* peer = find_best(false, peers);
        if (peer == nullptr) continue;
        Row row{.name = prefix_ + name, .peer = peer->timing, .note = peer->name};
        if (limn != nullptr) {
            row.limn = limn->timing;
            row.note = limn->name + " / " + peer->name;
        }
        row.items = static_cast<double>(samples_.size());
        report_.add(row);
    }
}

}  // namespace limn::bench
