// What Vulkan tests share: a device with validation, and a comparison that cannot be given the same points
// twice.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "limn/vulkan/buffer.h"

namespace limn::vk::test {

/// Points computed on the host, in double: value i of point p is values[p * width + i].
struct HostPoints {
    std::vector<double> values;
    uint32_t width = 3;
};

/// Points read back from a device: value i of point p is values[first + p * stride + i].
struct DevicePoints {
    std::vector<float> values;
    size_t first = 0;
    size_t stride = 3;
};

/// Succeeds when every value differs by `tolerance` at most; NaN never matches.
inline testing::AssertionResult points_match(const HostPoints& host, const DevicePoints& device,
                                             double tolerance) {
    const size_t count = host.values.size() / host.width;
    if (count == 0) return testing::AssertionFailure() << "there is nothing to compare";
    if (device.values.size() < device.first + (count - 1) * device.stride + host.width)
        return testing::AssertionFailure() << "the device gave " << device.values.size() << " values only";
    size_t bad = 0, worst = 0;
    double worst_error = -1;
    for (size_t i = 0; i < host.values.size(); ++i) {
        const double value = device.values[device.first + i / host.width * device.stride + i % host.width];
        const double error = std::abs(value - host.values[i]);
        if (error <= tolerance) continue;
        ++bad;
        if (!(error <= worst_error)) worst = i, worst_error = error;
    }
    if (bad == 0) return testing::AssertionSuccess();
    return testing::AssertionFailure()
           << bad << " of " << host.values.size() << " values are off; point " << worst / host.width
           << " component " << worst % host.width << " by " << worst_error << ", host " << host.values[worst];
}

/// The largest side of the box of values, `width` for each.
inline double size_of(const std::vector<float>& values, size_t width) {
    double size = 0;
    for (size_t k = 0; k < width; ++k) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (size_t i = k; i < values.size(); i += width) {
            low = std::min(low, double{values[i]});
            high = std::max(high, double{values[i]});
        }
        size = std::max(size, high - low);
    }
    return size;
}

/// 2e-6 of it, and 4 ulp of the largest value.
inline double tolerance_of(const std::vector<float>& values, size_t width) {
    double largest = 0;
    for (const float value : values) largest = std::max(largest, std::abs(double{value}));
    return 2e-6 * size_of(values, width) + 4 * largest * std::ldexp(1.0, -23);
}

/// The device of all tests, with validation; null when there is none, and then the test has failed.
inline const Context* shared_context() {
    static const Result<Context> context = [] {
        Result<Context> created = Context::create({.validation = true});
        if (created) std::printf("device: %s\n", created->device().name());
        return created;
    }();
    if (context) return &*context;
    ADD_FAILURE() << "no Vulkan device with validation: " << context.error().message;
    return nullptr;
}

/// Runs on the shared device, and fails when validation has anything to say.
class VulkanTest : public testing::Test {
  protected:
    void SetUp() override {
        context_ = shared_context();
        ASSERT_NE(context_, nullptr);
        messages_before_ = context_->validation_message_count();
    }
    void TearDown() override {
        if (context_ == nullptr) return;
        EXPECT_EQ(context_->validation_message_count(), messages_before_)
            << context_->first_validation_message();
    }
    const Device& device() const { return as_gpu_ ? *as_gpu_ : context_->device(); }
    /// From here on the device is taken for one that is no CPU: kernels read storage buffers, uploads are staged.
    /// And so many bytes are all that it binds of a buffer at once.
    void pretend_gpu(uint32_t max_range = ~0u) {
        as_gpu_ = context_->device();
        as_gpu_->properties.deviceType = VK_PHYSICAL_DEVICE_TYPE_OTHER;
        uint32_t& range = as_gpu_->properties.limits.maxStorageBufferRange;
        range = std::min(range, max_range);
    }

    /// Records, submits, waits: what kernels wrote is then there for kernels, and for copies to the host.
    template <class Record>
    void run(const Record& record) {
        Result<Commands> commands = Commands::begin(device());
        record(commands->handle());
        record_barrier(device(), *commands, kKernelWrites, kKernelReads | kCopyReads);
        EXPECT_TRUE(commands->submit_and_wait());
    }
    /// Four at least, all of them 7.
    Buffer words(size_t count) {
        const std::vector<uint32_t> filled(std::max<size_t>(count, 4), 7);
        Buffer buffer = *create_buffer(device(), 4 * filled.size(), kPointUsage, MemoryUse::device);
        EXPECT_TRUE(upload_bytes(device(), buffer, 0, std::as_bytes(std::span(filled))));
        return buffer;
    }
    std::vector<uint32_t> read(const Buffer& buffer, size_t count) {
        return *download<uint32_t>(device(), buffer, count);
    }

  private:
    const Context* context_ = nullptr;
    std::optional<Device> as_gpu_;
    uint32_t messages_before_ = 0;
};

}  // namespace limn::vk::test
