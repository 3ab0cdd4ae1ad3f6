// The camera, the lights and the look of one picture, as shaders take them.
#pragma once

#include "../../shaders/frame_params.h"
#include "viewer/scene.h"

namespace limn::viewer {

/// `mesh` decides which of its optional parts shaders may read. `extent` is not empty.
shared::FrameParams build_frame_params(const Camera& camera, const Bounds& bounds,
                                       const RenderSettings& settings, const RenderMesh& mesh,
                                       VkExtent2D extent);

}  // namespace limn::viewer
