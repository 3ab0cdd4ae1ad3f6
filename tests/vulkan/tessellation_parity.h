// What a tessellation of the device must share with that of the host.
#pragma once

#include "vulkan/device_tessellation.h"

namespace limn::vk::test {

/// Random rates of 1 (fractional: 2) to `most`, given edge by edge.
TessellationRequest random_request(const limn::test::TestMesh& shape, TessellationSpacing spacing, uint32_t most,
                                   uint32_t seed);

/// Indices and faces are the host's; vertices are where they should be; normals, tangents, places and channels are those of
/// the surface there, by evaluate_patches.
void expect_as_on_host(const TessellatedShape& shape, TessellationSpacing spacing);

double degrees_between(const float* a, const double* b);

}  // namespace limn::vk::test
