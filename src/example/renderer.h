// Draws the animated vase: what limn does, and what a renderer does around it.
#pragma once

#include <limn/vulkan/tessellator.h>

#include <memory>
#include <vector>

#include "device.h"
#include "mesh.h"

/// Two frames in flight, each with objects of its own. Uses the device that it is given; destroy it before that.
class Renderer {
  public:
    Renderer(const Gpu& gpu, VkExtent2D size);
    ~Renderer();

    /// Records and submits a frame, and waits for none but the one before the last.
    void draw(const Mesh& mesh, float time);

    /// The picture drawn last, four bytes a pixel, and the counts of its tessellation. Waits for it.
    limn::vk::TessellationResult read(std::vector<uint8_t>& pixels);

  private:
    struct State;
    std::unique_ptr<State> state_;
};
