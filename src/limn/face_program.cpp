#include "limn/face_program.h"

#include <bit>

namespace limn {
namespace {

/// Appends one step whose rows are those of program.points; leaves the vertices it needs in program.points.
template <class AppendRow>
void write_step(Program& program, std::vector<uint32_t>& positions, Program::Step& step,
                const AppendRow& append_row) {
    step.offsets.assign(1, 0);
    step.entries.clear();
    program.sources.clear();
    for (const uint32_t v : program.points) {
        const size_t first = step.entries.size();
        append_row(v, step.entries);
        for (size_t k = first; k < step.entries.size(); ++k) {
            uint32_t& position = positions[step.entries[k].index];
            if (position == kInvalidIndex) {
                position = static_cast<uint32_t>(program.sources.size());
                program.sources.push_back(step.entries[k].index);
            }
            step.entries[k].index = position;
        }
        step.offsets.push_back(static_cast<uint32_t>(step.entries.size()));
    }
    std::swap(program.points, program.sources);
}

}  // namespace

void write_program(const WalkOptions& walk, uint32_t face, Orientation orientation,
                   const std::vector<uint32_t>& target_corners, const ComposeOptions& options,
                   Program& program) {
    const bool limit = options.target != Target::refined;
    Neighborhood& hood = program.hood;
    walk_around(walk, face, orientation, hood);
    refine_locally(walk.base, hood.faces, target_corners, {options.level, limit, walk.uncut}, program.local);
    const std::vector<Topology>& levels = program.local.levels;
    const size_t step_count = levels.size() - 1 + (limit ? 1 : 0);
    program.steps.resize(step_count);
    program.tangents.clear();
    program.points = program.local.targets;
    program.target_count = program.points.size();
    program.ring_size = hood.ring.size();
    std::vector<uint32_t> positions;
    for (size_t step = step_count; step-- > 0;) {
        const Topology& parent = levels[step];
        positions.assign(parent.vertex_count, kInvalidIndex);
        if (step == 0)
            for (uint32_t v = 0; v < parent.vertex_count; ++v)
                positions[v] = hood.local(program.local.ring[v]);
        write_step(program, positions, program.steps[step], [&](uint32_t v, Row& row) {
            if (step + 1 == levels.size()) return limit_row(parent, v, row, program.tangents);
            const std::vector<uint32_t>& children = program.local.children[step + 1];
            const uint32_t child = children.empty() ? v : children[v];
            refinement_row(parent, child, options.interpolation, row);
        });
    }
}

void run_supports(const Program& program, Supports& s) {
    const size_t ring = program.ring_size;
    s.words = static_cast<uint32_t>((ring + 63) / 64);
    const size_t words = s.words;
    s.bits.assign(ring * words, 0);
    for (size_t i = 0; i < ring; ++i) s.bits[i * words + i / 64] |= uint64_t{1} << (i % 64);
    for (const Program::Step& step : program.steps) {
        std::swap(s.bits, s.previous);
        const size_t rows = step.offsets.size() - 1;
        s.bits.assign(rows * words, 0);
        for (size_t r = 0; r < rows; ++r)
            for (uint32_t k = step.offsets[r]; k < step.offsets[r + 1]; ++k) {
                const uint64_t* from = s.previous.data() + step.entries[k].index * words;
                for (size_t w = 0; w < words; ++w) s.bits[r * words + w] |= from[w];
            }
    }
}

uint32_t support_size(const Supports& s, size_t row) {
    uint32_t size = 0;
    for (size_t w = 0; w < s.words; ++w)
        size += static_cast<uint32_t>(std::popcount(s.bits[row * s.words + w]));
    return size;
}

namespace {

// No fused multiply-add (the build forbids contraction), so wider vectors give the same bits.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define LIMN_VECTOR_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define LIMN_VECTOR_CLONES
#endif

/// out row r = sum over its entries of weight * in row; `weights` are `weight_stride` doubles apart.
LIMN_VECTOR_CLONES void multiply(const Program::Step& step, const double* weights, size_t weight_stride,
                                 const double* in, size_t stride, double* out) {
    const size_t rows = step.offsets.size() - 1;
    for (size_t r = 0; r < rows; ++r) {
        double* sum = out + r * stride;
        for (uint32_t k = step.offsets[r]; k < step.offsets[r + 1]; ++k) {
            const double weight = weights[k * weight_stride];
            const double* row = in + step.entries[k].index * stride;
            for (size_t i = 0; i < stride; ++i) sum[i] += weight * row[i];
        }
    }
}

}  // namespace

void run_weights(const Program& program, Weights& w) {
    const size_t ring = program.ring_size;
    const size_t stride = w.stride = (ring + 7) / 8 * 8;
    w.rows.assign(ring * stride, 0.0);
    for (size_t i = 0; i < ring; ++i) w.rows[i * stride + i] = 1;
    for (const Program::Step& step : program.steps) {
        std::swap(w.rows, w.previous);
        const size_t size = (step.offsets.size() - 1) * stride;
        w.rows.assign(size, 0.0);
        multiply(step, &step.entries[0].weight, sizeof(RowEntry) / sizeof(double), w.previous.data(), stride,
                 w.rows.data());
        if (&step != &program.steps.back() || program.tangents.empty()) continue;
        w.tangent1.assign(size, 0.0);
        w.tangent2.assign(size, 0.0);
        multiply(step, &program.tangents[0].tangent1, 2, w.previous.data(), stride, w.tangent1.data());
        multiply(step, &program.tangents[0].tangent2, 2, w.previous.data(), stride, w.tangent2.data());
    }
}

}  // namespace limn
