#include "limn/vulkan/stencil_runs.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <functional>
#include <numeric>
#include <span>
#include <utility>

#include "limn/parallel.h"

namespace limn::vk {
namespace {

using shared::kStencilEvalMaxSharedWeights;

// Classes of rows: one for each pattern, one for each number of pairs, one for long rows.
constexpr uint32_t kMaxPatterns = 24;
constexpr uint32_t kMaxPairs = 32;  // rows of more entries than 64 are long
constexpr uint32_t kOwnClass = kMaxPatterns;
constexpr uint32_t kLongClass = kOwnClass + kMaxPairs + 1;
constexpr uint32_t kClassCount = kLongClass + 1;

constexpr uint32_t kChunkRows = 8192;  // of parallel loops
constexpr uint64_t kMaxRunPairs = uint64_t{1}
                                  << 22;  // 32 MiB: a quarter of the smallest maxStorageBufferRange
constexpr uint32_t kMaxRunItems = 1u << 26;
constexpr uint32_t kFewRows = 1024;     // cost less as padding than as a dispatch of their own
constexpr uint32_t kSampleRows = 4096;  // patterns are looked for in that many rows

struct Row {
    const uint32_t* indices;
    const float* weights;
    uint32_t entry_count;
};

Row row_of(const StencilTable& table, uint32_t r) {
    const uint32_t begin = table.offsets.data()[r];
    return {table.indices.data() + begin, table.weights.data() + begin, table.offsets.data()[r + 1] - begin};
}

/// How a row lists the weights of a pattern.
struct RowOrder {
    uint32_t entry_count = 0;
    float weights[kStencilEvalMaxSharedWeights];
    uint32_t positions[kStencilEvalMaxSharedWeights];  ///< of each of them in the order of the pattern
};

/// Where each entry of the row goes in the order of the pattern; false when their weights differ. Without
/// branches within an entry: the order of weights in a row is as good as random.
bool find_positions(const WeightPattern& pattern, const Row& row, uint32_t* positions) {
    uint32_t next[kStencilEvalMaxSharedWeights];
    for (uint32_t v = 0; v < pattern.value_count; ++v) next[v] = pattern.first[v];
    for (uint32_t k = 0; k < row.entry_count; ++k) {
        const uint32_t bits = std::bit_cast<uint32_t>(row.weights[k]);
        uint32_t v = 0;
        for (uint32_t i = 1; i < pattern.value_count; ++i) v += pattern.values[i] == bits ? i : 0;
        if (pattern.values[v] != bits || next[v] == pattern.first[v] + pattern.count[v]) return false;
        positions[k] = next[v]++;
    }
    return true;
}

/// Whether the row has the weights of the pattern, and in which order. `order` is that of a row before, or none: nearly
/// always this row's, too.
bool match(const WeightPattern& pattern, const Row& row, RowOrder& order) {
    if (row.entry_count != pattern.entry_count) return false;
    const size_t bytes = row.entry_count * sizeof(float);
    if (row.entry_count == order.entry_count && std::memcmp(row.weights, order.weights, bytes) == 0) return true;
    RowOrder found;
    if (!find_positions(pattern, row, found.positions)) return false;
    found.entry_count = row.entry_count;
    std::memcpy(found.weights, row.weights, bytes);
    order = found;
    return true;
}
using RowOrders = std::array<RowOrder, kMaxPatterns>;

/// Weights of a row in descending order of their bits, preceded by their number.
using SortedWeights = std::array<uint32_t, kStencilEvalMaxSharedWeights + 1>;

WeightPattern make_pattern(const SortedWeights& weights) {
    WeightPattern pattern;
    pattern.entry_count = weights[0];
    for (uint32_t k = 0; k < pattern.entry_count; ++k) {
        if (k == 0 || weights[k + 1] != weights[k]) {
            pattern.values[pattern.value_count] = weights[k + 1];
            pattern.first[pattern.value_count++] = k;
        }
        ++pattern.count[pattern.value_count - 1];
    }
    return pattern;
}

/// The weights that many of a sample of the rows have, most frequent first.
std::vector<WeightPattern> find_patterns(const StencilTable& table) {
    const uint32_t row_count = table.row_count();
    const uint32_t sample_count = std::min(row_count, kSampleRows);
    std::vector<SortedWeights> sample;
    for (uint32_t i = 0; i < sample_count; ++i) {
        const uint64_t begin = uint64_t{i} * row_count / sample_count;
        const uint64_t size = uint64_t{i + 1} * row_count / sample_count - begin;
        const Row row = row_of(table, static_cast<uint32_t>(begin + i * 2654435761u % size));
        if (row.entry_count == 0 || row.entry_count > kStencilEvalMaxSharedWeights) continue;
        SortedWeights weights = {row.entry_count};
        std::memcpy(weights.data() + 1, row.weights, row.entry_count * sizeof(float));
        std::sort(weights.begin() + 1, weights.begin() + 1 + row.entry_count, std::greater<>());
        sample.push_back(weights);
    }
    std::sort(sample.begin(), sample.end());
    std::vector<std::pair<size_t, size_t>> groups;  // (size, first)
    for (size_t i = 0, first = 0; i < sample.size(); ++i) {
        if (i + 1 < sample.size() && sample[i + 1] == sample[first]) continue;
        groups.emplace_back(i + 1 - first, first);
        first = i + 1;
    }
    std::sort(groups.begin(), groups.end(), [](auto a, auto b) { return a.first > b.first; });
    std::vector<WeightPattern> patterns;
    for (const auto& [size, first] : groups) {
        // A run takes a dispatch, so it should have some hundred rows.
        const bool worthwhile =
            size * row_count >= uint64_t{256} * sample_count && size * 256 >= sample_count;
        if (worthwhile && patterns.size() < kMaxPatterns) patterns.push_back(make_pattern(sample[first]));
    }
    return patterns;
}

uint32_t classify(const std::vector<WeightPattern>& patterns, const Row& row, RowOrders& orders) {
    for (uint32_t p = 0; p < patterns.size(); ++p)
        if (match(patterns[p], row, orders[p])) return p;
    const uint32_t pair_count = row.entry_count / 2 + row.entry_count % 2;
    return pair_count <= kMaxPairs ? kOwnClass + pair_count : kLongClass;
}

struct ClassRows {
    uint32_t count = 0;
    uint32_t row_begin = ~uint32_t{0}, row_end = 0;
};

/// Classifies all rows, chunk by chunk, and counts them.
std::array<ClassRows, kClassCount> classify_rows(const StencilTable& table, StencilRuns& runs) {
    const uint32_t row_count = table.row_count();
    const uint32_t chunk_count = (row_count + kChunkRows - 1) / kChunkRows;
    runs.classes.allocate(row_count);
    std::vector<std::array<ClassRows, kClassCount>> chunks(chunk_count);
    for_each_index(
        chunk_count,
        [&](uint32_t chunk) {
            const uint32_t end = std::min(row_count, (chunk + 1) * kChunkRows);
            RowOrders orders;
            for (uint32_t r = chunk * kChunkRows; r < end; ++r) {
                const uint32_t c = classify(runs.patterns, row_of(table, r), orders);
                runs.classes[r] = static_cast<uint8_t>(c);
                ClassRows& rows = chunks[chunk][c];
                ++rows.count;
                rows.row_begin = std::min(rows.row_begin, r);
                rows.row_end = r + 1;
            }
        },
        1);
    std::array<ClassRows, kClassCount> totals;
    runs.chunk_items.reserve(size_t{chunk_count} * kClassCount);
    for (const auto& chunk : chunks) {
        for (uint32_t c = 0; c < kClassCount; ++c) {
            runs.chunk_items.push_back(totals[c].count);
            totals[c].count += chunk[c].count;
            totals[c].row_begin = std::min(totals[c].row_begin, chunk[c].row_begin);
            totals[c].row_end = std::max(totals[c].row_end, chunk[c].row_end);
        }
    }
    return totals;
}

/// Puts rows of a size that few have to those of the next larger size, up to twice as large: dispatches have
/// a price.
void merge_small_classes(std::array<ClassRows, kClassCount>& classes, StencilRuns& runs) {
    std::array<uint8_t, kClassCount> merged;
    std::iota(merged.begin(), merged.end(), uint8_t{0});
    bool any = false;
    for (uint32_t c = kOwnClass + 1, next = c + 1; c < kLongClass; c = next++) {
        while (next < kLongClass && classes[next].count == 0) ++next;
        if (next >= kLongClass || classes[c].count == 0 || classes[c].count >= kFewRows) continue;
        if (next - kOwnClass > 2 * (c - kOwnClass)) continue;
        for (uint8_t& to : merged) to = to == c ? static_cast<uint8_t>(next) : to;
        for (size_t i = 0; i < runs.chunk_items.size(); i += kClassCount) {
            runs.chunk_items[i + next] += runs.chunk_items[i + c];
            runs.chunk_items[i + c] = 0;
        }
        classes[next].count += classes[c].count;
        classes[next].row_begin = std::min(classes[next].row_begin, classes[c].row_begin);
        classes[next].row_end = std::max(classes[next].row_end, classes[c].row_end);
        classes[c] = {};
        any = true;
    }
    if (any)
        for_each_index(
            static_cast<uint32_t>(runs.classes.size()),
            [&](uint32_t r) { runs.classes[r] = merged[runs.classes[r]]; }, kChunkRows);
}

uint64_t take(uint64_t& cursor, uint64_t count) {
    return std::exchange(cursor, cursor + count);
}

/// Cuts the rows of a class other than kLongClass into runs.
void plan_class(StencilRuns& runs, uint32_t c, const ClassRows& rows, uint32_t weight_sets) {
    const bool consecutive = rows.count == rows.row_end - rows.row_begin;
    StencilRun run;
    run.kind = c < kOwnClass ? shared::kStencilRunShared : shared::kStencilRunOwn;
    run.entry_count = c < kOwnClass ? runs.patterns[c].entry_count : 2 * (c - kOwnClass);
    if (c < kOwnClass)
        for (uint32_t v = 0; v < runs.patterns[c].value_count; ++v)
            std::fill_n(run.weights + runs.patterns[c].first[v], runs.patterns[c].count[v],
                        std::bit_cast<float>(runs.patterns[c].values[v]));
    if (run.kind == shared::kStencilRunShared) weight_sets = 0;
    const uint64_t item_pairs = uint64_t{run.pair_count()} * (1 + weight_sets) + (consecutive ? 0 : 1);
    const uint64_t run_items =
        std::min<uint64_t>(kMaxRunItems, kMaxRunPairs / std::max<uint64_t>(item_pairs, 1));
    for (uint64_t first = 0; first < rows.count; first += run_items) {
        run.item_count = static_cast<uint32_t>(std::min(run_items, rows.count - first));
        run.row_begin = consecutive ? rows.row_begin + static_cast<uint32_t>(first) : rows.row_begin;
        run.row_end = consecutive ? run.row_begin + run.item_count : rows.row_end;
        const uint64_t section = uint64_t{run.pair_count()} * run.item_count;
        run.begin = runs.pair_count;
        run.index_offset = take(runs.pair_count, section);
        for (uint32_t w = 0; w < weight_sets; ++w) run.weight_offsets[w] = take(runs.pair_count, section);
        run.row_offset = consecutive ? kNoPairs : take(runs.pair_count, (uint64_t{run.item_count} + 1) / 2);
        run.end = runs.pair_count;
        runs.runs.push_back(run);
    }
}

/// Long rows are few: one pass over the classes.
Result<void> plan_long_rows(const StencilTable& table, StencilRuns& runs, const ClassRows& rows,
                            uint32_t weight_sets) {
    StencilRun run;
    run.kind = shared::kStencilRunLong;
    uint64_t entry_pairs = 0;
    const auto finish = [&](uint32_t row_end) {
        run.row_end = row_end;
        run.begin = runs.pair_count;
        run.row_offset = take(runs.pair_count, uint64_t{2} * run.item_count);
        run.index_offset = take(runs.pair_count, entry_pairs);
        for (uint32_t w = 0; w < weight_sets; ++w) run.weight_offsets[w] = take(runs.pair_count, entry_pairs);
        run.end = runs.pair_count;
        runs.runs.push_back(run);
        run.item_count = 0;
        entry_pairs = 0;
    };
    for (uint32_t r = rows.row_begin; r < rows.row_end; ++r) {
        if (runs.classes[r] != kLongClass) continue;
        const uint64_t pairs = (uint64_t{row_of(table, r).entry_count} + 1) / 2;
        if (pairs * (1 + weight_sets) + 2 > kMaxRunPairs)
            return Error{ErrorCode::too_large,
                         "stencil row " + std::to_string(r) + " has too many entries for one dispatch", r};
        if (run.item_count != 0 &&
            (entry_pairs + pairs) * (1 + weight_sets) + 2 * (uint64_t{run.item_count} + 1) > kMaxRunPairs)
            finish(r);
        if (run.item_count++ == 0) run.row_begin = r;
        entry_pairs += pairs;
    }
    if (run.item_count != 0) finish(rows.row_end);
    return {};
}

/// The weights of a table: of points and, where it has them, of both tangents.
struct WeightSets {
    const float* data[3];
    uint32_t count;
};

WeightSets weight_sets_of(const StencilTable& table) {
    if (table.tangent1_weights.empty()) return {{table.weights.data()}, 1};
    return {{table.weights.data(), table.tangent1_weights.data(), table.tangent2_weights.data()}, 3};
}

/// Word of entry k of an item whose section begins at pair `offset` and whose pairs are `pitch` apart.
uint64_t word_of(uint64_t offset, uint64_t pitch, uint32_t k) {
    return 2 * (offset + k / 2 * pitch) + k % 2;
}

/// Writes `padded` entries: those of the row, then some of weight 0 that repeat its last index.
void write_entries(const StencilTable& table, uint32_t r, const StencilRun& run, uint64_t item,
                   uint64_t pitch, uint32_t padded, uint32_t* words) {
    const uint32_t begin = table.offsets[r], count = table.offsets[r + 1] - begin;
    if (count == 0) return;
    const WeightSets sets = weight_sets_of(table);
    for (uint32_t k = 0; k < padded; ++k)
        words[word_of(run.index_offset + item, pitch, k)] = table.indices[begin + std::min(k, count - 1)];
    for (uint32_t w = 0; w < sets.count; ++w)
        for (uint32_t k = 0; k < padded; ++k)
            words[word_of(run.weight_offsets[w] + item, pitch, k)] =
                k < count ? std::bit_cast<uint32_t>(sets.data[w][begin + k]) : 0;
}

/// Whether rows [first, end), of one size, list the same weights in the same order.
bool list_alike(const StencilTable& table, uint32_t first, uint32_t end) {
    const Row row = row_of(table, first);
    const size_t others = size_t{end - first - 1} * row.entry_count;
    return std::memcmp(row.weights, row.weights + row.entry_count, others * sizeof(float)) == 0;
}

/// How many rows from `first` on do so, at least: few enough to stay in cache.
uint32_t count_alike(const StencilTable& table, uint32_t first, uint32_t end) {
    constexpr uint32_t kMost = 256;
    uint32_t count = std::min(kMost, end - first);
    if (count > 1 && !list_alike(table, first, first + 2)) return 1;
    while (!list_alike(table, first, first + count)) count /= 2;
    return count;
}

/// Writes rows [first, end), which have the weights of the pattern, from `item` of the run on.
void write_shared_rows(const StencilTable& table, uint32_t first, uint32_t end, const WeightPattern& pattern,
                       RowOrder& order, const StencilRun& run, uint64_t item, uint32_t* words) {
    words += 2 * (run.index_offset + item);
    while (first < end) {
        const uint32_t count = count_alike(table, first, end);
        const Row row = row_of(table, first);
        match(pattern, row, order);
        const auto write = [&](uint32_t k, uint32_t position) {
            uint32_t* to = words + word_of(0, run.item_count, position);
            for (uint32_t i = 0; i < count; ++i) to[size_t{2} * i] = row.indices[size_t{i} * row.entry_count + k];
        };
        for (uint32_t k = 0; k < row.entry_count; ++k) write(k, order.positions[k]);
        if (row.entry_count % 2 != 0) write(0, row.entry_count);
        words += size_t{2} * count;
        first += count;
    }
}

void write_long_rows(const StencilTable& table, const StencilRuns& runs, StencilRun& run, uint32_t* words) {
    uint32_t item = 0, begin = 0;
    for (uint32_t r = run.row_begin; item < run.item_count; ++r) {
        if (runs.classes[r] != kLongClass) continue;
        const uint32_t count = row_of(table, r).entry_count;
        const uint32_t head[4] = {r, begin, count / 2 + count % 2, 0};
        std::memcpy(words + 2 * (run.row_offset + 2 * uint64_t{item++}), head, sizeof head);
        write_entries(table, r, run, begin, 1, 2 * head[2], words);
        begin += head[2];
    }
}

struct SourceRange {
    uint32_t min = ~uint32_t{0}, max = 0;

    void add(std::span<const uint32_t> indices) {
        for (const uint32_t index : indices) {
            min = std::min(min, index);
            max = std::max(max, index);
        }
    }
};

/// Writes rows [first, end) of class c from `item` of the run on.
void write_rows(const StencilTable& table, const StencilRuns& runs, RowOrders& orders, uint32_t c, uint32_t first,
                uint32_t end, const StencilRun& run, uint32_t item, uint32_t* words) {
    if (c < kOwnClass) {
        write_shared_rows(table, first, end, runs.patterns[c], orders[c], run, item, words);
    } else {
        for (uint32_t r = first; r < end; ++r)
            write_entries(table, r, run, item + (r - first), run.item_count, run.entry_count, words);
    }
    if (run.has_consecutive_rows()) return;
    for (uint32_t r = first; r < end; ++r) words[2 * run.row_offset + item + (r - first)] = r;
}

/// Writes the rows of a chunk, long ones excepted. `ranges` has one element per run.
void write_chunk(const StencilTable& table, const StencilRuns& runs, uint32_t chunk, uint32_t* words,
                 SourceRange* ranges) {
    const uint32_t* items = runs.chunk_items.data() + size_t{chunk} * kClassCount;
    struct Cursor {
        uint32_t run, item;
    } cursors[kClassCount];
    for (uint32_t c = 0; c < kClassCount; ++c) {
        cursors[c] = {runs.first_run[c], items[c]};
        while (cursors[c].run < runs.first_run[c + 1] &&
               cursors[c].item >= runs.runs[cursors[c].run].item_count)
            cursors[c].item -= runs.runs[cursors[c].run++].item_count;
    }
    const uint32_t end = std::min(table.row_count(), (chunk + 1) * kChunkRows);
    RowOrders orders;
    for (uint32_t r = chunk * kChunkRows, next = r; r < end; r = next) {
        const uint32_t c = runs.classes[r];
        while (next < end && runs.classes[next] == c) ++next;
        if (c == kLongClass) continue;
        Cursor& cursor = cursors[c];
        const StencilRun& run = runs.runs[cursor.run];
        next = std::min(next, r + run.item_count - cursor.item);
        write_rows(table, runs, orders, c, r, next, run, cursor.item, words);
        ranges[cursor.run].add({table.indices.data() + table.offsets[r], table.indices.data() + table.offsets[next]});
        cursor.item += next - r;
        if (cursor.item == run.item_count) cursor = {cursor.run + 1, 0};
    }
}

}  // namespace

Result<StencilRuns> plan_stencil_runs(const StencilTable& table) {
    StencilRuns runs;
    const uint32_t weight_sets = weight_sets_of(table).count;
    if (weight_sets == 1) runs.patterns = find_patterns(table);
    auto classes = classify_rows(table, runs);
    merge_small_classes(classes, runs);
    for (uint32_t c = 0; c < kClassCount; ++c) {
        runs.first_run.push_back(static_cast<uint32_t>(runs.runs.size()));
        if (classes[c].count == 0) continue;
        if (c != kLongClass)
            plan_class(runs, c, classes[c], weight_sets);
        else if (auto planned = plan_long_rows(table, runs, classes[c], weight_sets); !planned)
            return planned.error();
    }
    runs.first_run.push_back(static_cast<uint32_t>(runs.runs.size()));
    return runs;
}

void write_stencil_runs(const StencilTable& table, StencilRuns& runs, uint32_t* words) {
    const size_t run_count = runs.runs.size();
    const uint32_t chunk_count = static_cast<uint32_t>(runs.chunk_items.size() / kClassCount);
    std::vector<SourceRange> ranges(run_count * chunk_count);
    for_each_index(
        chunk_count,
        [&](uint32_t chunk) { write_chunk(table, runs, chunk, words, ranges.data() + chunk * run_count); },
        1);
    for (size_t i = 0; i < run_count; ++i) {
        StencilRun& run = runs.runs[i];
        run.source_min = ~uint32_t{0};
        run.source_max = 0;
        for (uint32_t chunk = 0; chunk < chunk_count; ++chunk) {
            run.source_min = std::min(run.source_min, ranges[chunk * run_count + i].min);
            run.source_max = std::max(run.source_max, ranges[chunk * run_count + i].max);
        }
        if (run.kind != shared::kStencilRunLong) {
            // The half of a pair that no row has: what is uploaded is then the same every time.
            if (!run.has_consecutive_rows() && run.item_count % 2 != 0) words[2 * run.row_offset + run.item_count] = 0;
            continue;
        }
        write_long_rows(table, runs, run, words);
        run.source_max = table.source_count - 1;
        run.source_min = 0;
    }
}

}  // namespace limn::vk
