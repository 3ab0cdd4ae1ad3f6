#include "limn/refined_points.h"

#include <algorithm>
#include <bit>
#include <unordered_map>

#include "limn/parallel.h"
#include "limn/stencil_row.h"
#include "limn/topology_build.h"

namespace limn {

IndexList pack_indices(Array<uint32_t>&& indices, uint32_t bound, const BuildPart& part) {
    IndexList list;
    list.narrow = bound <= 0x10000;
    if (!list.narrow) {
        list.words = std::move(indices);
        return list;
    }
    const size_t count = indices.size();
    list.words.allocate((count + 1) / 2);
    for_each_index(
        static_cast<uint32_t>(list.words.size()), part,
        [&](uint32_t i) {
            const size_t k = 2 * size_t{i};
            list.words[i] = indices[k] | (k + 1 < count ? indices[k + 1] << 16 : 0);
        },
        1 << 15);
    return list;
}

namespace {

template <class Real>
uint64_t hash_weights(std::span<const Real> weights) {
    uint64_t hash = weights.size();
    for (const Real w : weights)
        hash = (hash ^ std::bit_cast<uint64_t>(static_cast<double>(w))) * 0x9e3779b97f4a7c15 ^ hash >> 29;
    return hash;
}

}  // namespace

template <class Real>
uint32_t PointRuns<Real>::add(const Real* weights, uint32_t entry_count, uint32_t row_count) {
    const uint64_t hash = hash_weights<Real>({weights, entry_count});
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

/// The level-1 vertices that rings hold, with rows of equal weights together, and what they are made of. Each
/// chunk of rows finds the patterns of weights that it meets; then the chunks' patterns become runs.
template <class Real>
class PointBuilder {
  public:
    PointBuilder(const Topology& base, bool linear, const Array<uint32_t>& control_indices,
                 BasicPatchTable<Real>& table)
        : base_(base), linear_(linear), control_indices_(control_indices), table_(table) {}

    /// point_of_child[v] is not kInvalidIndex where v is needed, and receives its point.
    Result<void> build(std::vector<uint32_t>& point_of_child, const BuildPart& part) {
        std::vector<uint32_t> needed;
        for_each_in_order(static_cast<uint32_t>(point_of_child.size()), part.part(0, 0.1f), [&](uint32_t v) {
            if (point_of_child[v] != kInvalidIndex) needed.push_back(v);
        });
        table_.refined_count = static_cast<uint32_t>(needed.size());
        table_.first_refined = first_refined_point(table_.control_count, table_.refined_count);
        std::vector<Chunk> chunks((needed.size() + kChunkSize - 1) / kChunkSize);
        auto of_chunk = [&](uint32_t n) {
            const size_t begin = n * kChunkSize;
            return std::span(needed).subspan(begin, std::min(kChunkSize, needed.size() - begin));
        };
        const auto chunk_count = static_cast<uint32_t>(chunks.size());
        for_each_index(
            chunk_count, part.part(0.1f, 0.6f), [&](uint32_t n) { make_rows(of_chunk(n), chunks[n]); }, 1);
        const size_t index_count = make_runs(chunks, part.part(0.6f, 0.7f));
        if (index_count > kInvalidIndex)
            return Error{ErrorCode::too_large, "points of level 1 are made of 2^32 control points or more"};
        Array<uint32_t> indices;
        indices.allocate(index_count);
        for_each_index(
            chunk_count, part.part(0.7f, 0.95f),
            [&](uint32_t n) { place_rows(of_chunk(n), chunks[n], point_of_child, indices); }, 1);
        table_.point_indices = pack_indices(std::move(indices), table_.control_count, part.part(0.95f, 1));
        return {};
    }

  private:
    static constexpr size_t kChunkSize = 512;
    struct Pattern {
        uint64_t hash;
        uint32_t entry_count, first_weight;  ///< in the weights of its chunk
        uint32_t row_count = 0;
        uint32_t run = 0;
        uint32_t next_row = 0;  ///< the row of the run that the chunk's next row of this pattern is
    };
    struct Chunk {
        std::vector<uint32_t> pattern_of_row, indices;
        std::vector<Pattern> patterns;
        std::vector<Real> weights;
    };

    void make_rows(std::span<const uint32_t> children, Chunk& chunk) const {
        const Interpolation rules = linear_ ? Interpolation::varying : Interpolation::vertex;
        std::unordered_multimap<uint64_t, uint32_t> patterns_by_hash;
        Row row;
        std::vector<Real> weights;
        for (const uint32_t child : children) {
            row.clear();
            refinement_row(base_, child, rules, row);
            append(row, chunk.indices, weights);
            const uint64_t hash = hash_weights<Real>(weights);
            const auto [begin, end] = patterns_by_hash.equal_range(hash);
            auto at = std::find_if(begin, end, [&](const auto& entry) {
                return has_weights(chunk, chunk.patterns[entry.second], weights);
            });
            if (at == end) {
                at = patterns_by_hash.emplace(hash, static_cast<uint32_t>(chunk.patterns.size()));
                chunk.patterns.push_back({hash, static_cast<uint32_t>(weights.size()),
                                          static_cast<uint32_t>(chunk.weights.size())});
                chunk.weights.insert(chunk.weights.end(), weights.begin(), weights.end());
            }
            ++chunk.patterns[at->second].row_count;
            chunk.pattern_of_row.push_back(at->second);
        }
    }

    /// Adds up what a row says of the same control point.
    void append(const Row& row, std::vector<uint32_t>& indices, std::vector<Real>& weights) const {
        const size_t begin = indices.size();
        weights.clear();
        for (const RowEntry& e : row) {
            const uint32_t index = control_indices_.empty() ? e.index : control_indices_[e.index];
            size_t at = begin;
            while (at < indices.size() && indices[at] != index) ++at;
            if (at == indices.size()) {
                indices.push_back(index);
                weights.push_back(0);
            }
            weights[at - begin] += static_cast<Real>(e.weight);
        }
    }

    static std::span<const Real> weights_of(const Chunk& chunk, const Pattern& pattern) {
        return std::span(chunk.weights).subspan(pattern.first_weight, pattern.entry_count);
    }
    static bool has_weights(const Chunk& chunk, const Pattern& pattern, std::span<const Real> weights) {
        return std::ranges::equal(weights_of(chunk, pattern), weights);
    }

    /// Runs in the order in which rows need them. Returns how many indices they have.
    size_t make_runs(std::vector<Chunk>& chunks, const BuildPart& part) {
        PointRuns<Real> runs;
        size_t index_count = 0;
        auto add = [&](uint32_t n) {
            for (Pattern& pattern : chunks[n].patterns) {
                pattern.run = runs.add(weights_of(chunks[n], pattern).data(), pattern.entry_count, pattern.row_count);
                pattern.next_row = runs.runs()[pattern.run].row_count - pattern.row_count;
                index_count += size_t{pattern.row_count} * pattern.entry_count;
            }
        };
        for_each_in_order(static_cast<uint32_t>(chunks.size()), part, add, 16);
        runs.place(table_.first_refined);
        runs.write(table_);
        return index_count;
    }

    void place_rows(std::span<const uint32_t> children, Chunk& chunk, std::vector<uint32_t>& point_of_child,
                    Array<uint32_t>& indices) const {
        const uint32_t* from = chunk.indices.data();
        for (size_t i = 0; i < children.size(); ++i) {
            Pattern& pattern = chunk.patterns[chunk.pattern_of_row[i]];
            const PointRun& run = table_.point_runs[pattern.run];
            const uint32_t row = pattern.next_row++;
            point_of_child[children[i]] = run.first_point + row;
            std::copy_n(from, run.entry_count,
                        indices.begin() + run.first_index + size_t{row} * run.entry_count);
            from += run.entry_count;
        }
    }

    const Topology& base_;
    bool linear_;
    const Array<uint32_t>& control_indices_;
    BasicPatchTable<Real>& table_;
};

}  // namespace

template <class Real>
Result<void> build_refined_points(const Topology& base, bool linear, const Array<uint32_t>& control_indices,
                                  std::vector<uint32_t>& point_of_child, BasicPatchTable<Real>& table,
                                  const BuildPart& part) {
    return PointBuilder<Real>(base, linear, control_indices, table).build(point_of_child, part);
}

template <class Real>
BasicStencilTable<Real> build_point_table(const BasicPatchTable<Real>& table) {
    BasicStencilTable<Real> out;
    out.source_count = table.control_count;
    Array<uint32_t> counts;
    counts.assign(table.refined_count, 0);
    uint64_t entries = 0;
    for (const PointRun& run : table.point_runs) {
        std::fill_n(counts.begin() + (run.first_point - table.first_refined), run.row_count, run.entry_count);
        entries += uint64_t{run.row_count} * run.entry_count;
    }
    out.offsets = offsets_from_counts(counts);
    out.indices.allocate(entries);
    out.weights.allocate(entries);
    for (const PointRun& run : table.point_runs) {
        if (run.row_count == 0) continue;
        const std::vector<uint32_t> order =
            order_by_weight(std::span(table.point_weights.data() + run.first_weight, run.entry_count));
        size_t at = out.offsets[run.first_point - table.first_refined];
        for (uint32_t i = 0; i < run.row_count; ++i)
            for (const uint32_t k : order) {
                out.indices[at] = table.point_indices[run.first_index + size_t{i} * run.entry_count + k];
                out.weights[at++] = table.point_weights[run.first_weight + k];
            }
    }
    return out;
}

template Result<void> build_refined_points<float>(const Topology&, bool, const Array<uint32_t>&,
                                                  std::vector<uint32_t>&, PatchTable&, const BuildPart&);
template Result<void> build_refined_points<double>(const Topology&, bool, const Array<uint32_t>&,
                                                   std::vector<uint32_t>&, PatchTableDouble&, const BuildPart&);
template StencilTable build_point_table<float>(const PatchTable&);
template StencilTableDouble build_point_table<double>(const PatchTableDouble&);

}  // namespace limn
