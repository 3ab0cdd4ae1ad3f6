// Osd::GLVertexBuffer on Vulkan.
#pragma once

#include "limn/osd/device_context.h"

namespace limn::osd {

/// numVertices points of numElements floats each: element e of vertex v is float v * numElements + e. Also
/// what patch coordinates are passed in: Create(5, count, context), for Osd::PatchCoord is five words.
class VkVertexBuffer {
  public:
    /// Null on failure. The buffer may be drawn from: it has vertex usage.
    static VkVertexBuffer* Create(int numElements, int numVertices, VkDeviceContext* context);
    /// The device must be done with it; what was submitted by the context is waited for.
    ~VkVertexBuffer();
    VkVertexBuffer(const VkVertexBuffer&) = delete;
    VkVertexBuffer& operator=(const VkVertexBuffer&) = delete;

    /// Copies numVertices * numElements floats to the vertices from startVertex on, in order with evaluations
    /// before and after. False on failure, or where they lie outside.
    bool UpdateData(const float* src, int startVertex, int numVertices, VkDeviceContext* context = nullptr);
    /// The reverse, for tests and tools: waits for the queue.
    bool ReadData(float* dst, int startVertex, int numVertices, VkDeviceContext* context = nullptr) const;

    int GetNumElements() const { return num_elements_; }
    int GetNumVertices() const { return num_vertices_; }
    VkBuffer BindVkBuffer(VkDeviceContext* = nullptr) const { return buffer_.handle; }
    /// What Osd::Mesh calls.
    VkBuffer BindVBO(VkDeviceContext* = nullptr) const { return buffer_.handle; }

  private:
    VkVertexBuffer() = default;
    bool lies_within(int startVertex, int numVertices) const;
    size_t bytes_of(int vertices) const;

    VkDeviceContext* context_ = nullptr;
    vk::Buffer buffer_;
    int num_elements_ = 0, num_vertices_ = 0;
};

}  // namespace limn::osd
