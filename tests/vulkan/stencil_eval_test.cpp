// stencil_eval against sums in double on the host, on tables of every shape.
#include <algorithm>
#include <cstring>
#include <functional>
#include <limits>
#include <random>

#include "limn/vulkan/evaluator.h"
#include "vulkan/vulkan_test.h"

namespace limn::vk {
namespace {

using test::DevicePoints;
using test::HostPoints;
using test::points_match;

constexpr double kTolerance = 2e-6;  // weights sum to one in magnitude, points lie in [-1, 1]
constexpr float kSentinel = 12345.0f;

struct Entry {
    uint32_t index;
    float weight;
};

StencilTable make_table(uint32_t source_count, uint32_t row_count,
                        const std::function<void(uint32_t row, std::vector<Entry>&)>& make_row) {
    std::vector<uint32_t> offsets = {0}, indices;
    std::vector<float> weights;
    std::vector<Entry> row;
    for (uint32_t r = 0; r < row_count; ++r) {
        row.clear();
        make_row(r, row);
        for (const Entry& entry : row) {
            indices.push_back(entry.index);
            weights.push_back(entry.weight);
        }
        offsets.push_back(static_cast<uint32_t>(indices.size()));
    }
    StencilTable table;
    table.source_count = source_count;
    const auto copy = [](auto& to, const auto& from) {
        to.allocate(from.size());
        std::copy(from.begin(), from.end(), to.begin());
    };
    copy(table.offsets, offsets);
    copy(table.indices, indices);
    copy(table.weights, weights);
    return table;
}

/// Rows of sizes min_size .. max_size with random weights.
StencilTable make_random_table(uint32_t source_count, uint32_t row_count, uint32_t min_size,
                               uint32_t max_size) {
    std::mt19937 random(row_count);
    return make_table(source_count, row_count, [&](uint32_t, std::vector<Entry>& row) {
        const uint32_t size = min_size + static_cast<uint32_t>(random() % (max_size - min_size + 1));
        for (uint32_t k = 0; k < size; ++k)
            row.push_back({static_cast<uint32_t>(random() % source_count),
                           std::uniform_real_distribution(-1.0f, 1.0f)(random) / static_cast<float>(size)});
    });
}

/// One Catmull-Clark step of a torus of n x n quads, children in the order vertices, faces, edges. Every
/// `odd_one`-th vertex has weights of its own.
StencilTable make_step_table(uint32_t n, uint32_t odd_one) {
    const auto at = [n](uint32_t i, uint32_t j) { return (i + n) % n * n + (j + n) % n; };
    return make_table(n * n, 4 * n * n, [&](uint32_t r, std::vector<Entry>& row) {
        const uint32_t kind = r / (n * n), p = r < 2 * n * n ? r % (n * n) : (r - 2 * n * n) / 2;
        const uint32_t i = p / n, j = p % n;
        if (kind == 0) {
            for (uint32_t di = 0; di < 3; ++di)
                for (uint32_t dj = 0; dj < 3; ++dj)
                    row.push_back(
                        {at(i + di - 1, j + dj - 1),
                         di == 1 && dj == 1 ? 36.0f / 64 : (di == 1 || dj == 1 ? 6.0f : 1.0f) / 64});
            if (r % odd_one == 0) row[r % 9].weight += static_cast<float>(r) * 1e-6f;
        } else if (kind == 1) {
            for (uint32_t k = 0; k < 4; ++k) row.push_back({at(i + k / 2, j + k % 2), 0.25f});
        } else {
            const bool along = r % 2 == 0;
            for (uint32_t k = 0; k < 6; ++k) {
                const uint32_t a = k % 2, b = k / 2;  // along the edge, across it
                row.push_back(
                    {along ? at(i + a, j + b - 1) : at(i + b - 1, j + a), b == 1 ? 3.0f / 8 : 1.0f / 16});
            }
        }
        std::sort(row.begin(), row.end(), [](const Entry& a, const Entry& b) { return a.index < b.index; });
    });
}

std::vector<float> make_points(size_t count) {
    std::mt19937 random(7);
    std::vector<float> points(count);
    for (float& value : points) value = std::uniform_real_distribution(-1.0f, 1.0f)(random);
    return points;
}

/// How a test lays points out in a buffer.
struct Layout {
    VkDeviceSize offset_bytes = 0;
    uint64_t first = 0;
    uint32_t stride = 3;

    size_t begin() const { return offset_bytes / 4 + first; }
    PointBuffer in(const Buffer& buffer) const { return {buffer.handle, offset_bytes, first, stride}; }
};

HostPoints evaluate_on_host(const StencilTable& table, const Array<float>& weights,
                            const std::vector<float>& source, const Layout& layout, uint32_t width) {
    HostPoints points;
    points.width = width;
    points.values.resize(size_t{table.row_count()} * width);
    for (size_t r = 0; r < table.row_count(); ++r)
        for (size_t k = table.offsets[r]; k < table.offsets[r + 1]; ++k)
            for (size_t i = 0; i < width; ++i)
                points.values[r * width + i] +=
                    double{weights[k]} *
                    source[layout.begin() + size_t{table.indices[k]} * layout.stride + i];
    return points;
}

/// How many values that are not of a point of rows [first_row, end_row) have been written to.
size_t count_touched_gaps(const DevicePoints& points, uint32_t width, size_t first_row, size_t end_row) {
    size_t touched = 0;
    for (size_t i = 0; i < points.values.size(); ++i) {
        const size_t row = i < points.first ? ~size_t{0} : (i - points.first) / points.stride;
        const bool inside = row >= first_row && row < end_row && (i - points.first) % points.stride < width;
        touched += !inside && points.values[i] != kSentinel;
    }
    return touched;
}

/// A test's source and destination on the device.
struct Points {
    Buffer source, destination;
};

class StencilEval : public test::VulkanTest {
  protected:
    void SetUp() override {
        VulkanTest::SetUp();
        if (HasFatalFailure()) return;
        auto evaluator = Evaluator::create(device());
        ASSERT_TRUE(evaluator) << evaluator.error().message;
        evaluator_.emplace(std::move(*evaluator));
    }
    void TearDown() override {
        evaluator_.reset();
        VulkanTest::TearDown();
    }

    Buffer upload(std::span<const float> values) {
        auto buffer = create_point_buffer(device(), values);
        EXPECT_TRUE(buffer) << buffer.error().message;
        return buffer ? std::move(*buffer) : Buffer{};
    }

    Buffer upload_sentinels(size_t count) { return upload(std::vector<float>(count, kSentinel)); }

    DeviceStencilTable upload(const StencilTable& table) {
        auto uploaded = upload_stencil_table(device(), table);
        EXPECT_TRUE(uploaded) << uploaded.error().message;
        return uploaded ? std::move(*uploaded) : DeviceStencilTable{};
    }

    /// Prepares, records, submits, waits.
    void run(const StencilEvaluationInfo& info) {
        auto evaluation = evaluator_->prepare(info);
        ASSERT_TRUE(evaluation) << evaluation.error().message;
        auto commands = Commands::begin(device());
        ASSERT_TRUE(commands) << commands.error().message;
        evaluation->record(*commands);
        const auto submitted = commands->submit_and_wait();
        ASSERT_TRUE(submitted) << submitted.error().message;
    }

    DevicePoints read(const Buffer& buffer, const Layout& layout) {
        auto values = download<float>(device(), buffer, buffer.size_bytes / 4);
        EXPECT_TRUE(values) << values.error().message;
        return {values ? std::move(*values) : std::vector<float>{}, layout.begin(), layout.stride};
    }

    /// Evaluates and checks all of a table's points.
    void check(const StencilTable& table, uint32_t width, const Layout& from, const Layout& to,
               double tolerance, bool storage_only_source = false, bool padded_source = false) {
        auto points = make_points(from.begin() + size_t{table.source_count} * from.stride);
        for (size_t i = from.begin() + 3; padded_source && i < points.size(); i += from.stride)
            points[i] = std::numeric_limits<float>::quiet_NaN();
        const Buffer source = upload(points);
        const Buffer destination = upload_sentinels(to.begin() + size_t{table.row_count()} * to.stride + 3);
        const DeviceStencilTable device_table = upload(table);
        run({.table = &device_table,
             .width = width,
             .source = from.in(source),
             .destination = to.in(destination),
             .padded_source = padded_source,
             .storage_only_source = storage_only_source});
        const DevicePoints result = read(destination, to);
        EXPECT_TRUE(
            points_match(evaluate_on_host(table, table.weights, points, from, width), result, tolerance));
        EXPECT_EQ(count_touched_gaps(result, width, 0, table.row_count()), 0u);
    }

    std::optional<Evaluator> evaluator_;
};

TEST_F(StencilEval, MatchesHostForEveryWidthOffsetAndStride) {
    const StencilTable table = make_random_table(500, 3000, 0, 40);
    for (uint32_t width = 1; width <= 9; ++width) {
        SCOPED_TRACE(width);
        check(table, width, {.offset_bytes = 12, .first = 5, .stride = width + 2},
              {.offset_bytes = 20, .first = 3, .stride = width + 1}, kTolerance);
    }
}

TEST_F(StencilEval, MatchesHostWhereRowsShareWeights) {
    for (const uint32_t odd_one : {1000000u, 7u, 1u}) {
        SCOPED_TRACE(odd_one);
        check(make_step_table(48, odd_one), 3, {}, {}, kTolerance);
    }
}

TEST_F(StencilEval, SharedWeightsMakeTheTableSmaller) {
    const StencilTable table = make_step_table(64, 1000000);
    const DeviceStencilTable device_table = upload(table);
    EXPECT_EQ(device_table.runs.size(), 3u);
    EXPECT_LT(device_table.bytes(), table.bytes() * 6 / 10);
}

TEST_F(StencilEval, MatchesHostFromSourcesWithoutTexelUsage) {
    check(make_step_table(32, 5), 3, {.first = 1, .stride = 4}, {.stride = 5}, kTolerance, true);
    check(make_random_table(500, 3000, 0, 70), 2, {.stride = 2}, {.stride = 2}, kTolerance, true);
}

// Points of four components on 16-byte boundaries are fetched whole on CPU devices; next to a boundary they
// are not.
TEST_F(StencilEval, FetchesPointsOfFourComponents) {
    for (const uint32_t width : {4u, 8u}) {
        for (const Layout& from :
             {Layout{.stride = width}, Layout{.offset_bytes = 16, .first = 4, .stride = width + 4},
              Layout{.offset_bytes = 4, .first = 3, .stride = width},
              Layout{.offset_bytes = 4, .stride = width}, Layout{.stride = width + 1}}) {
            check(make_step_table(32, 5), width, from, {.first = 1, .stride = width + 2}, kTolerance);
            check(make_random_table(500, 3000, 0, 70), width, from, {.stride = width}, kTolerance);
        }
    }
}

// So are points of three, wherever they begin: as texels of three floats, or with the float behind them where there is
// one.
TEST_F(StencilEval, FetchesPointsOfThreeComponents) {
    for (VkDeviceSize offset_bytes = 0; offset_bytes <= 48; offset_bytes += 4) {
        SCOPED_TRACE(offset_bytes);
        for (const uint32_t stride : {3u, 4u, 6u, 8u}) {
            const Layout from = {.offset_bytes = offset_bytes, .stride = stride};
            check(make_step_table(16, 5), 3, from, {.first = 1, .stride = 5}, kTolerance);
            check(make_random_table(50, 300, 0, 40), 3, from, {}, kTolerance, false, stride % 4 == 0);
        }
    }
}

TEST_F(StencilEval, MatchesHostForLongAndEmptyRows) {
    check(make_random_table(9000, 40, 1900, 2100), 3, {}, {}, 1e-5);
    check(make_random_table(100, 1000, 60, 70), 4, {.stride = 4}, {.stride = 4}, kTolerance);
    check(make_random_table(100, 1000, 0, 0), 3, {}, {}, 0);
    check(make_random_table(1, 1, 1, 1), 1, {.stride = 1}, {.stride = 1}, kTolerance);
}

TEST_F(StencilEval, WritesRowsOfTheRangeOnly) {
    const uint32_t width = 3;
    const StencilTable table = make_step_table(40, 3);
    const DeviceStencilTable device_table = upload(table);
    const auto points = make_points(size_t{table.source_count} * width);
    const Buffer source = upload(points);
    const HostPoints host = evaluate_on_host(table, table.weights, points, {}, width);
    for (const auto& [first, count] :
         {std::pair{0u, 1u}, {1597u, 10u}, {1000u, 3000u}, {6399u, 99u}, {6400u, 5u}}) {
        SCOPED_TRACE(first);
        const Buffer destination = upload_sentinels(host.values.size());
        run({.table = &device_table,
             .width = width,
             .source = {.buffer = source.handle},
             .destination = {.buffer = destination.handle},
             .first_row = first,
             .row_count = count});
        const DevicePoints result = read(destination, {});
        const size_t end = std::min<size_t>(table.row_count(), size_t{first} + count);
        EXPECT_EQ(count_touched_gaps(result, width, first, end), 0u);
        if (first >= end) continue;
        HostPoints part = {
            {host.values.begin() + first * width, host.values.begin() + static_cast<long>(end * width)},
            width};
        EXPECT_TRUE(points_match(part, {result.values, size_t{first} * width, width}, kTolerance));
    }
}

TEST_F(StencilEval, EvaluatesTangents) {
    StencilTable table = make_random_table(300, 2000, 0, 70);
    const auto reversed = [&](Array<float>& weights, float factor) {
        weights.allocate(table.weights.size());
        for (size_t i = 0; i < weights.size(); ++i)
            weights[i] = table.weights[weights.size() - 1 - i] * factor;
    };
    reversed(table.tangent1_weights, 0.5f);
    reversed(table.tangent2_weights, -0.7f);
    const DeviceStencilTable device_table = upload(table);
    const Layout from = {.stride = 5}, to = {.offset_bytes = 4, .stride = 4};
    const auto points = make_points(size_t{table.source_count} * from.stride);
    const Buffer source = upload(points);
    const size_t size = to.begin() + size_t{table.row_count()} * to.stride;
    const Buffer buffers[3] = {upload_sentinels(size), upload_sentinels(size), upload_sentinels(size)};
    run({.table = &device_table,
         .width = 3,
         .source = from.in(source),
         .destination = to.in(buffers[0]),
         .tangent1 = to.in(buffers[1]),
         .tangent2 = to.in(buffers[2])});
    const Array<float>* const weights[3] = {&table.weights, &table.tangent1_weights, &table.tangent2_weights};
    for (int i = 0; i < 3; ++i) {
        const DevicePoints result = read(buffers[i], to);
        EXPECT_TRUE(points_match(evaluate_on_host(table, *weights[i], points, from, 3), result, 1e-5)) << i;
        EXPECT_EQ(count_touched_gaps(result, 3, 0, table.row_count()), 0u);
    }
}

TEST_F(StencilEval, ChainsLevelsInOneCommandBuffer) {
    const StencilTable tables[2] = {make_step_table(16, 1000000), make_step_table(32, 1000000)};
    const DeviceStencilTable device_tables[2] = {upload(tables[0]), upload(tables[1])};
    const auto points = make_points(size_t{tables[0].source_count} * 3);
    const Buffer buffers[3] = {upload(points), upload_sentinels(32 * 32 * 3), upload_sentinels(64 * 64 * 3)};
    auto commands = Commands::begin(device());
    ASSERT_TRUE(commands);
    std::vector<StencilEvaluation> evaluations;
    for (size_t level = 0; level < 2; ++level) {
        auto evaluation = evaluator_->prepare({.table = &device_tables[level],
                                               .source = {.buffer = buffers[level].handle},
                                               .destination = {.buffer = buffers[level + 1].handle}});
        ASSERT_TRUE(evaluation) << evaluation.error().message;
        evaluation->record(*commands);
        record_barrier(device(), *commands, kKernelWrites, kKernelReads);
        evaluations.push_back(std::move(*evaluation));
    }
    ASSERT_TRUE(commands->submit_and_wait());
    const HostPoints middle = evaluate_on_host(tables[0], tables[0].weights, points, {}, 3);
    const std::vector<float> between(middle.values.begin(), middle.values.end());
    EXPECT_TRUE(points_match(evaluate_on_host(tables[1], tables[1].weights, between, {}, 3),
                             read(buffers[2], {}), kTolerance));
}

TEST_F(StencilEval, GivesTheSameBitsEveryTime) {
    const StencilTable table = make_random_table(5000, 20000, 0, 80);
    const Buffer source = upload(make_points(size_t{table.source_count} * 3));
    std::vector<float> results[2];
    for (std::vector<float>& result : results) {
        const DeviceStencilTable device_table = upload(table);
        const Buffer destination = upload_sentinels(size_t{table.row_count()} * 3);
        run({.table = &device_table,
             .source = {.buffer = source.handle},
             .destination = {.buffer = destination.handle}});
        result = read(destination, {}).values;
    }
    ASSERT_EQ(results[0].size(), results[1].size());
    EXPECT_EQ(std::memcmp(results[0].data(), results[1].data(), results[0].size() * 4), 0);
}

TEST_F(StencilEval, DispatchesMoreThan65535Workgroups) {
    const uint32_t row_count = 64 * 65535 + 1000;
    const StencilTable table = make_table(1000, row_count, [](uint32_t r, std::vector<Entry>& row) {
        row.push_back({r % 1000, 1.0f});
    });
    check(table, 1, {.stride = 1}, {.stride = 1}, 0);
}

/// Source, table and result are each larger than lavapipe's maxStorageBufferRange of 128 MiB; neighbouring
/// rows refer to neighbouring sources.
TEST_F(StencilEval, SlicesWhatIsTooLargeToBind) {
    const uint32_t row_count = 4'500'000, source_count = 4'500'000;
    const StencilTable table = make_table(source_count, row_count, [](uint32_t r, std::vector<Entry>& row) {
        for (uint32_t k = 0; k < 4; ++k)
            row.push_back(
                {std::min(r + 17 * k, source_count - 1), static_cast<float>((r * 4 + k) % 1009) / 4036.0f});
    });
    const Layout from = {.offset_bytes = 4, .stride = 8}, to = {.first = 3, .stride = 8};
    const auto points = make_points(from.begin() + size_t{source_count} * from.stride);
    const HostPoints host = evaluate_on_host(table, table.weights, points, from, 2);
    const DeviceStencilTable device_table = upload(table);
    const uint64_t range = 128 << 20;
    EXPECT_GT(device_table.bytes(), range);
    EXPECT_GT(points.size() * 4, range);
    const Buffer source = upload(points);
    for (const bool storage_only_source : {false, true}) {
        SCOPED_TRACE(storage_only_source);
        const Buffer destination = upload_sentinels(to.begin() + size_t{row_count} * to.stride);
        run({.table = &device_table,
             .width = 2,
             .source = from.in(source),
             .destination = to.in(destination),
             .storage_only_source = storage_only_source});
        const DevicePoints result = read(destination, to);
        EXPECT_TRUE(points_match(host, result, kTolerance));
        EXPECT_EQ(count_touched_gaps(result, 2, 0, row_count), 0u);
    }
}

TEST_F(StencilEval, RefusesSourcesThatCannotBeBound) {
    const uint64_t range = device().properties.limits.maxStorageBufferRange;
    if (range > 256 << 20)
        GTEST_SKIP() << device().name() << " binds " << range << " bytes at once: too many for a test";
    const uint32_t source_count = 5'000'000, stride = static_cast<uint32_t>(range / 4 / source_count) + 2;
    const StencilTable table = make_table(source_count, 1, [](uint32_t, std::vector<Entry>& row) {
        row = {{0, 0.5f}, {source_count - 1, 0.5f}};
    });
    const DeviceStencilTable device_table = upload(table);
    const Buffer source = upload(std::vector<float>(size_t{source_count} * stride)),
                 destination = upload_sentinels(3);
    const auto evaluation = evaluator_->prepare({.table = &device_table,
                                                 .source = {.buffer = source.handle, .stride = stride},
                                                 .destination = {.buffer = destination.handle},
                                                 .storage_only_source = true});
    ASSERT_FALSE(evaluation);
    EXPECT_EQ(evaluation.error().code, ErrorCode::unsupported);
}

TEST_F(StencilEval, RefusesWhatMakesNoSense) {
    const DeviceStencilTable table = upload(make_random_table(10, 10, 1, 4));
    const Buffer source = upload(make_points(30)), destination = upload_sentinels(30);
    const StencilEvaluationInfo good = {
        .table = &table, .source = {.buffer = source.handle}, .destination = {.buffer = destination.handle}};
    const auto refused = [&](auto change) {
        StencilEvaluationInfo info = good;
        change(info);
        const auto evaluation = evaluator_->prepare(info);
        return !evaluation && evaluation.error().code == ErrorCode::invalid_argument;
    };
    EXPECT_TRUE(evaluator_->prepare(good));
    EXPECT_TRUE(refused([](auto& info) { info.table = nullptr; }));
    EXPECT_TRUE(refused([](auto& info) { info.width = 0; }));
    EXPECT_TRUE(refused([](auto& info) { info.width = 4; }));
    EXPECT_TRUE(refused([](auto& info) { info.source.buffer = VK_NULL_HANDLE; }));
    EXPECT_TRUE(refused([](auto& info) { info.source.offset_bytes = 2; }));
    EXPECT_TRUE(refused([](auto& info) { info.tangent1 = info.destination; }));
}

TEST_F(StencilEval, TakesAnEmptyTable) {
    const DeviceStencilTable table = upload(make_random_table(10, 0, 0, 1));
    const Buffer source = upload(make_points(30)), destination = upload_sentinels(30);
    run({.table = &table,
         .source = {.buffer = source.handle},
         .destination = {.buffer = destination.handle}});
    EXPECT_EQ(count_touched_gaps(read(destination, {}), 3, 0, 0), 0u);
}

/// Validation must see kernels that race, or its silence above says nothing about barriers.
TEST(StencilEvalValidation, SeesAMissingBarrierBetweenLevels) {
    const auto context = Context::create({.validation = true});
    ASSERT_TRUE(context) << context.error().message;
    const Device& device = context->device();
    const auto evaluator = Evaluator::create(device);
    ASSERT_TRUE(evaluator) << evaluator.error().message;
    const auto table = upload_stencil_table(device, make_step_table(8, 3));
    const auto first = create_point_buffer(device, make_points(8 * 8 * 3));
    const auto second = create_point_buffer(device, make_points(16 * 16 * 3));
    const auto third = create_point_buffer(device, make_points(16 * 16 * 3));
    const auto commands = Commands::begin(device);
    ASSERT_TRUE(table && first && second && third && commands);
    const auto evaluation = evaluator->prepare(
        {.table = &*table, .source = {.buffer = first->handle}, .destination = {.buffer = second->handle}});
    const auto next = evaluator->prepare(
        {.table = &*table, .source = {.buffer = second->handle}, .destination = {.buffer = third->handle}});
    ASSERT_TRUE(evaluation && next);
    evaluation->record(*commands);
    EXPECT_EQ(context->validation_message_count(), 0u) << context->first_validation_message();
    next->record(*commands);
    EXPECT_GT(context->validation_message_count(), 0u);
}

/// The comparison must see a wrong weight, or none of the tests above says anything.
TEST_F(StencilEval, OnePerturbedWeightIsSeen) {
    StencilTable table = make_step_table(16, 1000000);
    const auto points = make_points(size_t{table.source_count} * 3);
    const HostPoints host = evaluate_on_host(table, table.weights, points, {}, 3);
    table.weights[1234] += 1e-3f;
    const Buffer source = upload(points), destination = upload_sentinels(host.values.size());
    const DeviceStencilTable device_table = upload(table);
    run({.table = &device_table,
         .source = {.buffer = source.handle},
         .destination = {.buffer = destination.handle}});
    EXPECT_FALSE(points_match(host, read(destination, {}), kTolerance));
}

}  // namespace
}  // namespace limn::vk
