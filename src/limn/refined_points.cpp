#include "limn/refined_points.h"

#include <algorithm>
#include <bit>
#include <unordered_map>

#include "limn/parallel.h"
#include "limn/stencil_row.h"
#include "limn/topology_build.h"

namespace limn {

IndexList pack_indices(const std::vector<uint32_t>& indices, uint32_t bound) {
    IndexList list;
    list.narrow = bound <= 0x10000;
    if (!list.narrow) {
        list.words.allocate(indices.size());
        std::copy(indices.begin(), indices.end(), list.words.begin());
        return list;
    }
    list.words.assign((indices.size() + 1) / 2, 0);
    for (size_t i = 0; i < indices.size(); ++i) list.words[i / 2] |= indices[i] << (16 * (i & 1));
    return list;
}

template <class Real>
uint32_t PointRuns<Real>::add(const Real* weights, uint32_t entry_count, uint32_t row_count) {
    uint64_t hash = entry_count;
    for (uint32_t k = 0; k < entry_count; ++k) {
        const auto w = static_cast<double>(weights[k]);
        hash = (hash ^ std::bit_cast<uint64_t>(w)) * 0x9e3779b97f4a7c15 ^ hash >> 29;
    }
    const auto [begin, end] = runs_by_hash_.equal_range(hash);
    auto at = std::find_if(begin, end, [&](const auto& entry) {
        const PointRun& run = runs_[entry.second];
        return run.entry_count == entry_count &&
               std::equal(weights, weights + entry_count, weights_.begin() + run.first_weight);
    });
    if (at == end) {
        at = runs_by_hash_.emplace(hash, static_cast<uint32_t>(runs_.size()));
        runs_.push_back({0, 0, entry_count, 0, static_cast<uint32_t>(weights_.size())});
        weights_.insert(weights_.end(), weights, weights + entry_count);
    }
    runs_[at->second].row_count += row_count;
    return at->second;
}

template <class Real>
void PointRuns<Real>::place(uint32_t first_point) {
    uint32_t index = 0;
    for (PointRun& run : runs_) {
        run.first_point = first_point;
        run.first_index = index;
        first_point += run.row_count;
        index += run.row_count * run.entry_count;
    }
}

template <class Real>
void PointRuns<Real>::write(BasicPatchTable<Real>& table) const {
    table.point_runs.allocate(runs_.size());
    std::copy(runs_.begin(), runs_.end(), table.point_runs.begin());
    table.point_weights.allocate(weights_.size());
    std::copy(weights_.begin(), weights_.end(), table.point_weights.begin());
}

template class PointRuns<float>;
template class PointRuns<double>;

namespace {

/// The level-1 vertices that rings hold, with rows of equal weights together, and what they are made of.
template <class Real>
class PointBuilder {
  public:
    PointBuilder(const Topology& base, bool linear, const Array<uint32_t>& control_indices,
                 BasicPatchTable<Real>& table)
        : base_(base), linear_(linear), control_indices_(control_indices), table_(table) {}

    /// point_of_child[v] is not kInvalidIndex where v is needed, and receives its point.
    void build(std::vector<uint32_t>& point_of_child) {
        std::vector<uint32_t> needed;
        for (uint32_t v = 0; v < point_of_child.size(); ++v)
            if (point_of_child[v] != kInvalidIndex) needed.push_back(v);
        table_.refined_count = static_cast<uint32_t>(needed.size());
        table_.first_refined = first_refined_point(table_.control_count, table_.refined_count);
        make_rows(needed);
        group_rows();
        std::vector<uint32_t> cursor, indices(indices_.size());
        for (const PointRun& run : runs_.runs()) cursor.push_back(run.first_point);
        for (size_t i = 0; i < needed.size(); ++i) {
            const PointRun& run = runs_.runs()[patterns_[i]];
            const uint32_t point = cursor[patterns_[i]]++;
            point_of_child[needed[i]] = point;
            std::copy_n(indices_.begin() + static_cast<ptrdiff_t>(offsets_[i]), run.entry_count,
                        indices.begin() + run.first_index +
                            static_cast<ptrdiff_t>(point - run.first_point) * run.entry_count);
        }
        table_.point_indices = pack_indices(indices, table_.control_count);
        runs_.write(table_);
    }

  private:
    void make_rows(const std::vector<uint32_t>& needed) {
        const Interpolation rules = linear_ ? Interpolation::varying : Interpolation::vertex;
        constexpr size_t kRowChunk = 512;
        struct Chunk {
            std::vector<uint32_t> sizes, indices;
            std::vector<Real> weights;
        };
        std::vector<Chunk> chunks((needed.size() + kRowChunk - 1) / kRowChunk);
        for_each_index(
            static_cast<uint32_t>(chunks.size()),
            [&](uint32_t n) {
                Chunk& chunk = chunks[n];
                Row row;
                for (size_t i = n * kRowChunk; i < std::min(needed.size(), (n + 1) * kRowChunk); ++i) {
                    row.clear();
                    refinement_row(base_, needed[i], rules, row);
                    chunk.sizes.push_back(append(row, chunk.indices, chunk.weights));
                }
            },
            1);
        offsets_.push_back(0);
        for (const Chunk& chunk : chunks) {
            for (const uint32_t size : chunk.sizes) offsets_.push_back(offsets_.back() + size);
            indices_.insert(indices_.end(), chunk.indices.begin(), chunk.indices.end());
            weights_.insert(weights_.end(), chunk.weights.begin(), chunk.weights.end());
        }
    }

    /// Adds up what a row says of the same control point.
    uint32_t append(const Row& row, std::vector<uint32_t>& indices, std::vector<Real>& weights) const {
        const size_t begin = indices.size();
        for (const RowEntry& e : row) {
            const uint32_t index = control_indices_.empty() ? e.index : control_indices_[e.index];
            size_t at = begin;
            while (at < indices.size() && indices[at] != index) ++at;
            if (at == indices.size()) {
                indices.push_back(index);
                weights.push_back(0);
            }
            weights[at] += static_cast<Real>(e.weight);
        }
        return static_cast<uint32_t>(indices.size() - begin);
    }

    void group_rows() {
        for (size_t i = 0; i + 1 < offsets_.size(); ++i)
            patterns_.push_back(
                runs_.add(weights_.data() + offsets_[i], static_cast<uint32_t>(offsets_[i + 1] - offsets_[i]), 1));
        runs_.place(table_.first_refined);
    }

    const Topology& base_;
    bool linear_;
    const Array<uint32_t>& control_indices_;
    BasicPatchTable<Real>& table_;
    std::vector<size_t> offsets_;
    std::vector<uint32_t> indices_, patterns_;
    std::vector<Real> weights_;
    PointRuns<Real> runs_;
};

}  // namespace

template <class Real>
void build_refined_points(const Topology& base, bool linear, const Array<uint32_t>& control_indices,
                          std::vector<uint32_t>& point_of_child, BasicPatchTable<Real>& table) {
    PointBuilder<Real>(base, linear, control_indices, table).build(point_of_child);
}

template <class Real>
BasicStencilTable<Real> build_point_table(const BasicPatchTable<Real>& table) {
    BasicStencilTable<Real> out;
    out.source_count = table.control_count;
    Array<uint32_t> counts;
    counts.allocate(table.refined_count);
    uint64_t entries = 0;
    for (const PointRun& run : table.point_runs) {
        std::fill_n(counts.begin() + (run.first_point - table.first_refined), run.row_count, run.entry_count);
        entries += uint64_t{run.row_count} * run.entry_count;
    }
    out.offsets = offsets_from_counts(counts);
    out.indices.allocate(entries);
    out.weights.allocate(entries);
    size_t at = 0;
    for (const PointRun& run : table.point_runs)
        for (uint32_t i = 0; i < run.row_count; ++i)
            for (uint32_t k = 0; k < run.entry_count; ++k, ++at) {
                out.indices[at] = table.point_indices[run.first_index + size_t{i} * run.entry_count + k];
                out.weights[at] = table.point_weights[run.first_weight + k];
            }
    return out;
}

template void build_refined_points<float>(const Topology&, bool, const Array<uint32_t>&,
                                          std::vector<uint32_t>&, PatchTable&);
template void build_refined_points<double>(const Topology&, bool, const Array<uint32_t>&,
                                           std::vector<uint32_t>&, PatchTableDouble&);
template StencilTable build_point_table<float>(const PatchTable&);
template StencilTableDouble build_point_table<double>(const PatchTableDouble&);

}  // namespace limn
