#include "osd_stencils.h"

#include <opensubdiv/osd/cpuEvaluator.h>
#include <opensubdiv/osd/ompEvaluator.h>

#include <thread>

namespace limn::bench {

namespace Osd = OpenSubdiv::Osd;

namespace {

using EvalStencils = bool (*)(const float*, const Osd::BufferDescriptor&, float*,
                              const Osd::BufferDescriptor&, const int*, const int*, const int*, const float*,
                              int, int);

}  // namespace

Candidate describe_osd_candidate(const std::string& what, const OsdTable& table, uint32_t width) {
    Candidate candidate;
    candidate.name =
        "osd_" + what + (table.passes.size() > 1 ? "_chain" : "_composed") + (width == 4 ? "_xyzw" : "");
    candidate.row_count = table.row_count();
    candidate.entry_count = table.entry_count();
    candidate.flops = 2.0 * width * static_cast<double>(table.entry_count());
    candidate.bytes = table.bytes() + uint64_t{4} * width * table.moved_points();
    return candidate;
}

Candidate make_osd_candidate(OsdEvaluator evaluator, const std::shared_ptr<const OsdTable>& table,
                             const std::vector<float>& positions, uint32_t width, double copy_rate) {
    const bool omp = evaluator == OsdEvaluator::omp;
    Candidate candidate = describe_osd_candidate(omp ? "omp" : "cpu", *table, width);
    candidate.copy_rate = copy_rate;
    // Control points and the points of all rows in one buffer.
    const auto points = std::make_shared<std::vector<float>>(pad_points(positions, width));
    points->resize(width * (table->control_count + table->row_count()));
    const EvalStencils evaluate = omp ? static_cast<EvalStencils>(&Osd::OmpEvaluator::EvalStencils)
                                      : static_cast<EvalStencils>(&Osd::CpuEvaluator::EvalStencils);
    if (omp) Osd::OmpEvaluator::SetNumThreads(static_cast<int>(std::thread::hardware_concurrency()));
    // Offsets that count from the first row of each pass: where a range does not begin at row 0,
    // OpenSubdiv 3.5 counts destinations from that row for three components, from row 0 for four.
    std::vector<int> offsets(table->table->GetOffsets());
    for (const auto& pass : table->passes) {
        const int first = offsets[pass.begin];
        for (uint32_t row = pass.begin; row < pass.end; ++row) offsets[row] -= first;
    }
    candidate.frame = [=, offsets = std::move(offsets)] {
        const int w = static_cast<int>(width);
        const auto& stencils = *table->table;
        for (const auto& [begin, end, source] : table->passes) {
            const Osd::BufferDescriptor from(w * static_cast<int>(source), w, w),
                to(w * static_cast<int>(table->control_count + begin), w, w);
            const int first = stencils.GetOffsets()[begin];
            if (!evaluate(points->data(), from, points->data(), to, stencils.GetSizes().data() + begin,
                          offsets.data() + begin, stencils.GetControlIndices().data() + first,
                          stencils.GetWeights().data() + first, 0, static_cast<int>(end - begin)))
                return false;
        }
        return true;
    };
    candidate.points = [=] {
        const uint64_t begin = table->last_level_begin();
        return unpad_points(points->data() + width * (table->control_count + begin),
                            table->row_count() - begin, width);
    };
    return candidate;
}

}  // namespace limn::bench
