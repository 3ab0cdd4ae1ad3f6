// What samples of a fixed rate weigh: surfaces that share a plan and are sampled at the same places share one
// dense matrix from ring points to values and derivatives.
#pragma once

#include <cstdint>
#include <vector>

#include "limn/evaluate.h"
#include "limn/patch_table.h"
#include "limn/shared/grid_eval_params.h"

namespace limn {

struct GridOptions {
    /// Intervals along each side of a ptex face, 1 .. 256.
    uint32_t rate = 8;
    /// Weights of du and dv, too: for normals or derivatives.
    bool derivatives = true;
    /// Grids are written in passes of whole ptex faces and at most this many samples, one more where a single
    /// face has more: what a device must bind of a destination at once.
    uint32_t samples_per_pass = uint32_t{1} << 22;
    /// Bytes of weights that are not exceeded: their number grows with the square of the rate, for each plan.
    uint64_t max_weight_bytes = uint64_t{256} << 20;
    BuildPart control = {};  ///< as RefinementOptions::control
};

/// Surfaces with a plan and lattice in common. Value k (0; with derivatives also 1 and 2: du and dv, by the
/// plan's coordinates, twice as large where the ptex face is split) of its sample s is the sum over ring
/// points 4 g + c of weights[4 * (first_weight + (g * value_count + k) * sample_count + s) + c].
struct GridClass {
    uint32_t ring_size;
    uint32_t group_count;  ///< groups of four ring points; more than 8 are a multiple of 8. Padding weighs 0
    uint32_t sample_count;
    uint32_t first_weight;  ///< in groups of four
    uint32_t corners;       ///< which ring points are at the surface's corners: shared::kGridCorners...
};

/// GridClass::group_count of a ring.
inline uint32_t ring_group_count(uint32_t ring_size) {
    const uint32_t groups = (ring_size + 3) / 4;
    return groups > 8 ? (groups + 7) / 8 * 8 : groups;
}

/// Where a surface's samples go, and how its derivatives are turned: sample s is sample
/// placement_samples[first + s] of its ptex face, or left out at kInvalidIndex: another surface has it.
/// du of the face is uu * du + vu * dv of the class, and dv is uv * du + vv * dv.
struct GridPlacement {
    int32_t uu, uv, vu, vv;
    uint32_t first;
    uint32_t count;  ///< of samples
};

/// The samples that surfaces of a placement have, by rows and columns of quads: sample i < columns of row j < rows is
/// sample placement_samples[first + j * columns + i] of the ptex face, or kInvalidIndex. It lies at ((x + i * step) / rate,
/// (y + j * step) / rate) in the coordinates of the plan; step is 2 where the ptex face is split.
struct GridLattice {
    int32_t x, y, step;
    uint32_t columns, rows;
    uint32_t first;
};

struct GridSurface {
    uint32_t first_ring;  ///< as Surface::first_ring
    uint32_t ptex_face;
    uint32_t placement;
    uint32_t grid_class;
};

/// The samples of ptex face f are [f * samples_per_face, (f + 1) * samples_per_face) of the whole grid: row
/// by row, (u, v) = (i, j) / rate at j * (rate + 1) + i; of triangles, whose rows get shorter, at j * (rate +
/// 1) - j * (j - 1) / 2 + i. Surfaces are sorted by pass, then by class.
struct GridTable {
    uint32_t rate = 0;
    uint32_t value_count = 0;  ///< 1, or 3 with derivatives
    uint32_t ptex_count = 0;
    uint32_t samples_per_face = 0;
    uint32_t faces_per_pass = 0;
    bool relative = false;  ///< as PatchTreeOptions::relative
    Array<GridClass> classes;
    Array<GridPlacement> placements;
    Array<uint32_t> placement_samples;
    Array<GridLattice> lattices;  ///< one per placement, of use to surfaces that are bicubic patches; none for triangles
    Array<GridSurface> surfaces;
    /// Empty, or of a refined grid: a sample w of a placement is sample slots[surface.ptex_face + (w >> kGridOffsetBits)]
    /// + (w modulo 2^kGridOffsetBits), or left out where that slot is kInvalidIndex.
    Array<uint32_t> slots;
    Array<float> weights;
    uint64_t total_sample_count = 0;

    uint64_t sample_count() const { return total_sample_count; }
    uint64_t bytes() const {
        return classes.bytes() + placements.bytes() + placement_samples.bytes() + lattices.bytes() + slots.bytes() +
               surfaces.bytes() + weights.bytes();
    }
};

/// Weights are computed in double, from those of the table; on all cores. At an extraordinary vertex those of
/// du and dv are the limit tangents'. Errors: invalid_argument (rate, samples_per_pass), too_large
/// (max_weight_bytes: evaluate samples instead), cancelled.
template <class Real>
Result<GridTable> build_grid_table(const BasicPatchTable<Real>& table, const GridOptions& options);

/// The same places for evaluate_patches, in the same order.
std::vector<PatchSample> list_grid_samples(Scheme scheme, uint32_t ptex_count, uint32_t rate);

}  // namespace limn
