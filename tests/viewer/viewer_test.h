// What viewer tests share: a device that draws, with validation.
#pragma once

#include <gtest/gtest.h>

#include <cstdio>

#include "viewer/graphics_device.h"
#include "viewer/renderer.h"

namespace limn::viewer::test {

/// The device of all tests; null when there is none, and then the test has failed.
inline const GraphicsDevice* shared_device() {
    // Never destroyed: what tests share of it lives as long.
    static const Result<GraphicsDevice>& device = *[] {
        Result<GraphicsDevice> created = GraphicsDevice::create({.validation = true});
        if (created) std::printf("device: %s\n", created->device().name());
        return new Result<GraphicsDevice>(std::move(created));
    }();
    if (device) return &*device;
    ADD_FAILURE() << "no Vulkan device that draws, with validation: " << device.error().message;
    return nullptr;
}

/// Runs on the shared device, and fails when validation has anything to say.
class ViewerTest : public testing::Test {
  protected:
    void SetUp() override {
        graphics_ = shared_device();
        ASSERT_NE(graphics_, nullptr);
        messages_before_ = graphics_->validation_message_count();
    }
    void TearDown() override {
        if (graphics_ == nullptr) return;
        EXPECT_EQ(graphics_->validation_message_count(), messages_before_)
            << graphics_->first_validation_message();
    }
    const vk::Device& device() const { return graphics_->device(); }

    /// One picture of what the renderer has been given; empty, and the test failed, on an error.
    Picture draw(Renderer& renderer, const Renderer::View& view, PassTimer* timer = nullptr) const {
        auto commands = vk::Commands::begin(device());
        EXPECT_TRUE(commands);
        if (!commands) return {};
        if (timer != nullptr) timer->record_begin(*commands);
        renderer.record(*commands, view, timer);
        renderer.record_finish(*commands);
        renderer.record_readback(*commands);
        const auto done = commands->submit_and_wait();
        EXPECT_TRUE(done) << done.error().message;
        return done ? renderer.read_picture() : Picture{};
    }

  private:
    const GraphicsDevice* graphics_ = nullptr;
    uint32_t messages_before_ = 0;
};

}  // namespace limn::viewer::test
