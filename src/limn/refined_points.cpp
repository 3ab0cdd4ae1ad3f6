#include "limn/refined_points.h"

#include <algorithm>
#include <bit>
#include <unordered_map>

#include "limn/parallel.h"
#include "limn/refinement.h"
#include "limn/schemes/schemes.h"
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
    const auto pairs = static_cast<uint32_t>(indices.size() / 2);
    list.words.allocate((indices.size() + 1) / 2);
    uint32_t* const to = list.words.data();
    const uint32_t* const from = indices.data();
    for_each_index(
        pairs, part, [&](uint32_t i) { to[i] = from[2 * size_t{i}] | from[2 * size_t{i} + 1] << 16; }, 1 << 15);
    if (indices.size() % 2 != 0) list.words.back() = indices.back();
    return list;
}

namespace {

constexpr uint32_t kBlockSize = 512;  ///< vertices of a block of their children

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
    const std::span row(weights, entry_count);
    return add(hash_weights<Real>(row), row, row_count);
}

template <class Real>
uint32_t PointRuns<Real>::add(uint64_t hash, std::span<const Real> weights, uint32_t row_count) {
    const auto entry_count = static_cast<uint32_t>(weights.size());
    const auto [begin, end] = runs_by_hash_.equal_range(hash);
    auto at = std::find_if(begin, end, [&](const auto& entry) {
        const PointRun& run = runs_[entry.second];
        return run.entry_count == entry_count &&
               std::equal(weights.begin(), weights.end(), weights_.begin() + run.first_weight);
    });
    if (at == end) {
        at = runs_by_hash_.emplace(hash, static_cast<uint32_t>(runs_.size()));
        runs_.push_back({0, 0, entry_count, 0, static_cast<uint32_t>(weights_.size())});
        weights_.insert(weights_.end(), weights.begin(), weights.end());
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

uint32_t vertex_block(uint32_t v) {
    return v / kBlockSize;
}
uint32_t vertex_block_count(const Topology& base) {
    return (base.vertex_count + kBlockSize - 1) / kBlockSize;
}

std::vector<uint32_t> find_child_blocks(const Topology& base, const std::vector<uint32_t>& first_faces) {
    std::vector<uint32_t> out;
    if (base.options.scheme == Scheme::doo_sabin) {
        for (const uint32_t f : first_faces) out.push_back(base.face_begin(f));
        return out;
    }
    for (uint32_t v = 0; v < base.vertex_count; v += kBlockSize) out.push_back(v);
    const std::span chunks(first_faces.begin(), first_faces.end() - 1);
    if (base.options.scheme != Scheme::loop)
        for (const uint32_t f : chunks) out.push_back(child_of_face(base, f));
    uint32_t e = 0;  // edges are numbered as they appear, corner by corner
    for (const uint32_t f : chunks) {
        while (e < base.edge_count && base.corners_of_edge(e)[0] < base.face_begin(f)) ++e;
        out.push_back(child_of_edge(base, e));
    }
    out.push_back(child_of_edge(base, base.edge_count));
    return out;
}

namespace {

template <class Real>
std::span<const Real> weights_of(const PointBlock<Real>& block,
                                 const typename PointBlock<Real>::Pattern& pattern) {
    return std::span(block.weights).subspan(pattern.first_weight, pattern.entry_count);
}

/// Makes rows, and finds the patterns of weights that they have.
template <class Real>
struct RowMaker {
    const Topology& base;
    Interpolation rules;
    const Array<uint32_t>& control_indices;

    PointBlock<Real> make(uint32_t first_child, std::vector<uint32_t> children) const {
        PointBlock<Real> block;
        block.children = std::move(children);
        block.pattern_of_row.reserve(block.children.size());
        block.indices.reserve(8 * block.children.size());
        std::unordered_multimap<uint64_t, uint32_t> patterns_by_hash;
        Row row;
        std::vector<Real> weights;
        uint32_t pattern = 0;
        for (const uint32_t child : block.children) {
            row.clear();
            if (base.options.scheme == Scheme::doo_sabin)
                schemes::doo_sabin_corner(base, first_child + child, row);
            else
                refinement_row(base, first_child + child, rules, row);
            append(row, block.indices, weights);
            // Most rows are as the one before.
            if (!has_weights(block, pattern, weights)) pattern = find_pattern(block, weights, patterns_by_hash);
            ++block.patterns[pattern].row_count;
            block.pattern_of_row.push_back(pattern);
        }
        return block;
    }

  private:
    static bool has_weights(const PointBlock<Real>& block, uint32_t pattern, const std::vector<Real>& weights) {
        return pattern < block.patterns.size() && std::ranges::equal(weights_of(block, block.patterns[pattern]), weights);
    }
    static uint32_t find_pattern(PointBlock<Real>& block, const std::vector<Real>& weights,
                                 std::unordered_multimap<uint64_t, uint32_t>& patterns_by_hash) {
        const uint64_t hash = hash_weights<Real>(weights);
        const auto [begin, end] = patterns_by_hash.equal_range(hash);
        const auto at =
            std::find_if(begin, end, [&](const auto& entry) { return has_weights(block, entry.second, weights); });
        if (at != end) return at->second;
        const auto number = static_cast<uint32_t>(block.patterns.size());
        patterns_by_hash.emplace(hash, number);
        block.patterns.push_back(
            {hash, static_cast<uint32_t>(weights.size()), static_cast<uint32_t>(block.weights.size())});
        block.weights.insert(block.weights.end(), weights.begin(), weights.end());
        return number;
    }
    /// Adds up what a row says of the same control point.
    void append(const Row& row, std::vector<uint32_t>& indices, std::vector<Real>& weights) const {
        const size_t begin = indices.size();
        indices.resize(begin + row.size());
        weights.resize(row.size());
        uint32_t* const to = indices.data() + begin;
        size_t count = 0;
        for (const RowEntry& e : row) {
            const uint32_t index = control_indices.empty() ? e.index : control_indices[e.index];
            size_t at = 0;
            while (at < count && to[at] != index) ++at;
            if (at == count) {
                to[count] = index;
                weights[count++] = 0;
            }
            weights[at] += static_cast<Real>(e.weight);
        }
        indices.resize(begin + count);
        weights.resize(count);
    }
};

}  // namespace

template <class Real>
void make_point_rows(const Topology& base, bool linear, const Array<uint32_t>& control_indices,
                     const std::vector<uint32_t>& uses, RefinedPoints<Real>& points, const BuildPart& part) {
    const RowMaker<Real> maker{base, linear ? Interpolation::varying : Interpolation::vertex,
                               control_indices};
    for_each_index(
        points.block_count(), part,
        [&](uint32_t b) {
            const uint32_t first = points.first_children[b];
            std::vector<uint32_t> children;
            for (uint32_t child = first; child < points.first_children[b + 1]; ++child)
                if (uses[child] != 0) children.push_back(child - first);
            if (points.blocks[b] != nullptr && points.blocks[b]->children == children) return;
            points.blocks[b] = std::make_shared<PointBlock<Real>>(maker.make(first, std::move(children)));
        },
        1);
}

template <class Real>
Result<void> place_points(RefinedPoints<Real>& points, const BuildPart& part) {
    points.refined_count = 0;
    points.index_count = 0;
    points.runs = {};
    points.places.assign(points.blocks.size(), {});
    // Runs in the order in which rows need them; first_point is, until those have places, the run.
    for_each_in_order(
        points.block_count(), part.part(0, 0.8f),
        [&](uint32_t b) {
            const PointBlock<Real>& block = *points.blocks[b];
            points.refined_count += static_cast<uint32_t>(block.children.size());
            for (const auto& pattern : block.patterns) {
                const uint32_t run =
                    points.runs.add(pattern.hash, weights_of(block, pattern), pattern.row_count);
                points.places[b].push_back({run, points.runs.runs()[run].row_count - pattern.row_count});
                points.index_count += uint64_t{pattern.row_count} * pattern.entry_count;
            }
        },
        16);
    if (points.index_count > kInvalidIndex)
        return Error{ErrorCode::too_large, "points of level 1 are made of 2^32 control points or more"};
    points.first_refined = first_refined_point(points.control_count, points.refined_count);
    points.runs.place(points.first_refined);
    for (auto& places : points.places)
        for (auto& place : places) {
            const PointRun& run = points.runs.runs()[place.first_point];
            const uint32_t row = place.first_index;
            place = {run.first_point + row, run.first_index + row * run.entry_count};
        }
    return {};
}

namespace {

/// Points of a block's rows, and what they are made of.
template <class Real>
void write_block(const PointBlock<Real>& block,
                 std::vector<typename RefinedPoints<Real>::PatternPlace> places, uint32_t* point_of_child,
                 uint32_t* indices) {
    const uint32_t* from = block.indices.data();
    for (size_t i = 0; i < block.children.size(); ++i) {
        const uint32_t pattern = block.pattern_of_row[i], entries = block.patterns[pattern].entry_count;
        auto& place = places[pattern];
        point_of_child[block.children[i]] = place.first_point++;
        std::copy_n(from, entries, indices + place.first_index);
        place.first_index += entries;
        from += entries;
    }
}

}  // namespace

Array<uint32_t> take_indices(IndexList& list, size_t size, bool& kept) {
    Array<uint32_t> words;
    if (!list.narrow) words = std::move(list.words);
    kept = words.reuse(size) && kept;
    return words;
}

template <class Real>
void write_points(RefinedPoints<Real>& points, const RefinedPoints<Real>* before,
                  BasicPatchTable<Real>& table, const BuildPart& part) {
    table.first_refined = points.first_refined;
    table.refined_count = points.refined_count;
    points.runs.write(table);
    bool kept =
        before != nullptr && before->first_children == points.first_children && !table.point_indices.narrow;
    Array<uint32_t> indices = take_indices(table.point_indices, points.index_count, kept);
    if (kept)
        points.point_of_child = before->point_of_child;
    else
        points.point_of_child.assign(points.first_children.back(), kInvalidIndex);
    for_each_index(
        points.block_count(), part.part(0, 0.9f),
        [&](uint32_t b) {
            if (kept && points.blocks[b] == before->blocks[b] && points.places[b] == before->places[b])
                return;
            uint32_t* const to = points.point_of_child.data() + points.first_children[b];
            if (kept)
                std::fill(to, points.point_of_child.data() + points.first_children[b + 1], kInvalidIndex);
            write_block(*points.blocks[b], points.places[b], to, indices.data());
        },
        4);
    table.point_indices = pack_indices(std::move(indices), points.control_count, part.part(0.9f, 1));
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

template void make_point_rows<float>(const Topology&, bool, const Array<uint32_t>&,
                                     const std::vector<uint32_t>&, RefinedPoints<float>&, const BuildPart&);
template void make_point_rows<double>(const Topology&, bool, const Array<uint32_t>&,
                                      const std::vector<uint32_t>&, RefinedPoints<double>&, const BuildPart&);
template Result<void> place_points<float>(RefinedPoints<float>&, const BuildPart&);
template Result<void> place_points<double>(RefinedPoints<double>&, const BuildPart&);
template void write_points<float>(RefinedPoints<float>&, const RefinedPoints<float>*, PatchTable&,
                                  const BuildPart&);
template void write_points<double>(RefinedPoints<double>&, const RefinedPoints<double>*, PatchTableDouble&,
                                   const BuildPart&);
template StencilTable build_point_table<float>(const PatchTable&);
template StencilTableDouble build_point_table<double>(const PatchTableDouble&);

}  // namespace limn
