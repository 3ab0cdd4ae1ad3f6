#include "limn/osd/vertex_buffer.h"

#include <cstring>

namespace limn::osd {

VkVertexBuffer* VkVertexBuffer::Create(int numElements, int numVertices, VkDeviceContext* context) {
    if (context == nullptr) return nullptr;
    if (numElements <= 0 || numVertices < 0) {
        context->Fail(
            {ErrorCode::invalid_argument, "a vertex buffer of no elements, or fewer than no vertices"});
        return nullptr;
    }
    std::unique_ptr<VkVertexBuffer> out(new VkVertexBuffer);
    out->num_elements_ = numElements;
    out->num_vertices_ = numVertices;
    auto buffer =
        vk::create_buffer(context->GetDevice(), out->bytes_of(numVertices),
                          vk::kPointUsage | VK_BUFFER_USAGE_VERTEX_BUFFER_BIT, vk::MemoryUse::device);
    if (!buffer) {
        context->Fail(buffer.error());
        return nullptr;
    }
    out->buffer_ = std::move(*buffer);
    out->context_ = context;
    return out.release();
}

VkVertexBuffer::~VkVertexBuffer() {
    if (context_ != nullptr) context_->Forget(buffer_.handle);
}

size_t VkVertexBuffer::bytes_of(int vertices) const {
    return sizeof(float) * static_cast<size_t>(num_elements_) * static_cast<size_t>(vertices);
}

bool VkVertexBuffer::lies_within(int startVertex, int numVertices) const {
    if (startVertex >= 0 && numVertices >= 0 && startVertex <= num_vertices_ - numVertices) return true;
    return context_->Fail({ErrorCode::index_out_of_range, "vertices outside of a vertex buffer"});
}

bool VkVertexBuffer::UpdateData(const float* src, int startVertex, int numVertices,
                                VkDeviceContext* context) {
    VkDeviceContext& to = context != nullptr ? *context : *context_;
    if (!lies_within(startVertex, numVertices)) return false;
    if (numVertices == 0) return true;
    const size_t bytes = bytes_of(numVertices);
    auto staging =
        vk::create_buffer(to.GetDevice(), bytes, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, vk::MemoryUse::upload);
    if (!staging) return to.Fail(staging.error());
    std::memcpy(staging->mapped(), src, bytes);
    const auto held = std::make_shared<const vk::Buffer>(std::move(*staging));
    return to.Execute([&](VkCommandBuffer commands) -> Result<VkDeviceContext::Held> {
        const VkBufferCopy region = {0, bytes_of(startVertex), bytes};
        to.GetDevice().functions.CmdCopyBuffer(commands, held->handle, buffer_.handle, 1, &region);
        return VkDeviceContext::Held(held);
    });
}

bool VkVertexBuffer::ReadData(float* dst, int startVertex, int numVertices, VkDeviceContext* context) const {
    VkDeviceContext& from = context != nullptr ? *context : *context_;
    if (!lies_within(startVertex, numVertices)) return false;
    const std::span<float> values(dst, bytes_of(numVertices) / sizeof(float));
    auto read =
        vk::download_bytes(from.GetDevice(), buffer_, bytes_of(startVertex), std::as_writable_bytes(values));
    return read ? true : from.Fail(read.error());
}

}  // namespace limn::osd
