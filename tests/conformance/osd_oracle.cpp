#include "conformance/osd_oracle.h"

#include <opensubdiv/far/error.h>
#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/stencilTableFactory.h>
#include <opensubdiv/far/topologyRefinerFactory.h>

#include <algorithm>
#include <array>

#include "conformance/osd_refiner.h"

namespace osd = OpenSubdiv;

namespace {

// What OpenSubdiv said since the last look. Its callbacks are global, and so is this.
std::string& messages() {
    static std::string text;
    return text;
}

void keep_error(osd::Far::ErrorType, const char* message) {
    messages() += std::string(message) + "; ";
}
void keep_warning(const char* message) {
    messages() += std::string(message) + "; ";
}

osd::Sdc::SchemeType scheme_of(limn::Scheme scheme) {
    switch (scheme) {
        case limn::Scheme::catmull_clark:
            return osd::Sdc::SCHEME_CATMARK;
        case limn::Scheme::loop:
            return osd::Sdc::SCHEME_LOOP;
        case limn::Scheme::bilinear:
            return osd::Sdc::SCHEME_BILINEAR;
    }
    return osd::Sdc::SCHEME_CATMARK;
}

osd::Sdc::Options options_of(const limn::SchemeOptions& options) {
    using Osd = osd::Sdc::Options;
    Osd result;
    switch (options.boundary) {
        case limn::BoundaryInterpolation::none:
            result.SetVtxBoundaryInterpolation(Osd::VTX_BOUNDARY_NONE);
            break;
        case limn::BoundaryInterpolation::edge_only:
            result.SetVtxBoundaryInterpolation(Osd::VTX_BOUNDARY_EDGE_ONLY);
            break;
        case limn::BoundaryInterpolation::edge_and_corner:
            result.SetVtxBoundaryInterpolation(Osd::VTX_BOUNDARY_EDGE_AND_CORNER);
            break;
    }
    result.SetCreasingMethod(options.creasing == limn::CreasingMethod::uniform ? Osd::CREASE_UNIFORM
                                                                               : Osd::CREASE_CHAIKIN);
    result.SetTriangleSubdivision(
        options.triangles == limn::TriangleSubdivision::catmark ? Osd::TRI_SUB_CATMARK : Osd::TRI_SUB_SMOOTH);
    return result;
}

osd::Sdc::Options::FVarLinearInterpolation interpolation_of(limn::FaceVaryingInterpolation interpolation) {
    using Osd = osd::Sdc::Options;
    switch (interpolation) {
        case limn::FaceVaryingInterpolation::none:
            return Osd::FVAR_LINEAR_NONE;
        case limn::FaceVaryingInterpolation::corners_only:
            return Osd::FVAR_LINEAR_CORNERS_ONLY;
        case limn::FaceVaryingInterpolation::corners_plus1:
            return Osd::FVAR_LINEAR_CORNERS_PLUS1;
        case limn::FaceVaryingInterpolation::corners_plus2:
            return Osd::FVAR_LINEAR_CORNERS_PLUS2;
        case limn::FaceVaryingInterpolation::boundaries:
            return Osd::FVAR_LINEAR_BOUNDARIES;
        case limn::FaceVaryingInterpolation::all:
            return Osd::FVAR_LINEAR_ALL;
    }
    return Osd::FVAR_LINEAR_ALL;
}

template <class Indices>
void copy_face(const Indices& from, osd::Far::IndexArray to, size_t begin, bool reversed) {
    const int size = to.size();
    for (int c = 0; c < size; ++c) {
        const int source = reversed ? (size - c) % size : c;
        to[c] = static_cast<osd::Far::Index>(from[begin + static_cast<size_t>(source)]);
    }
}

}  // namespace

// A factory of our own, because TopologyDescriptor has no options for single channels.
namespace OpenSubdiv {
namespace OPENSUBDIV_VERSION {
namespace Far {

using limn::test::TestMesh;

template <>
bool TopologyRefinerFactory<TestMesh>::resizeComponentTopology(TopologyRefiner& refiner,
                                                               const TestMesh& mesh) {
    setNumBaseVertices(refiner, static_cast<int>(mesh.vertex_count));
    setNumBaseFaces(refiner, static_cast<int>(mesh.face_count()));
    for (size_t f = 0; f < mesh.face_sizes.size(); ++f) {
        setNumBaseFaceVertices(refiner, static_cast<Index>(f), static_cast<int>(mesh.face_sizes[f]));
    }
    return true;
}

template <>
bool TopologyRefinerFactory<TestMesh>::assignComponentTopology(TopologyRefiner& refiner,
                                                               const TestMesh& mesh) {
    size_t begin = 0;
    for (size_t f = 0; f < mesh.face_sizes.size(); ++f) {
        copy_face(mesh.face_vertices, getBaseFaceVertices(refiner, static_cast<Index>(f)), begin,
                  mesh.left_handed);
        begin += mesh.face_sizes[f];
    }
    return true;
}

template <>
bool TopologyRefinerFactory<TestMesh>::assignComponentTags(TopologyRefiner& refiner, const TestMesh& mesh) {
    for (size_t i = 0; i < mesh.crease_sharpness.size(); ++i) {
        const auto a = static_cast<Index>(mesh.creases[2 * i]),
                   b = static_cast<Index>(mesh.creases[2 * i + 1]);
        const Index edge = findBaseEdge(refiner, a, b);
        if (edge == INDEX_INVALID) {
            Warning("crease %d (%d, %d) follows no edge", static_cast<int>(i), a, b);
        } else {
            setBaseEdgeSharpness(refiner, edge, std::min(mesh.crease_sharpness[i], 10.0f));
        }
    }
    for (size_t i = 0; i < mesh.corners.size(); ++i) {
        setBaseVertexSharpness(refiner, static_cast<Index>(mesh.corners[i]),
                               std::min(mesh.corner_sharpness[i], 10.0f));
    }
    for (uint32_t face : mesh.holes) setBaseFaceHole(refiner, static_cast<Index>(face), true);
    return true;
}

template <>
bool TopologyRefinerFactory<TestMesh>::assignFaceVaryingTopology(TopologyRefiner& refiner,
                                                                 const TestMesh& mesh) {
    for (const limn::test::TestChannel& channel : mesh.channels) {
        Sdc::Options options = options_of(mesh.options);
        options.SetFVarLinearInterpolation(interpolation_of(channel.interpolation));
        const int index = createBaseFVarChannel(refiner, static_cast<int>(channel.value_count), options);
        size_t begin = 0;
        for (size_t f = 0; f < mesh.face_sizes.size(); ++f) {
            copy_face(channel.face_values, getBaseFaceFVarValues(refiner, static_cast<Index>(f), index),
                      begin, mesh.left_handed);
            begin += mesh.face_sizes[f];
        }
    }
    return true;
}

template <>
void TopologyRefinerFactory<TestMesh>::reportInvalidTopology(TopologyError, const char* message,
                                                             const TestMesh&) {
    Warning("%s", message);
}

}  // namespace Far
}  // namespace OPENSUBDIV_VERSION
}  // namespace OpenSubdiv

namespace limn::test {
namespace {

using Refiner = osd::Far::TopologyRefiner;
using Level = osd::Far::TopologyLevel;

// The element type that OpenSubdiv's templates want.
template <size_t width>
struct Element {
    std::array<double, width> values{};
    void Clear() { values.fill(0); }
    void AddWithWeight(const Element& source, double weight) {
        for (size_t i = 0; i < width; ++i) values[i] += weight * source.values[i];
    }
};

template <size_t width>
std::vector<Element<width>> to_elements(std::span<const double> values) {
    std::vector<Element<width>> result(values.size() / width);
    for (size_t i = 0; i < result.size() * width; ++i) result[i / width].values[i % width] = values[i];
    return result;
}

template <size_t width>
std::vector<double> to_doubles(const std::vector<Element<width>>& elements) {
    std::vector<double> result(elements.size() * width);
    for (size_t i = 0; i < result.size(); ++i) result[i] = elements[i / width].values[i % width];
    return result;
}

template <size_t width>
OsdOracle::Levels refine_elements(const Refiner& refiner, std::span<const double> values, bool varying) {
    const osd::Far::PrimvarRefinerReal<double> primvar(refiner);
    OsdOracle::Levels result;
    result.emplace_back(values.begin(), values.end());
    std::vector<Element<width>> source = to_elements<width>(values);
    for (int level = 1; level <= refiner.GetMaxLevel(); ++level) {
        std::vector<Element<width>> target(static_cast<size_t>(refiner.GetLevel(level).GetNumVertices()));
        if (varying) {
            primvar.InterpolateVarying(level, source, target);
        } else {
            primvar.Interpolate(level, source, target);
        }
        result.push_back(to_doubles(target));
        source = std::move(target);
    }
    return result;
}

std::vector<double> corner_values(const Level& level, int channel, const std::vector<Element<2>>& values) {
    std::vector<double> result;
    result.reserve(static_cast<size_t>(level.GetNumFaceVertices()) * 2);
    for (int f = 0; f < level.GetNumFaces(); ++f) {
        const osd::Far::ConstIndexArray face_values = level.GetFaceFVarValues(f, channel);
        for (int c = 0; c < face_values.size(); ++c) {
            const Element<2>& element = values[static_cast<size_t>(face_values[c])];
            result.insert(result.end(), element.values.begin(), element.values.end());
        }
    }
    return result;
}

std::vector<SparseRow> rows_of(const osd::Far::StencilTableReal<double>& table) {
    std::vector<SparseRow> rows(static_cast<size_t>(table.GetNumStencils()));
    size_t entry = 0;
    for (size_t r = 0; r < rows.size(); ++r) {
        const auto size = static_cast<size_t>(table.GetSizes()[r]);
        SparseRow& row = rows[r];
        for (size_t k = 0; k < size; ++k, ++entry) {
            row.push_back(
                {static_cast<uint32_t>(table.GetControlIndices()[entry]), table.GetWeights()[entry]});
        }
        std::sort(row.begin(), row.end());
        size_t kept = 0;
        for (size_t k = 0; k < row.size(); ++k) {
            if (kept > 0 && row[kept - 1].first == row[k].first) {
                row[kept - 1].second += row[k].second;
            } else {
                row[kept++] = row[k];
            }
        }
        row.resize(kept);
        std::erase_if(row, [](const auto& term) { return term.second == 0; });
    }
    return rows;
}

std::vector<SparseRow> make_stencils(const Refiner& refiner, bool all_levels, bool varying) {
    using Factory = osd::Far::StencilTableFactoryReal<double>;
    Factory::Options options;
    options.interpolationMode = varying ? Factory::INTERPOLATE_VARYING : Factory::INTERPOLATE_VERTEX;
    options.generateIntermediateLevels = all_levels;
    options.factorizeIntermediateLevels = true;
    const std::unique_ptr<const osd::Far::StencilTableReal<double>> table(Factory::Create(refiner, options));
    return rows_of(*table);
}

}  // namespace

struct OsdOracle::Data {
    std::unique_ptr<Refiner> refiner;
};

OsdOracle::OsdOracle(std::unique_ptr<Data> data) : data_(std::move(data)) {}
OsdOracle::~OsdOracle() = default;

std::unique_ptr<Refiner> make_osd_refiner(const TestMesh& mesh, std::string* error) {
    using Factory = osd::Far::TopologyRefinerFactory<TestMesh>;
    osd::Far::SetErrorCallback(keep_error);
    osd::Far::SetWarningCallback(keep_warning);
    messages().clear();
    std::unique_ptr<Refiner> refiner(
        Factory::Create(mesh, Factory::Options(scheme_of(mesh.options.scheme), options_of(mesh.options))));
    if (error) *error = messages();
    if (!messages().empty()) refiner.reset();
    return refiner;
}

std::unique_ptr<OsdOracle> OsdOracle::create(const TestMesh& mesh, uint32_t level, std::string* error) {
    auto data = std::make_unique<Data>();
    data->refiner = make_osd_refiner(mesh, error);
    if (!data->refiner) return nullptr;
    Refiner::UniformOptions uniform(static_cast<int>(level));
    uniform.fullTopologyInLastLevel = true;
    data->refiner->RefineUniform(uniform);
    if (error) *error = messages();
    if (!messages().empty()) return nullptr;
    return std::unique_ptr<OsdOracle>(new OsdOracle(std::move(data)));
}

uint64_t OsdOracle::estimate_vertex_count(const TestMesh& mesh, uint32_t level) {
    // Faces grow by four a level after the first step; each quad or triangle then owns about one vertex (or
    // half).
    uint64_t faces = mesh.options.scheme == Scheme::loop ? mesh.face_sizes.size() : mesh.face_vertices.size();
    if (level == 0) return mesh.vertex_count;
    const uint32_t steps = mesh.options.scheme == Scheme::loop ? level : level - 1;
    faces <<= 2 * steps;
    return mesh.vertex_count + (mesh.options.scheme == Scheme::loop ? faces * 3 / 4 : faces);
}

uint32_t OsdOracle::level_count() const {
    return static_cast<uint32_t>(data_->refiner->GetNumLevels());
}

uint32_t OsdOracle::vertex_count(uint32_t level) const {
    return static_cast<uint32_t>(data_->refiner->GetLevel(static_cast<int>(level)).GetNumVertices());
}

uint32_t OsdOracle::edge_count(uint32_t level) const {
    return static_cast<uint32_t>(data_->refiner->GetLevel(static_cast<int>(level)).GetNumEdges());
}

uint32_t OsdOracle::face_count(uint32_t level) const {
    return static_cast<uint32_t>(data_->refiner->GetLevel(static_cast<int>(level)).GetNumFaces());
}

std::vector<uint32_t> OsdOracle::face_sizes(uint32_t level) const {
    const Level& topology = data_->refiner->GetLevel(static_cast<int>(level));
    std::vector<uint32_t> result;
    for (int f = 0; f < topology.GetNumFaces(); ++f) {
        result.push_back(static_cast<uint32_t>(topology.GetFaceVertices(f).size()));
    }
    return result;
}

std::vector<uint32_t> OsdOracle::face_vertices(uint32_t level) const {
    const Level& topology = data_->refiner->GetLevel(static_cast<int>(level));
    std::vector<uint32_t> result;
    for (int f = 0; f < topology.GetNumFaces(); ++f) {
        const osd::Far::ConstIndexArray vertices = topology.GetFaceVertices(f);
        for (int c = 0; c < vertices.size(); ++c) result.push_back(static_cast<uint32_t>(vertices[c]));
    }
    return result;
}

std::vector<uint8_t> OsdOracle::face_holes(uint32_t level) const {
    const Level& topology = data_->refiner->GetLevel(static_cast<int>(level));
    std::vector<uint8_t> result;
    for (int f = 0; f < topology.GetNumFaces(); ++f) result.push_back(topology.IsFaceHole(f) ? 1 : 0);
    return result;
}

std::vector<uint32_t> OsdOracle::base_faces(uint32_t level) const {
    struct Index {
        uint32_t value = 0;
    };
    std::vector<Index> source(face_count(0));
    for (uint32_t f = 0; f < source.size(); ++f) source[f].value = f;
    const osd::Far::PrimvarRefinerReal<double> primvar(*data_->refiner);
    for (uint32_t l = 1; l <= level; ++l) {
        std::vector<Index> target(face_count(l));
        primvar.InterpolateFaceUniform(static_cast<int>(l), source, target);
        source = std::move(target);
    }
    std::vector<uint32_t> result;
    for (const Index& index : source) result.push_back(index.value);
    return result;
}

std::vector<uint32_t> OsdOracle::edge_vertices(uint32_t level) const {
    const Level& topology = data_->refiner->GetLevel(static_cast<int>(level));
    std::vector<uint32_t> result;
    for (int e = 0; e < topology.GetNumEdges(); ++e) {
        for (int i = 0; i < 2; ++i) result.push_back(static_cast<uint32_t>(topology.GetEdgeVertices(e)[i]));
    }
    return result;
}

std::vector<float> OsdOracle::edge_sharpness(uint32_t level) const {
    const Level& topology = data_->refiner->GetLevel(static_cast<int>(level));
    std::vector<float> result;
    for (int e = 0; e < topology.GetNumEdges(); ++e) result.push_back(topology.GetEdgeSharpness(e));
    return result;
}

std::vector<float> OsdOracle::vertex_sharpness(uint32_t level) const {
    const Level& topology = data_->refiner->GetLevel(static_cast<int>(level));
    std::vector<float> result;
    for (int v = 0; v < topology.GetNumVertices(); ++v) result.push_back(topology.GetVertexSharpness(v));
    return result;
}

std::vector<VertexRule> OsdOracle::vertex_rules(uint32_t level) const {
    const Level& topology = data_->refiner->GetLevel(static_cast<int>(level));
    std::vector<VertexRule> result;
    for (int v = 0; v < topology.GetNumVertices(); ++v) {
        switch (topology.GetVertexRule(v)) {
            case osd::Sdc::Crease::RULE_DART:
                result.push_back(VertexRule::dart);
                break;
            case osd::Sdc::Crease::RULE_CREASE:
                result.push_back(VertexRule::crease);
                break;
            case osd::Sdc::Crease::RULE_CORNER:
                result.push_back(VertexRule::corner);
                break;
            default:
                result.push_back(VertexRule::smooth);
                break;
        }
    }
    return result;
}

std::vector<uint8_t> OsdOracle::vertex_manifold(uint32_t level) const {
    const Level& topology = data_->refiner->GetLevel(static_cast<int>(level));
    std::vector<uint8_t> result;
    for (int v = 0; v < topology.GetNumVertices(); ++v)
        result.push_back(topology.IsVertexNonManifold(v) ? 0 : 1);
    return result;
}

std::vector<uint32_t> OsdOracle::vertex_face_counts(uint32_t level) const {
    const Level& topology = data_->refiner->GetLevel(static_cast<int>(level));
    std::vector<uint32_t> result;
    for (int v = 0; v < topology.GetNumVertices(); ++v) {
        result.push_back(static_cast<uint32_t>(topology.GetVertexFaces(v).size()));
    }
    return result;
}

std::vector<uint8_t> OsdOracle::vertex_boundaries(uint32_t level) const {
    const Level& topology = data_->refiner->GetLevel(static_cast<int>(level));
    std::vector<uint8_t> result;
    for (int v = 0; v < topology.GetNumVertices(); ++v)
        result.push_back(topology.IsVertexBoundary(v) ? 1 : 0);
    return result;
}

OsdOracle::Levels OsdOracle::refine(std::span<const double> control_values, uint32_t width) const {
    return width == 1 ? refine_elements<1>(*data_->refiner, control_values, false)
                      : refine_elements<3>(*data_->refiner, control_values, false);
}

OsdOracle::Levels OsdOracle::refine_varying(std::span<const double> control_values, uint32_t width) const {
    return width == 1 ? refine_elements<1>(*data_->refiner, control_values, true)
                      : refine_elements<3>(*data_->refiner, control_values, true);
}

OsdOracle::Levels OsdOracle::refine_face_varying(uint32_t channel, std::span<const double> values) const {
    const Refiner& refiner = *data_->refiner;
    const osd::Far::PrimvarRefinerReal<double> primvar(refiner);
    const int index = static_cast<int>(channel);
    std::vector<Element<2>> source = to_elements<2>(values);
    Levels result;
    result.push_back(corner_values(refiner.GetLevel(0), index, source));
    for (int level = 1; level <= refiner.GetMaxLevel(); ++level) {
        std::vector<Element<2>> target(static_cast<size_t>(refiner.GetLevel(level).GetNumFVarValues(index)));
        primvar.InterpolateFaceVarying(level, source, target, index);
        result.push_back(corner_values(refiner.GetLevel(level), index, target));
        source = std::move(target);
    }
    return result;
}

OsdOracle::Limits OsdOracle::limits(std::span<const double> control_points) const {
    const Levels levels = refine(control_points, 3);
    const std::vector<Element<3>> source = to_elements<3>(levels.back());
    std::vector<Element<3>> positions(source.size());
    const osd::Far::PrimvarRefinerReal<double> primvar(*data_->refiner);
    primvar.Limit(source, positions);
    const uint32_t last = level_count() - 1;
    const std::vector<uint8_t> manifold = vertex_manifold(last);
    const std::vector<VertexRule> rules = vertex_rules(last);
    for (size_t v = 0; v < manifold.size(); ++v) {
        // OpenSubdiv 3.5 writes past its weights here.
        if (!manifold[v] && rules[v] == VertexRule::crease) return {to_doubles(positions), {}, {}};
    }
    std::vector<Element<3>> tangents1(source.size()), tangents2(source.size());
    primvar.Limit(source, positions, tangents1, tangents2);
    return {to_doubles(positions), to_doubles(tangents1), to_doubles(tangents2)};
}

std::vector<double> OsdOracle::face_varying_limits(uint32_t channel, std::span<const double> values) const {
    const Refiner& refiner = *data_->refiner;
    const osd::Far::PrimvarRefinerReal<double> primvar(refiner);
    const int index = static_cast<int>(channel);
    std::vector<Element<2>> source = to_elements<2>(values);
    for (int level = 1; level <= refiner.GetMaxLevel(); ++level) {
        std::vector<Element<2>> target(static_cast<size_t>(refiner.GetLevel(level).GetNumFVarValues(index)));
        primvar.InterpolateFaceVarying(level, source, target, index);
        source = std::move(target);
    }
    std::vector<Element<2>> limits(source.size());
    primvar.LimitFaceVarying(source, limits, index);
    return corner_values(refiner.GetLevel(refiner.GetMaxLevel()), index, limits);
}

std::vector<SparseRow> OsdOracle::stencils(bool varying) const {
    if (level_count() > 1) return make_stencils(*data_->refiner, false, varying);
    std::vector<SparseRow> rows(vertex_count(0));
    for (uint32_t v = 0; v < rows.size(); ++v) rows[v] = {{v, 1.0}};
    return rows;
}

std::vector<SparseRow> OsdOracle::stencils_of_all_levels() const {
    return level_count() > 1 ? make_stencils(*data_->refiner, true, false) : std::vector<SparseRow>();
}

}  // namespace limn::test
