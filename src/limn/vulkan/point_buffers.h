// What evaluators ask of the caller's buffers of points. Not part of the public interface.
#pragma once

#include "limn/vulkan/evaluator.h"

namespace limn::vk {

inline Error bad_argument(const char* message) {
    return {ErrorCode::invalid_argument, message};
}

/// `width` components of each point.
inline Result<void> check_points(const PointBuffer& points, uint32_t width) {
    if (points.buffer == VK_NULL_HANDLE) return bad_argument("a buffer of points is null");
    if (points.stride < width) return bad_argument("points overlap: their stride is less than their width");
    if (points.offset_bytes % 4 != 0) return bad_argument("offset_bytes of points is not a multiple of 4");
    return {};
}

/// The last place before byte `offset`, whole elements away, where a binding may begin that has to be aligned; more than
/// `offset` where there is none.
inline uint64_t align_elements(uint64_t offset, uint64_t alignment, uint64_t element_bytes) {
    uint64_t begin = offset - offset % alignment;
    while ((offset - begin) % element_bytes != 0 && begin <= offset) begin -= alignment;
    return begin;
}

/// Where a component is in its buffer, in bytes.
inline uint64_t byte_of(const PointBuffer& points, uint64_t point, uint64_t component) {
    return points.offset_bytes + 4 * (points.first + point * points.stride + component);
}

/// Whether kernels read what they do not write through texel buffers. llvmpipe reads a storage buffer lane by lane, each
/// behind a branch; from a texel buffer it gathers without any. A Catmull-Clark step on lavapipe, 2 cores: plain CSR 20 M
/// rows/s, runs in storage buffers 28, runs in texel buffers 53 to 105. GPUs read storage buffers, whose load units are
/// wider than those of textures (not measured).
inline bool reads_texels(const Device& device) {
    return device.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU &&
           device.properties.limits.maxTexelBufferElements >= uint32_t{1} << 24;
}

/// Whether points of three floats may be texels: fetched at once, where single floats are fetched one by one.
inline bool reads_point_texels(const Device& device) {
    VkFormatProperties format = {};
    device.functions.GetPhysicalDeviceFormatProperties(device.physical_device, VK_FORMAT_R32G32B32_SFLOAT, &format);
    return reads_texels(device) && (format.bufferFeatures & VK_FORMAT_FEATURE_UNIFORM_TEXEL_BUFFER_BIT) != 0;
}

}  // namespace limn::vk
