// How the kernels of surfaces read and write buffers. Not part of the public interface.
#pragma once

#include <algorithm>

#include "limn/vulkan/point_buffers.h"
#include "limn/vulkan/recording.h"

namespace limn::vk {

inline constexpr VkFormat kWords = VK_FORMAT_R32_UINT, kFloats = VK_FORMAT_R32_SFLOAT,
                   kWordGroups = VK_FORMAT_R32G32B32A32_UINT, kGroups = VK_FORMAT_R32G32B32A32_SFLOAT,
                   kPoints = VK_FORMAT_R32G32B32_SFLOAT;

/// How the kernels of a device read: through texel buffers or not (reads_texels).
struct Reads {
    const VkPhysicalDeviceLimits& limits;
    bool texel;
    bool point_texels;  ///< reads_point_texels

    BoundBuffer bind(VkBuffer buffer, uint64_t begin, uint64_t end, VkFormat format) const {
        const uint64_t least = texel ? limits.minTexelBufferOffsetAlignment : limits.minStorageBufferOffsetAlignment;
        const uint64_t element = format == kGroups || format == kWordGroups ? 16 : 4;
        begin = format == kPoints ? align_elements(begin, least, 12) : begin - begin % std::max(element, least);
        return {buffer, begin, end - begin,
                texel ? VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, format};
    }
    BoundBuffer write(VkBuffer buffer, uint64_t begin, uint64_t end) const {
        begin -= begin % std::max<uint64_t>(16, limits.minStorageBufferOffsetAlignment);
        return {buffer, begin, end - begin, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, VK_FORMAT_UNDEFINED};
    }
    /// Whether points can be bound as texels, each one's components at once.
    bool are_texels(const PointBuffer& points, uint32_t width) const {
        const uint64_t begin = byte_of(points, 0, 0);
        return point_texels && width == 3 && points.stride % 3 == 0 &&
               align_elements(begin, std::max<uint64_t>(4, limits.minTexelBufferOffsetAlignment), 12) <= begin;
    }
    /// Where component 0 of a point is in a bound buffer, in floats.
    static uint32_t base(const PointBuffer& points, uint64_t point, const BoundBuffer& bound) {
        return static_cast<uint32_t>((byte_of(points, point, 0) - bound.offset_bytes) / 4);
    }
};

}  // namespace limn::vk
