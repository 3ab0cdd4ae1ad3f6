// limn::osd against OpenSubdiv's CPU evaluator: the same program with the types of either, on every shape.
#include <gtest/gtest.h>
#include <opensubdiv/far/patchTableFactory.h>
#include <opensubdiv/far/ptexIndices.h>
#include <opensubdiv/far/stencilTableFactory.h>
#include <opensubdiv/osd/mesh.h>

#include <bit>
#include <set>

#include "conformance/osd_refiner.h"
#include "osd/osd_program.h"
#include "shapes/shapes.h"
#include "vulkan/vulkan_test.h"

namespace limn::osd::test {
namespace {

using limn::test::TestMesh;
using Options = Far::PatchTableFactory::Options;
using Stencils = Far::StencilTableFactory;
using StencilTablePointer = std::unique_ptr<const Far::StencilTable>;

constexpr int kUniform = -1;

/// A mesh as Far refines it: by an end cap, or uniformly.
struct Tables {
    std::unique_ptr<Far::TopologyRefiner> refiner;
    std::unique_ptr<const Far::PatchTable> patches;
    int cap = 0;
};

Tables make_tables(const TestMesh& mesh, int cap, int level) {
    std::string error;
    Tables out{limn::test::make_osd_refiner(mesh, &error), nullptr, cap};
    if (!out.refiner) return out;
    Options options(static_cast<unsigned>(level));
    options.generateFVarTables = !mesh.channels.empty();
    options.includeFVarBaseLevelIndices = true;
    options.generateFVarLegacyLinearPatches = false;
    options.generateLegacySharpCornerPatches = false;
    options.useInfSharpPatch = true;
    if (cap == kUniform) {
        Far::TopologyRefiner::UniformOptions uniform(static_cast<unsigned>(level));
        uniform.fullTopologyInLastLevel = true;
        out.refiner->RefineUniform(uniform);
    } else {
        options.SetEndCapType(static_cast<Options::EndCapType>(cap));
        Far::TopologyRefiner::AdaptiveOptions adaptive = options.GetRefineAdaptiveOptions();
        adaptive.considerFVarChannels = !mesh.channels.empty();
        out.refiner->RefineAdaptive(adaptive);
    }
    out.patches.reset(Far::PatchTableFactory::Create(*out.refiner, options));
    return out;
}

/// Refined points, then local points.
StencilTablePointer make_stencils(const Tables& tables, Kind kind, int channel) {
    Stencils::Options options;
    options.fvarChannel = static_cast<unsigned>(channel);
    options.interpolationMode = kind == Kind::vertex    ? Stencils::INTERPOLATE_VERTEX
                                : kind == Kind::varying ? Stencils::INTERPOLATE_VARYING
                                                        : Stencils::INTERPOLATE_FACE_VARYING;
    StencilTablePointer out(Stencils::Create(*tables.refiner, options));
    const Far::TopologyRefiner& refiner = *tables.refiner;
    const Far::StencilTable* all = nullptr;
    if (kind == Kind::vertex && tables.patches->GetLocalPointStencilTable())
        all = Stencils::AppendLocalPointStencilTable(refiner, out.get(),
                                                     tables.patches->GetLocalPointStencilTable());
    if (kind == Kind::varying && tables.patches->GetLocalPointVaryingStencilTable())
        all = Stencils::AppendLocalPointStencilTableVarying(
            refiner, out.get(), tables.patches->GetLocalPointVaryingStencilTable());
    if (kind == Kind::face_varying && tables.patches->GetLocalPointFaceVaryingStencilTable(channel))
        all = Stencils::AppendLocalPointStencilTableFaceVarying(
            refiner, out.get(), tables.patches->GetLocalPointFaceVaryingStencilTable(channel), channel);
    if (all != nullptr) out.reset(all);
    return out;
}

/// In every patch, or in so many spread over the table: its corners, a border and inside.
std::vector<Osd::PatchCoord> make_coords(const Far::PatchTable& table, bool triangles, int most_patches,
                                         std::vector<int>& depths) {
    constexpr float kPlaces[][2] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}, {0.5f, 0}, {0.3f, 0.4f}, {0.8f, 0.1f}};
    std::vector<Osd::PatchCoord> coords;
    const int total = table.GetNumPatchesTotal(), step = std::max(1, total / most_patches);
    int first = 0;
    for (int array = 0; array < table.GetNumPatchArrays(); first += table.GetNumPatches(array++)) {
        for (int p = array % step; p < table.GetNumPatches(array); p += step) {
            const Far::PatchParam param = table.GetPatchParam(array, p);
            Far::PatchTable::PatchHandle handle;
            handle.arrayIndex = array;
            handle.patchIndex = first + p;
            handle.vertIndex = 0;
            for (const auto& place : kPlaces) {
                float s = place[0], t = place[1];
                if (triangles && s + t > 1) continue;
                if (triangles)
                    param.UnnormalizeTriangle(s, t);
                else
                    param.Unnormalize(s, t);
                coords.emplace_back(handle, s, t);
                depths.push_back(param.GetDepth());
            }
        }
    }
    return coords;
}

std::vector<float> spread(const std::vector<float>& values, size_t width, const Primvar& to) {
    std::vector<float> out(values.size() / width * static_cast<size_t>(to.stride), -5.0f);
    for (size_t p = 0; p < values.size() / width; ++p)
        for (size_t i = 0; i < static_cast<size_t>(to.length); ++i)
            out[p * static_cast<size_t>(to.stride) + static_cast<size_t>(to.offset) + i] =
                values[p * width + i % width] * (1 + static_cast<float>(i / width));
    return out;
}

/// Value, du, dv, duu, duv and dvv at each coordinate by OpenSubdiv's weights in double, from the floats that evaluators
/// have: the truth for both.
std::vector<double> evaluate_in_double(const Far::PatchTable& table, const Primvar& primvar,
                                       const std::vector<float>& points, const std::vector<Osd::PatchCoord>& coords) {
    const size_t length = static_cast<size_t>(primvar.length);
    std::vector<double> values(coords.size() * 6 * length);
    for (size_t c = 0; c < coords.size(); ++c) {
        const Far::PatchTable::PatchHandle& handle = coords[c].handle;
        const double s = double{coords[c].s}, t = double{coords[c].t};
        double w[6][20] = {};
        Far::ConstIndexArray vertices;
        if (primvar.kind == Kind::vertex) {
            table.EvaluateBasis(handle, s, t, w[0], w[1], w[2], w[3], w[4], w[5]);
            int first = 0;
            for (int a = 0; a < handle.arrayIndex; ++a) first += table.GetNumPatches(a);
            vertices = table.GetPatchVertices(handle.arrayIndex, handle.patchIndex - first);
        } else if (primvar.kind == Kind::varying) {
            table.EvaluateBasisVarying(handle, s, t, w[0], w[1], w[2], w[3], w[4], w[5]);
            vertices = table.GetPatchVaryingVertices(handle);
        } else {
            table.EvaluateBasisFaceVarying(handle, s, t, w[0], w[1], w[2], w[3], w[4], w[5], primvar.channel);
            vertices = table.GetPatchFVarValues(handle, primvar.channel);
        }
        for (size_t k = 0; k < 6; ++k)
            for (int j = 0; j < vertices.size(); ++j)
                for (size_t i = 0; i < length; ++i) {
                    const auto at = static_cast<size_t>(vertices[j] * primvar.stride + primvar.offset) + i;
                    values[(6 * c + k) * length + i] += w[k][j] * double{points[at]};
                }
    }
    return values;
}

/// The largest errors against that, of values, first and second derivatives: as shares of what positions may be off, times
/// 2^depth for first derivatives and 4^depth for second ones.
struct Errors {
    double worst[3] = {0, 0, 0};
    void add(const std::vector<double>& truth, const std::vector<float>& records, size_t length,
             const std::vector<int>& depths, double tolerance) {
        for (size_t at = 0; at < truth.size(); ++at) {
            const size_t c = at / (6 * length), k = at / length % 6, order = k == 0 ? 0 : k < 3 ? 1 : 2;
            const double value = double{records[c * (6 * length + 2) + 1 + at % (6 * length)]};
            const double error =
                std::abs(value - truth[at]) / (tolerance * std::exp2(static_cast<double>(order) * depths[c]));
            if (!(error <= worst[order])) worst[order] = error;  // takes NaN, too
        }
    }
};

/// Value by value: positions within `tolerance`, derivatives within that times 2^depth, twice 4^depth for second ones, since
/// either side may be off by once that (Errors); what lies between records is the same to the bit.
testing::AssertionResult same_records(const std::vector<float>& theirs, const std::vector<float>& ours,
                                      size_t length, const std::vector<int>& depths, double tolerance) {
    const size_t record = 6 * length + 2;
    if (theirs.empty() || theirs.size() != ours.size() || theirs.size() != depths.size() * record)
        return testing::AssertionFailure() << theirs.size() << " values against " << ours.size();
    for (size_t i = 0; i < theirs.size(); ++i) {
        const size_t at = i % record, value = (at - 1) / length;
        const double depth = depths[i / record];
        double allowed = tolerance;
        if (at == 0 || at == record - 1)
            allowed = 0;
        else if (value > 0)
            allowed *= value > 2 ? 2 * std::exp2(2 * depth) : std::exp2(depth);
        const double difference = std::abs(double{theirs[i]} - double{ours[i]});
        if (!(difference <= allowed))
            return testing::AssertionFailure()
                   << "coordinate " << i / record << ", float " << at << ", depth " << depth << ": "
                   << ours[i] << " in place of " << theirs[i];
    }
    return testing::AssertionSuccess();
}

class OsdEvaluatorTest : public vk::test::VulkanTest {
  protected:
    void SetUp() override {
        VulkanTest::SetUp();
        if (!HasFatalFailure()) context_.reset(VkDeviceContext::Create(device()));
    }
    void TearDown() override {
        context_.reset();
        VulkanTest::TearDown();
    }
    void pretend_gpu(uint32_t max_range = ~0u) {
        context_.reset();
        VulkanTest::pretend_gpu(max_range);
        context_.reset(VkDeviceContext::Create(device()));
    }

    testing::AssertionResult agrees(const Tables& tables, Primvar primvar, const std::vector<float>& values,
                                    size_t width, bool triangles, int most_patches = 60) {
        const StencilTablePointer stencils = make_stencils(tables, primvar.kind, primvar.channel);
        primvar.stencils = stencils.get();
        primvar.control = spread(values, width, primvar);
        std::vector<int> depths;
        const auto coords = make_coords(*tables.patches, triangles, most_patches, depths);
        if (coords.empty()) return testing::AssertionSuccess();  // all holes
        coordinate_count_ += coords.size();
        for (int a = 0; a < tables.patches->GetNumPatchArrays(); ++a)
            types_.insert(tables.patches->GetPatchArrayDescriptor(a).GetType());
        const Results theirs = run_program<CpuTypes>(primvar, *tables.patches, coords, nullptr);
        if (!refine_on_device_) {
            primvar.control = theirs.points;
            primvar.stencils = nullptr;
        }
        const Results ours = run_program<VkTypes>(primvar, *tables.patches, coords, context_.get());
        if (!theirs.ok || !ours.ok) return testing::AssertionFailure() << context_->GetError().message;
        const double tolerance = vk::test::tolerance_of(theirs.points, static_cast<size_t>(primvar.stride));
        for (size_t i = 0; i < theirs.points.size(); ++i)
            if (!(std::abs(theirs.points[i] - ours.points[i]) <= tolerance))
                return testing::AssertionFailure() << "float " << i << " of the points: " << ours.points[i]
                                                   << " in place of " << theirs.points[i];
        const size_t length = static_cast<size_t>(primvar.length);
        if (!refine_on_device_) {
            const std::vector<double> truth = evaluate_in_double(*tables.patches, primvar, theirs.points, coords);
            errors_.add(truth, ours.records, length, depths, tolerance);
            their_errors_.add(truth, theirs.records, length, depths, tolerance);
        }
        return same_records(theirs.records, ours.records, length, depths, tolerance);
    }

    std::unique_ptr<VkDeviceContext> context_;
    bool refine_on_device_ = true;
    size_t coordinate_count_ = 0;
    Errors errors_, their_errors_;  ///< against an evaluation in double
    std::set<int> types_;
};

// Every shape is osd_patch_test.cpp's, in double; here every tenth goes through the device.
TEST_F(OsdEvaluatorTest, shapes_are_evaluated_as_by_opensubdiv) {
    refine_on_device_ = false;  // for that there are tests of stencils; here are patches
    const std::vector<TestMesh> shapes = limn::test::all_shapes();
    int n = 0;
    for (size_t i = 0; i < shapes.size(); i += 10) {
        const TestMesh& mesh = shapes[i];
        const bool triangles = mesh.options.scheme == Scheme::loop;
        const int caps[] = {kUniform, Options::ENDCAP_BSPLINE_BASIS, Options::ENDCAP_GREGORY_BASIS,
                            Options::ENDCAP_BILINEAR_BASIS};  // evaluators do not take legacy Gregory patches
        const int cap = caps[n % 4], level = 1 + n / 4 % 4;
        ++n;
        const bool uniform = cap == kUniform || mesh.options.scheme == Scheme::bilinear;
        const Tables tables = make_tables(mesh, uniform ? kUniform : cap, uniform ? 1 + level % 2 : level);
        ASSERT_NE(tables.patches, nullptr) << mesh.name;
        EXPECT_TRUE(agrees(tables, {}, mesh.positions, 3, triangles)) << mesh.name << ", cap " << cap;
        // Uniform tables have no varying patches, which OpenSubdiv's evaluators do not check for.
        const Primvar varying = {Kind::varying, 0, 3, 4, 1};
        EXPECT_TRUE(uniform || agrees(tables, varying, mesh.positions, 3, triangles, 20)) << mesh.name;
        for (int channel = 0; channel < static_cast<int>(mesh.channels.size()); ++channel)
            EXPECT_TRUE(agrees(tables, {Kind::face_varying, channel, 3, 3, 0},
                               mesh.channels[static_cast<size_t>(channel)].values, 2, triangles))
                << mesh.name << ", channel " << channel;
    }
    std::printf("%zu coordinates in %d shapes\n", coordinate_count_, n);
    std::printf("errors of values, first and second derivatives, of what is allowed: %.2g %.2g %.2g; OpenSubdiv's %.2g "
                "%.2g %.2g\n",
                errors_.worst[0], errors_.worst[1], errors_.worst[2], their_errors_.worst[0], their_errors_.worst[1],
                their_errors_.worst[2]);
    for (size_t order = 0; order < 3; ++order) {
        EXPECT_LE(errors_.worst[order], 1) << order;
        EXPECT_LE(their_errors_.worst[order], 1) << order;  // else the truth is none
        EXPECT_GT(their_errors_.worst[order], 0) << order;
    }
    for (const int type : {3, 4, 5, 6, 9, 10}) EXPECT_TRUE(types_.count(type)) << "no patch of type " << type;
}

TEST_F(OsdEvaluatorTest, primvars_have_any_length_offset_and_stride) {
    const TestMesh mesh = limn::test::make_cube();
    const Tables tables = make_tables(mesh, Options::ENDCAP_GREGORY_BASIS, 2);
    for (const int length : {1, 2, 3, 4, 5, 8, 11, 64}) {
        refine_on_device_ = length == 5;
        EXPECT_TRUE(agrees(tables, {Kind::vertex, 0, length, length + 3, 2}, mesh.positions, 3, false))
            << length;
    }
}

TEST_F(OsdEvaluatorTest, storage_buffers_give_the_same) {
    pretend_gpu();
    for (const TestMesh& mesh : {limn::test::make_cube(), limn::test::make_prism(5)}) {
        const Tables tables = make_tables(mesh, Options::ENDCAP_GREGORY_BASIS, 3);
        EXPECT_TRUE(agrees(tables, {Kind::vertex, 0, 5, 6, 1}, mesh.positions, 3, false)) << mesh.name;
    }
}

TEST_F(OsdEvaluatorTest, outputs_larger_than_a_binding_are_cut) {
    pretend_gpu(1 << 17);
    const TestMesh mesh = limn::test::make_grid(8, 8);
    const Tables tables = make_tables(mesh, Options::ENDCAP_BSPLINE_BASIS, 1);
    EXPECT_TRUE(agrees(tables, {Kind::vertex, 0, 16, 16, 0}, mesh.positions, 3, false, 10000));
    EXPECT_GT(coordinate_count_ * 98 * 4, size_t{1} << 17);
}

TEST_F(OsdEvaluatorTest, limit_stencils_have_second_derivatives) {
    for (const TestMesh& mesh : limn::test::face_varying_shapes()) {
        std::string error;
        const auto refiner = limn::test::make_osd_refiner(mesh, &error);
        const int faces = Far::PtexIndices(*refiner).GetNumFaces();
        const float s[] = {0, 0.25f, 0.3f}, t[] = {0, 0.5f, 0.6f};
        Far::LimitStencilTableFactory::LocationArrayVec locations(static_cast<size_t>(faces));
        for (int f = 0; f < faces; ++f) {
            locations[static_cast<size_t>(f)].ptexIdx = f;
            locations[static_cast<size_t>(f)].numLocations = 3;
            locations[static_cast<size_t>(f)].s = s;
            locations[static_cast<size_t>(f)].t = t;
        }
        refiner->RefineAdaptive(Far::TopologyRefiner::AdaptiveOptions(3));
        Far::LimitStencilTableFactory::Options options;
        options.generate2ndDerivatives = true;
        const std::unique_ptr<const Far::LimitStencilTable> stencils(
            Far::LimitStencilTableFactory::Create(*refiner, locations, nullptr, nullptr, options));
        ASSERT_NE(stencils, nullptr) << mesh.name;
        if (stencils->GetNumStencils() == 0) continue;
        const Results theirs = run_limits<CpuTypes>(*stencils, mesh.positions, nullptr);
        const Results ours = run_limits<VkTypes>(*stencils, mesh.positions, context_.get());
        ASSERT_TRUE(ours.ok) << context_->GetError().message;
        const std::vector<int> depths(static_cast<size_t>(stencils->GetNumStencils()), 3);
        EXPECT_TRUE(
            same_records(theirs.records, ours.records, 3, depths, vk::test::tolerance_of(mesh.positions, 3)))
            << mesh.name;
    }
}

TEST_F(OsdEvaluatorTest, comparison_notices_one_value) {
    std::vector<float> a(40, 1.0f);
    EXPECT_TRUE(same_records(a, a, 3, {0, 0}, 1e-6));
    for (size_t i = 0; i < a.size(); ++i) {
        std::vector<float> b = a;
        b[i] += 1e-3f;
        EXPECT_FALSE(same_records(a, b, 3, {0, 0}, 1e-6)) << i;
    }
    EXPECT_FALSE(same_records({}, {}, 3, {}, 1e-6));
    const std::vector<double> truth(2 * 6 * 3, 1.0);
    for (size_t i = 0; i < truth.size(); ++i) {
        std::vector<float> b = a;
        b[i / 18 * 20 + 1 + i % 18] += 1e-3f;
        Errors errors;
        errors.add(truth, b, 3, {0, 2}, 1e-6);
        const size_t order = i / 3 % 6 == 0 ? 0 : i / 3 % 6 < 3 ? 1 : 2;
        const double unit = 1e-6 * (i < 18 ? 1.0 : std::exp2(2.0 * static_cast<double>(order)));
        for (size_t k = 0; k < 3; ++k) EXPECT_NEAR(errors.worst[k], k == order ? 1e-3 / unit : 0, 0.1) << i;
    }
}

/// What has been put where the table's buffer is, or will be.
template <class T>
bool holds(const vk::Buffer& buffer, const vk::Buffer* staging, const T* expected, size_t count) {
    const void* data = buffer.mapped() != nullptr ? buffer.mapped() : staging->mapped();
    return buffer.size_bytes >= count * sizeof(T) && std::memcmp(data, expected, count * sizeof(T)) == 0;
}

TEST_F(OsdEvaluatorTest, tables_are_fars_bit_for_bit) {
    for (const bool gpu : {false, true}) {
        if (gpu) pretend_gpu();
        const Tables tables = make_tables(limn::test::make_prism(5), Options::ENDCAP_GREGORY_BASIS, 3);
        const Osd::CpuPatchTable host(tables.patches.get());
        auto commands = vk::Commands::begin(device());
        ASSERT_TRUE(commands);
        const auto upload = record_patch_table_upload(device(), *commands, *tables.patches);
        ASSERT_TRUE(upload);
        ASSERT_EQ(upload->staging.empty(), !gpu);
        const DevicePatches& vertex = upload->table.vertex;
        const vk::Buffer* staging = upload->staging.data();
        EXPECT_TRUE(holds(vertex.array_words, staging, host.GetPatchArrayBuffer(), host.GetNumPatchArrays()));
        EXPECT_TRUE(
            holds(vertex.indices, staging + gpu, host.GetPatchIndexBuffer(), host.GetPatchIndexSize()));
        EXPECT_TRUE(
            holds(vertex.params, staging + 2 * gpu, host.GetPatchParamBuffer(), host.GetPatchParamSize()));
        ASSERT_TRUE(commands->submit_and_wait());

        const StencilTablePointer far_stencils = make_stencils(tables, Kind::vertex, 0);
        const auto rows = convert_stencil_table<float>(*far_stencils);
        ASSERT_TRUE(rows);
        ASSERT_EQ(rows->row_count(), static_cast<uint32_t>(far_stencils->GetNumStencils()));
        for (uint32_t k = 0; k < rows->indices.size(); ++k) {
            EXPECT_EQ(rows->indices[k], static_cast<uint32_t>(far_stencils->GetControlIndices()[k]));
            EXPECT_EQ(rows->weights[k], far_stencils->GetWeights()[k]);
        }
    }
}

TEST_F(OsdEvaluatorTest, recording_gives_the_same_bits_as_submitting) {
    const TestMesh mesh = limn::test::make_cube();
    const Tables tables = make_tables(mesh, Options::ENDCAP_GREGORY_BASIS, 2);
    const StencilTablePointer far_stencils = make_stencils(tables, Kind::vertex, 0);
    std::vector<int> depths;
    const auto coords = make_coords(*tables.patches, false, 1000, depths);
    const Primvar primvar = {Kind::vertex, 0, 3, 3, 0, far_stencils.get(), mesh.positions};
    const Results submitted = run_program<VkTypes>(primvar, *tables.patches, coords, context_.get());
    ASSERT_TRUE(submitted.ok);

    const int count = static_cast<int>(coords.size()), control = static_cast<int>(mesh.vertex_count);
    const int total = control + far_stencils->GetNumStencils();
    auto commands = vk::Commands::begin(device());
    ASSERT_TRUE(commands);
    context_->SetCommandBuffer(*commands);
    const std::unique_ptr<VkStencilTable> stencils(
        VkStencilTable::Create(far_stencils.get(), context_.get()));
    const std::unique_ptr<VkPatchTable> patches(VkPatchTable::Create(tables.patches.get(), context_.get()));
    const std::unique_ptr<VkVertexBuffer> points(VkVertexBuffer::Create(3, total, context_.get()));
    const std::unique_ptr<VkVertexBuffer> places(VkVertexBuffer::Create(5, count, context_.get()));
    const std::unique_ptr<VkVertexBuffer> values(VkVertexBuffer::Create(3, count, context_.get()));
    ASSERT_TRUE(stencils && patches && points && places && values);
    EXPECT_TRUE(points->UpdateData(mesh.positions.data(), 0, control));
    EXPECT_TRUE(places->UpdateData(reinterpret_cast<const float*>(coords.data()), 0, count));
    const BufferDescriptor src(0, 3, 3), dst(3 * control, 3, 3);
    const std::unique_ptr<VkEvaluator> evaluator(VkEvaluator::Create(src, dst, {}, {}, context_.get()));
    ASSERT_NE(evaluator, nullptr);
    EXPECT_TRUE(
        VkEvaluator::EvalStencils(points.get(), src, points.get(), dst, stencils.get(), evaluator.get()));
    EXPECT_TRUE(
        VkEvaluator::EvalPatches(points.get(), src, values.get(), src, count, places.get(), patches.get()));
    ASSERT_TRUE(commands->submit_and_wait());
    const std::vector<float> recorded = VkTypes::read(*values);
    for (size_t c = 0; c < coords.size(); ++c)
        for (size_t i = 0; i < 3; ++i) EXPECT_EQ(recorded[3 * c + i], submitted.records[20 * c + 1 + i]);
}

TEST_F(OsdEvaluatorTest, osd_mesh_takes_these_types) {
    using Mesh = Osd::Mesh<VkVertexBuffer, VkStencilTable, VkEvaluator, VkPatchTable, VkDeviceContext>;
    const TestMesh shape = limn::test::make_prism(5);
    const int count = static_cast<int>(shape.vertex_count);
    std::string error;
    Osd::MeshBitset bits;
    bits.set(Osd::MeshAdaptive).set(Osd::MeshEndCapGregoryBasis);
    Osd::EvaluatorCacheT<VkEvaluator> cache;
    Mesh mesh(limn::test::make_osd_refiner(shape, &error).release(), 3, 0, 2, bits, &cache, context_.get());
    mesh.UpdateVertexBuffer(shape.positions.data(), 0, count);
    mesh.Refine();
    mesh.Synchronize();
    const std::vector<float> ours = VkTypes::read(*mesh.GetVertexBuffer());
    StencilTablePointer stencils(Stencils::Create(*mesh.GetTopologyRefiner()));
    stencils.reset(Stencils::AppendLocalPointStencilTable(
        *mesh.GetTopologyRefiner(), stencils.get(), mesh.GetFarPatchTable()->GetLocalPointStencilTable()));
    std::vector<float> theirs = shape.positions;
    theirs.resize(3 * static_cast<size_t>(mesh.GetNumVertices()));
    const BufferDescriptor src(0, 3, 3), dst(3 * count, 3, 3);
    ASSERT_TRUE(Osd::CpuEvaluator::EvalStencils(
        theirs.data(), src, theirs.data(), dst, stencils->GetSizes().data(), stencils->GetOffsets().data(),
        stencils->GetControlIndices().data(), stencils->GetWeights().data(), 0, stencils->GetNumStencils()));
    EXPECT_TRUE(vk::test::points_match({{theirs.begin(), theirs.end()}, 3}, {ours, 0, 3},
                                       vk::test::tolerance_of(theirs, 3)));
}

/// Memory of the device's first type, or none while `fails`.
struct FailingMemory {
    const vk::Device* device;
    bool fails = false;
    static VkResult allocate(void* user, const VkMemoryRequirements& needs, vk::MemoryUse, vk::MemoryBlock* block) {
        const FailingMemory& memory = *static_cast<const FailingMemory*>(user);
        if (memory.fails) return VK_ERROR_OUT_OF_DEVICE_MEMORY;
        VkMemoryAllocateInfo info = {};
        info.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
        info.allocationSize = needs.size;
        info.memoryTypeIndex = static_cast<uint32_t>(std::countr_zero(needs.memoryTypeBits));
        const VkResult result = memory.device->functions.AllocateMemory(memory.device->handle, &info, nullptr, &block->memory);
        if (result != VK_SUCCESS) return result;
        return memory.device->functions.MapMemory(memory.device->handle, block->memory, 0, VK_WHOLE_SIZE, 0, &block->mapped);
    }
    static void free(void* user, const vk::MemoryBlock& block) {
        const vk::Device& device = *static_cast<const FailingMemory*>(user)->device;
        device.functions.FreeMemory(device.handle, block.memory, nullptr);
    }
};

TEST_F(OsdEvaluatorTest, a_call_that_fails_leaves_the_next_one_whole) {
    FailingMemory memory{&device()};
    vk::Device failing = device();
    failing.allocator = {&memory, FailingMemory::allocate, FailingMemory::free};
    const Tables tables = make_tables(limn::test::make_cube(), Options::ENDCAP_GREGORY_BASIS, 2);
    const std::unique_ptr<VkDeviceContext> context(VkDeviceContext::Create(failing));
    for (const bool fails : {true, true, false}) {
        memory.fails = fails;
        const std::unique_ptr<VkPatchTable> table(VkPatchTable::Create(tables.patches.get(), context.get()));
        EXPECT_EQ(table == nullptr, fails);
        if (fails) {
            EXPECT_EQ(context->GetError().code, ErrorCode::out_of_memory);
        }
    }
}

TEST_F(OsdEvaluatorTest, mistakes_are_refused_with_a_reason) {
    const Tables tables = make_tables(limn::test::make_cube(), Options::ENDCAP_GREGORY_BASIS, 1);
    const StencilTablePointer far_stencils = make_stencils(tables, Kind::vertex, 0);
    const std::unique_ptr<VkStencilTable> stencils(
        VkStencilTable::Create(far_stencils.get(), context_.get()));
    const std::unique_ptr<VkPatchTable> patches(VkPatchTable::Create(tables.patches.get(), context_.get()));
    const std::unique_ptr<VkVertexBuffer> points(VkVertexBuffer::Create(3, 1000, context_.get()));
    const auto fails = [&](bool ok) { return !ok && !context_->GetError().message.empty(); };
    const BufferDescriptor three(0, 3, 3), two(0, 2, 3), narrow(0, 3, 2);
    VkVertexBuffer *p = points.get(), *none = nullptr;
    EXPECT_TRUE(fails(VkEvaluator::EvalStencils(p, three, p, two, stencils.get())));
    EXPECT_TRUE(fails(VkEvaluator::EvalStencils(p, narrow, p, narrow, stencils.get())));
    EXPECT_TRUE(fails(VkEvaluator::EvalStencils(p, three, p, three, p, three, none, {}, stencils.get())));
    EXPECT_TRUE(fails(VkEvaluator::EvalPatchesFaceVarying(p, three, p, three, 1, p, patches.get(), 0)));
    EXPECT_TRUE(fails(VkEvaluator::EvalPatches(p, three, p, three, 1, none, patches.get())));
    EXPECT_TRUE(fails(points->UpdateData(nullptr, 990, 11)));
    EXPECT_EQ(VkVertexBuffer::Create(0, 1, context_.get()), nullptr);
    EXPECT_EQ(VkEvaluator::Create(three, two, {}, {}, context_.get()), nullptr);
}

}  // namespace
}  // namespace limn::osd::test
