// A program as OpenSubdiv's users write them: templated on buffer, table and evaluator types, and compiled
// twice, with OpenSubdiv's CPU types and with limn::osd's.
#pragma once

#include <opensubdiv/osd/cpuEvaluator.h>
#include <opensubdiv/osd/cpuPatchTable.h>
#include <opensubdiv/osd/cpuVertexBuffer.h>

#include <memory>
#include <vector>

#include "limn/osd/evaluator.h"

namespace limn::osd::test {

// clang-format off
struct CpuTypes {
    using VertexBuffer = Osd::CpuVertexBuffer;
    using StencilTable = Far::StencilTable;
    using LimitStencilTable = Far::LimitStencilTable;
    using PatchTable = Osd::CpuPatchTable;
    using Evaluator = Osd::CpuEvaluator;
    using DeviceContext = void;

    static StencilTable* convert(const Far::StencilTable& table, void*) { return new Far::StencilTable(table); }
    static LimitStencilTable* convert(const Far::LimitStencilTable& table, void*) {
        return new Far::LimitStencilTable(table);
    }
    static std::vector<float> read(VertexBuffer& buffer) {
        const float* data = buffer.BindCpuBuffer();
        return {data, data + buffer.GetNumElements() * buffer.GetNumVertices()};
    }
};
struct VkTypes {
    using VertexBuffer = VkVertexBuffer;
    using StencilTable = VkStencilTable;
    using LimitStencilTable = VkStencilTable;
    using PatchTable = VkPatchTable;
    using Evaluator = VkEvaluator;
    using DeviceContext = VkDeviceContext;

    template <class Table>
    static VkStencilTable* convert(const Table& table, VkDeviceContext* context) {
        return VkStencilTable::Create(&table, context);
    }
    static std::vector<float> read(VertexBuffer& buffer) {
        std::vector<float> values(static_cast<size_t>(buffer.GetNumElements() * buffer.GetNumVertices()));
        if (!buffer.ReadData(values.data(), 0, buffer.GetNumVertices())) values.clear();
        return values;
    }
};
// clang-format on

enum class Kind { vertex, varying, face_varying };

/// Primvars of `length` floats, in points of `stride` floats from float `offset` on.
struct Primvar {
    Kind kind = Kind::vertex;
    int channel = 0;
    int length = 3, stride = 3, offset = 0;
    const Far::StencilTable* stencils = nullptr;  ///< null, or of no rows: all points are there
    std::vector<float> control;                   ///< points of `stride` floats
};

struct Results {
    bool ok = false;
    std::vector<float> points;  ///< control points, refined points, local points: of `stride` floats
    std::vector<float>
        records;  ///< per coordinate: value, du, dv, duu, duv, dvv, `length` floats each, and two more
};

inline const std::vector<float>& marked(std::vector<float>& values) {
    for (float& value : values) value = -77.0f;
    return values;
}

/// Refines control points into the same buffer, and evaluates patches at the coordinates.
template <class Types>
Results run_program(const Primvar& primvar, const Far::PatchTable& far_patches,
            const std::vector<Osd::PatchCoord>& coords, typename Types::DeviceContext* context) {
    using Buffer = typename Types::VertexBuffer;
    using Evaluator = typename Types::Evaluator;
    const int control_count = static_cast<int>(primvar.control.size()) / primvar.stride;
    const int refined_count = primvar.stencils != nullptr ? primvar.stencils->GetNumStencils() : 0;
    const int point_count = control_count + refined_count;
    const int coord_count = static_cast<int>(coords.size()), record = 6 * primvar.length + 2;
    const std::unique_ptr<typename Types::PatchTable> patches(
        Types::PatchTable::Create(&far_patches, context));
    const std::unique_ptr<Buffer> points(Buffer::Create(primvar.stride, point_count, context));
    const std::unique_ptr<Buffer> records(Buffer::Create(record, coord_count, context));
    const std::unique_ptr<Buffer> places(Buffer::Create(5, coord_count, context));
    Results results;
    if (!patches || !points || !records || !places) return results;

    std::vector<float> blank(static_cast<size_t>(primvar.stride * point_count));
    points->UpdateData(marked(blank).data(), 0, point_count, context);
    points->UpdateData(primvar.control.data(), 0, control_count, context);
    blank.resize(static_cast<size_t>(record * coord_count));
    records->UpdateData(marked(blank).data(), 0, coord_count, context);
    places->UpdateData(reinterpret_cast<const float*>(coords.data()), 0, coord_count, context);

    const Osd::BufferDescriptor src(primvar.offset, primvar.length, primvar.stride);
    Osd::BufferDescriptor dst = src;
    dst.offset += control_count * primvar.stride;
    results.ok = true;
    if (refined_count != 0) {
        const std::unique_ptr<typename Types::StencilTable> stencils(
            Types::convert(*primvar.stencils, context));
        results.ok = stencils && Evaluator::EvalStencils(points.get(), src, points.get(), dst, stencils.get(),
                                                         nullptr, context);
    }

    Osd::BufferDescriptor out[6];
    for (int d = 0; d < 6; ++d)
        out[d] = Osd::BufferDescriptor(1 + d * primvar.length, primvar.length, record);
    Buffer *from = points.get(), *to = records.get();
    if (primvar.kind == Kind::vertex)
        results.ok &=
            Evaluator::EvalPatches(from, src, to, out[0], to, out[1], to, out[2], to, out[3], to, out[4], to,
                                   out[5], coord_count, places.get(), patches.get(), nullptr, context);
    else if (primvar.kind == Kind::varying)
        results.ok &= Evaluator::EvalPatchesVarying(from, src, to, out[0], to, out[1], to, out[2], to, out[3],
                                                    to, out[4], to, out[5], coord_count, places.get(),
                                                    patches.get(), nullptr, context);
    else
        results.ok &= Evaluator::EvalPatchesFaceVarying(
            from, src, to, out[0], to, out[1], to, out[2], to, out[3], to, out[4], to, out[5], coord_count,
            places.get(), patches.get(), primvar.channel, nullptr, context);
    Evaluator::Synchronize(context);
    results.points = Types::read(*points);
    results.records = Types::read(*records);
    return results;
}

/// Limit stencils with both kinds of derivatives: records as above.
template <class Types>
Results run_limits(const Far::LimitStencilTable& far_stencils, const std::vector<float>& control,
                   typename Types::DeviceContext* context) {
    using Buffer = typename Types::VertexBuffer;
    const int control_count = static_cast<int>(control.size() / 3), count = far_stencils.GetNumStencils();
    const std::unique_ptr<typename Types::LimitStencilTable> stencils(Types::convert(far_stencils, context));
    const std::unique_ptr<Buffer> points(Buffer::Create(3, control_count, context));
    const std::unique_ptr<Buffer> records(Buffer::Create(20, count, context));
    Results results;
    if (!stencils || !points || !records) return results;
    std::vector<float> blank(static_cast<size_t>(20 * count));
    records->UpdateData(marked(blank).data(), 0, count, context);
    points->UpdateData(control.data(), 0, control_count, context);
    Osd::BufferDescriptor out[6];
    for (int d = 0; d < 6; ++d) out[d] = Osd::BufferDescriptor(1 + 3 * d, 3, 20);
    Buffer* to = records.get();
    results.ok = Types::Evaluator::EvalStencils(points.get(), Osd::BufferDescriptor(0, 3, 3), to, out[0], to,
                                                out[1], to, out[2], to, out[3], to, out[4], to, out[5],
                                                stencils.get(), nullptr, context);
    Types::Evaluator::Synchronize(context);
    results.records = Types::read(*records);
    return results;
}

}  // namespace limn::osd::test
