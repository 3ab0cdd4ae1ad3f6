#include "plain_loops.h"

#include <algorithm>
#include <cmath>

#include "limn/parallel.h"
#include "limn_patches.h"
#include "patch_samples.h"

namespace limn::bench {
namespace {

void apply_rows(const StencilTable& table, const float* source, float* destination) {
    for_each_index(table.row_count(), [&](uint32_t row) {
        float x = 0, y = 0, z = 0;
        for (uint32_t k = table.offsets[row]; k < table.offsets[row + 1]; ++k) {
            const float* point = source + size_t{3} * table.indices[k];
            const float weight = table.weights[k];
            x += weight * point[0];
            y += weight * point[1];
            z += weight * point[2];
        }
        float* to = destination + size_t{3} * row;
        to[0] = x;
        to[1] = y;
        to[2] = z;
    });
}

/// The matrix of a class for loops over samples: weights[(k * ring_size + j) * sample_count + s] is what
/// value k of sample s takes of ring point j.
struct Matrix {
    uint32_t ring_size, sample_count;
    std::vector<float> weights;
};

std::vector<Matrix> list_matrices(const GridTable& grid) {
    std::vector<Matrix> matrices;
    for (const GridClass& c : grid.classes) {
        Matrix m{c.ring_size, c.sample_count, {}};
        m.weights.reserve(size_t{grid.value_count} * c.ring_size * c.sample_count);
        for (uint32_t k = 0; k < grid.value_count; ++k)
            for (uint32_t j = 0; j < c.ring_size; ++j)
                for (uint32_t s = 0; s < c.sample_count; ++s) {
                    const size_t row = size_t{j / 4} * grid.value_count + k;
                    m.weights.push_back(
                        grid.weights[4 * (c.first_weight + row * c.sample_count + s) + j % 4]);
                }
        matrices.push_back(std::move(m));
    }
    return matrices;
}

struct GridFrame {
    const PatchTable& table;
    GridTable grid;
    std::vector<Matrix> matrices;
    StencilTable refined;          ///< makes the level-1 points
    std::vector<float> points;     ///< control points, then those of level 1
    std::vector<float> values[3];  ///< of all ptex faces: position, then du and dv or, in [1], the normal
    PatchTask task;

    size_t value_count() const { return task == PatchTask::points ? 1 : task == PatchTask::normals ? 2 : 3; }
};

/// sums[(3 * k + axis) * sample_count + s] of one surface.
void apply_matrix(const GridFrame& frame, const GridSurface& surface, std::vector<float>& sums) {
    const Matrix& m = frame.matrices[surface.grid_class];
    const size_t count = m.sample_count;
    sums.assign(size_t{3} * frame.grid.value_count * count, 0.0f);
    const float* weight = m.weights.data();
    for (uint32_t k = 0; k < frame.grid.value_count; ++k) {
        float *x = sums.data() + 3 * k * count, *y = x + count, *z = y + count;
        for (uint32_t j = 0; j < m.ring_size; ++j, weight += count) {
            const float* point =
                frame.points.data() + size_t{3} * frame.table.ring_points[surface.first_ring + j];
            const float px = point[0], py = point[1], pz = point[2];
            for (size_t s = 0; s < count; ++s) {
                x[s] += weight[s] * px;
                y[s] += weight[s] * py;
                z[s] += weight[s] * pz;
            }
        }
    }
}

void write_sample(GridFrame& frame, const GridPlacement& turn, const std::vector<float>& sums, size_t count,
                  size_t s, size_t to) {
    float u[3], v[3];
    for (size_t axis = 0; axis < 3; ++axis) {
        frame.values[0][3 * to + axis] = sums[axis * count + s];
        if (frame.task == PatchTask::points) continue;
        const float du = sums[(3 + axis) * count + s], dv = sums[(6 + axis) * count + s];
        u[axis] = static_cast<float>(turn.uu) * du + static_cast<float>(turn.vu) * dv;
        v[axis] = static_cast<float>(turn.uv) * du + static_cast<float>(turn.vv) * dv;
    }
    if (frame.task == PatchTask::derivatives) {
        std::copy(u, u + 3, &frame.values[1][3 * to]);
        std::copy(v, v + 3, &frame.values[2][3 * to]);
    }
    if (frame.task == PatchTask::normals) {
        const float n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
        const float length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        for (size_t axis = 0; axis < 3; ++axis)
            frame.values[1][3 * to + axis] = length > 0 ? n[axis] / length : 0;
    }
}

void evaluate_surface(GridFrame& frame, const GridSurface& surface) {
    thread_local std::vector<float> sums;
    apply_matrix(frame, surface, sums);
    const GridPlacement& placement = frame.grid.placements[surface.placement];
    const size_t count = frame.matrices[surface.grid_class].sample_count;
    for (size_t s = 0; s < count; ++s) {
        const uint32_t at = frame.grid.placement_samples[placement.first + s];
        if (at == kInvalidIndex) continue;
        write_sample(frame, placement, sums, count, s,
                     size_t{surface.ptex_face} * frame.grid.samples_per_face + at);
    }
}

std::vector<float> values_of_faces(const GridFrame& frame, const std::vector<float>& all) {
    std::vector<float> values;
    if (all.empty()) return values;
    const size_t face_floats = size_t{3} * frame.grid.samples_per_face;
    for (const uint32_t face : present_faces(frame.table.ptex_surfaces)) {
        const auto begin = all.begin() + static_cast<std::ptrdiff_t>(face * face_floats);
        values.insert(values.end(), begin, begin + static_cast<std::ptrdiff_t>(face_floats));
    }
    return values;
}

}  // namespace

Candidate make_loop_stencil_candidate(std::span<const StencilTable> tables,
                                      const std::vector<float>& positions, double copy_rate) {
    Candidate candidate;
    candidate.name = tables.size() == 1 ? "loop_composed" : "loop_chain";
    candidate.copy_rate = copy_rate;
    const auto points = std::make_shared<std::vector<std::vector<float>>>();
    points->push_back(positions);
    for (const StencilTable& table : tables) {
        points->emplace_back(size_t{3} * table.row_count());
        candidate.row_count += table.row_count();
        candidate.entry_count += table.weights.size();
        candidate.bytes += table.bytes() + uint64_t{12} * (table.source_count + table.row_count());
    }
    candidate.flops = 2.0 * 3 * static_cast<double>(candidate.entry_count);
    candidate.frame = [points, tables] {
        for (size_t i = 0; i < tables.size(); ++i)
            apply_rows(tables[i], (*points)[i].data(), (*points)[i + 1].data());
        return true;
    };
    candidate.points = [points] { return points->back(); };
    return candidate;
}

Result<PatchCandidate> make_loop_grid_candidate(const PatchTable& table, const std::vector<float>& positions,
                                                uint32_t rate, PatchTask task, double copy_rate) {
    auto grid = build_grid_table(table, {.rate = rate, .derivatives = task != PatchTask::points});
    if (!grid) return grid.error();
    auto matrices = list_matrices(*grid);
    const auto frame = std::make_shared<GridFrame>(GridFrame{
        table, std::move(*grid), std::move(matrices), build_point_table(table), positions, {}, task});
    frame->points.resize(size_t{3} * table.point_count());
    for (size_t k = 0; k < frame->value_count(); ++k) frame->values[k].resize(3 * frame->grid.sample_count());

    PatchCandidate candidate;
    candidate.name = "loop";
    candidate.sample_count =
        uint64_t{present_faces(table.ptex_surfaces).size()} * frame->grid.samples_per_face;
    candidate.bytes = table.bytes() + frame->grid.bytes() + uint64_t{2} * 12 * table.point_count() +
                      12 * frame->value_count() * candidate.sample_count;
    candidate.flops = grid_flops(table, frame->grid);
    candidate.copy_rate = copy_rate;
    candidate.frame = [frame] {
        apply_rows(frame->refined, frame->points.data(),
                   frame->points.data() + size_t{3} * frame->table.first_refined);
        for_each_index(
            static_cast<uint32_t>(frame->grid.surfaces.size()),
            [&](uint32_t i) { evaluate_surface(*frame, frame->grid.surfaces[i]); }, 16);
        return true;
    };
    candidate.values = [frame] {
        const auto value = [&](size_t k) { return values_of_faces(*frame, frame->values[k]); };
        return frame->task == PatchTask::normals ? PatchValues{value(0), {}, {}, value(1)}
                                                 : PatchValues{value(0), value(1), value(2), {}};
    };
    return candidate;
}

}  // namespace limn::bench
