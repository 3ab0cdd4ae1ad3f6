#include "osd_patches.h"

#include <opensubdiv/far/patchMap.h>
#include <opensubdiv/far/patchTableFactory.h>
#include <opensubdiv/far/stencilTableFactory.h>
#include <opensubdiv/osd/cpuEvaluator.h>
#include <opensubdiv/osd/cpuPatchTable.h>
#include <opensubdiv/osd/ompEvaluator.h>

#include <array>
#include <thread>

#include "limn/parallel.h"

namespace limn::bench {

namespace Far = OpenSubdiv::Far;
namespace Osd = OpenSubdiv::Osd;

namespace {

Far::PatchTableFactory::Options patch_options(uint32_t isolation_level) {
    Far::PatchTableFactory::Options options(isolation_level);
    options.SetEndCapType(Far::PatchTableFactory::Options::ENDCAP_GREGORY_BASIS);
    options.useInfSharpPatch = true;
    options.useSingleCreasePatch = false;   // which its evaluators cannot evaluate
    options.generateVaryingTables = false;  // positions only
    options.generateVaryingLocalPoints = false;
    options.generateLegacySharpCornerPatches = false;  // smooth corners stay smooth
    return options;
}

/// Of refined points, then of the points of the patches at the ends.
std::unique_ptr<const Far::StencilTable> build_stencils(const Far::TopologyRefiner& refiner,
                                                        const Far::PatchTable& patches) {
    Far::StencilTableFactory::Options options;
    options.generateOffsets = true;
    options.generateIntermediateLevels = true;
    options.factorizeIntermediateLevels = true;
    std::unique_ptr<const Far::StencilTable> stencils(Far::StencilTableFactory::Create(refiner, options));
    if (const Far::StencilTable* local = patches.GetLocalPointStencilTable())
        if (const Far::StencilTable* all =
                Far::StencilTableFactory::AppendLocalPointStencilTable(refiner, stencils.get(), local))
            stencils.reset(all);
    return stencils;
}

/// Control points, then those of all stencils, in double.
std::vector<double> evaluate_stencils(const OsdPatches& patches, const std::vector<float>& positions) {
    std::vector<double> points(positions.begin(), positions.end());
    points.resize(3 * patches.point_count());
    const Far::StencilTable& table = *patches.stencils;
    for (size_t row = 0, k = 0; row < patches.stencil_count(); ++row)
        for (const size_t end = k + static_cast<size_t>(table.GetSizes()[row]); k < end; ++k)
            for (size_t axis = 0; axis < 3; ++axis)
                points[3 * (patches.control_count + row) + axis] +=
                    static_cast<double>(table.GetWeights()[k]) *
                    points[3 * static_cast<size_t>(table.GetControlIndices()[k]) + axis];
    return points;
}

using Descriptor = Osd::BufferDescriptor;
using EvalStencils = bool (*)(const float*, const Descriptor&, float*, const Descriptor&, const int*,
                              const int*, const int*, const float*, int, int);
using EvalPoints = bool (*)(const float*, const Descriptor&, float*, const Descriptor&, int,
                            const Osd::PatchCoord*, const Osd::PatchArray*, const int*,
                            const Osd::PatchParam*);
using EvalPatches = bool (*)(const float*, const Descriptor&, float*, const Descriptor&, float*,
                             const Descriptor&, float*, const Descriptor&, int, const Osd::PatchCoord*,
                             const Osd::PatchArray*, const int*, const Osd::PatchParam*);

struct Evaluator {
    EvalStencils stencils;
    EvalPoints points;
    EvalPatches patches;
};

}  // namespace

std::unique_ptr<const OsdPatches> build_osd_patches(const OsdMesh& mesh, uint32_t isolation_level) {
    auto built = std::make_unique<OsdPatches>();
    built->refiner = mesh.create();
    if (!built->refiner) return nullptr;
    Far::TopologyRefiner& refiner = *built->refiner;
    const Far::PatchTableFactory::Options options = patch_options(isolation_level);
    refiner.RefineAdaptive(options.GetRefineAdaptiveOptions());
    built->control_count = static_cast<uint32_t>(refiner.GetLevel(0).GetNumVertices());
    built->patches.reset(Far::PatchTableFactory::Create(refiner, options));
    built->stencils = build_stencils(refiner, *built->patches);
    return built;
}

std::shared_ptr<const OsdPlaces> find_osd_places(const ControlMesh& mesh, uint32_t isolation_level,
                                                 std::span<const PatchSample> samples) {
    const auto found = std::make_shared<OsdPlaces>();
    found->patches = build_osd_patches(OsdMesh(mesh), isolation_level);
    if (!found->patches) return nullptr;
    const Far::PatchMap map(*found->patches->patches);
    found->places.reserve(samples.size());
    for (const PatchSample& s : samples) {
        const auto* handle = map.FindPatch(static_cast<int>(s.face), s.u, s.v);
        if (handle == nullptr) return nullptr;
        found->places.emplace_back(*handle, static_cast<float>(s.u), static_cast<float>(s.v));
    }
    return found;
}

std::vector<double> evaluate_osd_places(const OsdPlaces& places, const std::vector<float>& positions) {
    const Far::PatchTable& patches = *places.patches->patches;
    const std::vector<double> points = evaluate_stencils(*places.patches, positions);
    std::vector<double> values(9 * places.places.size());
    const auto evaluate = [&](uint32_t s) {
        const Osd::PatchCoord& place = places.places[s];
        std::array<std::array<double, 20>, 3> weights{};  // of position, du and dv
        patches.EvaluateBasis(place.handle, static_cast<double>(place.s), static_cast<double>(place.t),
                              weights[0].data(), weights[1].data(), weights[2].data());
        // OpenSubdiv's derivatives are twice as long as its own u and v say where a face is no quad.
        const double scale = patches.GetPatchParam(place.handle).NonQuadRoot() ? 0.5 : 1;
        const Far::ConstIndexArray vertices = patches.GetPatchVertices(place.handle);
        for (size_t k = 0; k < 3; ++k)
            for (int i = 0; i < vertices.size(); ++i)
                for (size_t axis = 0; axis < 3; ++axis)
                    values[9 * s + 3 * k + axis] += (k == 0 ? 1 : scale) * weights[k][static_cast<size_t>(i)] *
                                                    points[3 * static_cast<size_t>(vertices[i]) + axis];
    };
    for_each_index(static_cast<uint32_t>(places.places.size()), evaluate);
    return values;
}

PatchCandidate describe_osd_patch_candidate(const std::string& what, PatchTask task, const OsdPlaces& places,
                                            uint32_t width) {
    const OsdPatches& patches = *places.patches;
    PatchCandidate candidate;
    candidate.name = "osd_" + what + (width == 4 ? "_xyzw" : "");
    candidate.sample_count = places.places.size();
    const uint64_t value_count = task == PatchTask::points ? 1 : 3;
    // Stencils read control points and write all others; patches read both and write all values.
    const uint64_t values =
        patches.point_count() + patches.point_count() + value_count * candidate.sample_count;
    uint64_t terms = patches.stencils->GetWeights().size();
    for (const Osd::PatchCoord& place : places.places)
        terms += value_count * static_cast<uint64_t>(patches.patches->GetPatchVertices(place.handle).size());
    candidate.flops = 2.0 * width * static_cast<double>(terms);
    candidate.bytes =
        patches.bytes() + sizeof(Osd::PatchCoord) * candidate.sample_count + uint64_t{4} * width * values;
    return candidate;
}

PatchCandidate make_osd_patch_candidate(OsdEvaluator kind, PatchTask task,
                                        const std::shared_ptr<const OsdPlaces>& places,
                                        const std::vector<float>& positions, uint32_t width,
                                        double copy_rate) {
    const bool omp = kind == OsdEvaluator::omp;
    PatchCandidate candidate = describe_osd_patch_candidate(omp ? "omp" : "cpu", task, *places, width);
    candidate.copy_rate = copy_rate;
    if (omp) Osd::OmpEvaluator::SetNumThreads(static_cast<int>(std::thread::hardware_concurrency()));
    const Evaluator evaluator =
        omp ? Evaluator{Osd::OmpEvaluator::EvalStencils, Osd::OmpEvaluator::EvalPatches,
                        Osd::OmpEvaluator::EvalPatches}
            : Evaluator{Osd::CpuEvaluator::EvalStencils, Osd::CpuEvaluator::EvalPatches,
                        Osd::CpuEvaluator::EvalPatches};
    struct Frame {
        Osd::CpuPatchTable table;
        std::vector<float> points;     // control points, then the points of all rows
        std::vector<float> values[3];  // position, du, dv where they are wanted
    };
    const size_t value_count = task == PatchTask::points ? 1 : 3;
    const OsdPatches& patches = *places->patches;
    const auto frame = std::make_shared<Frame>(
        Frame{Osd::CpuPatchTable(patches.patches.get()), pad_points(positions, width), {}});
    frame->points.resize(width * patches.point_count());
    for (size_t k = 0; k < value_count; ++k) frame->values[k].resize(width * places->places.size());
    candidate.frame = [=] {
        const auto& stencils = *places->patches->stencils;
        const auto& table = frame->table;
        auto& [position, du, dv] = frame->values;
        const int w = static_cast<int>(width);
        const Osd::BufferDescriptor from(0, w, w),
            to(w * static_cast<int>(places->patches->control_count), w, w);
        float* points = frame->points.data();
        if (!evaluator.stencils(points, from, points, to, stencils.GetSizes().data(),
                                stencils.GetOffsets().data(), stencils.GetControlIndices().data(),
                                stencils.GetWeights().data(), 0, stencils.GetNumStencils()))
            return false;
        const int count = static_cast<int>(places->places.size());
        if (task == PatchTask::points)
            return evaluator.points(points, from, position.data(), from, count, places->places.data(),
                                    table.GetPatchArrayBuffer(), table.GetPatchIndexBuffer(),
                                    table.GetPatchParamBuffer());
        return evaluator.patches(points, from, position.data(), from, du.data(), from, dv.data(), from, count,
                                 places->places.data(), table.GetPatchArrayBuffer(),
                                 table.GetPatchIndexBuffer(), table.GetPatchParamBuffer());
    };
    candidate.values = [=] {
        const auto unpadded = [&](const std::vector<float>& values) {
            return unpad_points(values.data(), values.size() / width, width);
        };
        return PatchValues{
            unpadded(frame->values[0]), unpadded(frame->values[1]), unpadded(frame->values[2]), {}};
    };
    return candidate;
}

}  // namespace limn::bench
