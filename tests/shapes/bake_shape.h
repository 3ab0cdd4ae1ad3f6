// Shapes, baked with all there is.
#pragma once

#include "limn/baked_mesh.h"
#include "shapes/shapes.h"

namespace limn::test {

/// Channels are left out where they have no tables; `extras`: also what is baked only where asked for.
inline Result<BakedMesh> bake_shape(const TestMesh& shape, bool extras) {
    BakeOptions options;
    options.max_rate = 16;
    for (const TestChannel& channel : shape.channels) options.channel_values.emplace_back(channel.values);
    if (extras) {
        options.grid_rates = {3};
        options.refined_levels = {1, 2};
        options.stencil_levels = {1};
        options.limit_levels = {1};
    }
    ControlMeshDescription description = shape.description();
    description.positions = shape.positions;
    auto baked = bake_mesh(description, options);
    if (baked || baked.error().code != ErrorCode::unsupported || shape.channels.empty()) return baked;
    options.channel_values.clear();
    return bake_mesh(description, options);
}

}  // namespace limn::test
