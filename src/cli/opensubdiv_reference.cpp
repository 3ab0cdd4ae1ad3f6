#include "cli/opensubdiv_reference.h"

#include <opensubdiv/bfr/refinerSurfaceFactory.h>
#include <opensubdiv/bfr/surface.h>
#include <opensubdiv/far/error.h>
#include <opensubdiv/far/patchMap.h>
#include <opensubdiv/far/patchTableFactory.h>
#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/stencilTable.h>
#include <opensubdiv/far/topologyDescriptor.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace limn::cli {
namespace {

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

template <size_t N>
struct Point {
    std::array<double, N> x{};
    void Clear() { x = {}; }
    void AddWithWeight(const Point& other, double weight) {
        for (size_t i = 0; i < N; ++i) x[i] += weight * other.x[i];
    }
};

template <size_t N>
std::vector<Point<N>> points_from(std::span<const float> values) {
    std::vector<Point<N>> points(values.size() / N);
    for (size_t i = 0; i < values.size(); ++i) points[i / N].x[i % N] = static_cast<double>(values[i]);
    return points;
}

template <size_t N>
std::vector<double> flatten(const std::vector<Point<N>>& points) {
    std::vector<double> values;
    values.reserve(points.size() * N);
    for (const Point<N>& point : points) values.insert(values.end(), point.x.begin(), point.x.end());
    return values;
}

Sdc::Options::VtxBoundaryInterpolation boundary_of(BoundaryInterpolation boundary) {
    switch (boundary) {
        case BoundaryInterpolation::none:
            return Sdc::Options::VTX_BOUNDARY_NONE;
        case BoundaryInterpolation::edge_only:
            return Sdc::Options::VTX_BOUNDARY_EDGE_ONLY;
        default:
            return Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER;
    }
}

Sdc::Options::FVarLinearInterpolation face_varying_of(FaceVaryingInterpolation interpolation) {
    switch (interpolation) {
        case FaceVaryingInterpolation::none:
            return Sdc::Options::FVAR_LINEAR_NONE;
        case FaceVaryingInterpolation::corners_only:
            return Sdc::Options::FVAR_LINEAR_CORNERS_ONLY;
        case FaceVaryingInterpolation::corners_plus1:
            return Sdc::Options::FVAR_LINEAR_CORNERS_PLUS1;
        case FaceVaryingInterpolation::corners_plus2:
            return Sdc::Options::FVAR_LINEAR_CORNERS_PLUS2;
        case FaceVaryingInterpolation::boundaries:
            return Sdc::Options::FVAR_LINEAR_BOUNDARIES;
        default:
            return Sdc::Options::FVAR_LINEAR_ALL;
    }
}

OpenSubdiv::Sdc::SchemeType scheme_of(Scheme scheme) {
    switch (scheme) {
        case Scheme::loop:
            return Sdc::SCHEME_LOOP;
        case Scheme::bilinear:
            return Sdc::SCHEME_BILINEAR;
        default:
            return Sdc::SCHEME_CATMARK;
    }
}

/// OpenSubdiv warns through a global callback; what it refuses shows in what it returns.
void ignore_message(Far::ErrorType, const char*) {}

std::vector<int> to_int(const std::vector<uint32_t>& values) {
    return {values.begin(), values.end()};
}

/// The control mesh before any refinement.
Result<std::unique_ptr<Far::TopologyRefiner>> make_refiner(const ControlMesh& mesh) {
    Far::SetErrorCallback(ignore_message);
    Far::SetWarningCallback([](const char*) {});
    std::vector<int> face_sizes;
    for (uint32_t f = 0; f < mesh.face_count(); ++f)
        face_sizes.push_back(static_cast<int>(mesh.face_offsets[f + 1] - mesh.face_offsets[f]));
    const std::vector<int> vertices = to_int(mesh.face_vertices), creases = to_int(mesh.crease_edges),
                           corners = to_int(mesh.corner_vertices), holes = to_int(mesh.holes);
    Far::TopologyDescriptor descriptor;
    descriptor.numVertices = static_cast<int>(mesh.vertex_count);
    descriptor.numFaces = static_cast<int>(mesh.face_count());
    descriptor.numVertsPerFace = face_sizes.data();
    descriptor.vertIndicesPerFace = vertices.data();
    descriptor.numCreases = static_cast<int>(mesh.crease_sharpness.size());
    descriptor.creaseVertexIndexPairs = creases.data();
    descriptor.creaseWeights = mesh.crease_sharpness.data();
    descriptor.numCorners = static_cast<int>(corners.size());
    descriptor.cornerVertexIndices = corners.data();
    descriptor.cornerWeights = mesh.corner_sharpness.data();
    descriptor.numHoles = static_cast<int>(holes.size());
    descriptor.holeIndices = holes.data();
    Far::TopologyDescriptor::FVarChannel channel;
    std::vector<int> values;
    Sdc::Options options;
    if (!mesh.channels.empty()) {
        values = to_int(mesh.channels[0].face_values);
        channel.numValues = static_cast<int>(mesh.channels[0].value_count);
        channel.valueIndices = values.data();
        descriptor.numFVarChannels = 1;
        descriptor.fvarChannels = &channel;
        options.SetFVarLinearInterpolation(face_varying_of(mesh.channels[0].interpolation));
    }
    options.SetVtxBoundaryInterpolation(boundary_of(mesh.options.boundary));
    options.SetCreasingMethod(mesh.options.creasing == CreasingMethod::chaikin
                                  ? Sdc::Options::CREASE_CHAIKIN
                                  : Sdc::Options::CREASE_UNIFORM);
    options.SetTriangleSubdivision(mesh.options.triangles == TriangleSubdivision::smooth
                                       ? Sdc::Options::TRI_SUB_SMOOTH
                                       : Sdc::Options::TRI_SUB_CATMARK);
    using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
    std::unique_ptr<Far::TopologyRefiner> refiner(
        Factory::Create(descriptor, Factory::Options(scheme_of(mesh.options.scheme), options)));
    if (!refiner) return Error{ErrorCode::unsupported, "OpenSubdiv refuses this mesh"};
    return refiner;
}

}  // namespace

struct OpenSubdivReference::Data {
    std::unique_ptr<Far::TopologyRefiner> refiner;

    const Far::TopologyLevel& last() const { return refiner->GetLevel(refiner->GetMaxLevel()); }

    template <size_t N, class Step>
    std::vector<Point<N>> run(std::vector<Point<N>> points, const Step& step) const {
        for (int level = 1; level <= refiner->GetMaxLevel(); ++level) points = step(level, points);
        return points;
    }

    std::vector<Point<2>> refine_channel(std::span<const float> values) const {
        const Far::PrimvarRefinerReal<double> primvar(*refiner);
        return run(points_from<2>(values), [&](int level, std::vector<Point<2>>& from) {
            std::vector<Point<2>> to(static_cast<size_t>(refiner->GetLevel(level).GetNumFVarValues(0)));
            primvar.InterpolateFaceVarying(level, from, to, 0);
            return to;
        });
    }

    /// Values of the first channel at the face corners of the last level.
    std::vector<double> at_corners(const std::vector<Point<2>>& values) const {
        std::vector<double> corners;
        for (int f = 0; f < last().GetNumFaces(); ++f)
            for (const int value : last().GetFaceFVarValues(f, 0))
                for (const double x : values[static_cast<size_t>(value)].x) corners.push_back(x);
        return corners;
    }
};

OpenSubdivReference::OpenSubdivReference(std::unique_ptr<Data> data) : data_(std::move(data)) {}
OpenSubdivReference::OpenSubdivReference(OpenSubdivReference&&) noexcept = default;
OpenSubdivReference& OpenSubdivReference::operator=(OpenSubdivReference&&) noexcept = default;
OpenSubdivReference::~OpenSubdivReference() = default;

Result<OpenSubdivReference> OpenSubdivReference::create(const ControlMesh& mesh, uint32_t level) {
    auto refiner = make_refiner(mesh);
    if (!refiner) return refiner.error();
    auto data = std::make_unique<Data>();
    data->refiner = std::move(refiner).value();
    Far::TopologyRefiner::UniformOptions refine(static_cast<int>(level));
    refine.fullTopologyInLastLevel = true;
    data->refiner->RefineUniform(refine);
    return OpenSubdivReference(std::move(data));
}

std::vector<uint32_t> OpenSubdivReference::face_vertices() const {
    const Far::TopologyLevel& last = data_->last();
    std::vector<uint32_t> vertices;
    for (int f = 0; f < last.GetNumFaces(); ++f)
        for (const int v : last.GetFaceVertices(f)) vertices.push_back(static_cast<uint32_t>(v));
    return vertices;
}

std::vector<double> OpenSubdivReference::refine(std::span<const float> control_points) const {
    const Far::PrimvarRefinerReal<double> refiner(*data_->refiner);
    return flatten(data_->run(points_from<3>(control_points), [&](int level, std::vector<Point<3>>& from) {
        std::vector<Point<3>> to(static_cast<size_t>(data_->refiner->GetLevel(level).GetNumVertices()));
        refiner.Interpolate(level, from, to);
        return to;
    }));
}

ReferenceLimits OpenSubdivReference::limits(std::span<const float> control_points) const {
    const Far::PrimvarRefinerReal<double> refiner(*data_->refiner);
    const auto refined =
        data_->run(points_from<3>(control_points), [&](int level, std::vector<Point<3>>& from) {
            std::vector<Point<3>> to(static_cast<size_t>(data_->refiner->GetLevel(level).GetNumVertices()));
            refiner.Interpolate(level, from, to);
            return to;
        });
    std::vector<Point<3>> positions(refined.size()), tangents1(refined.size()), tangents2(refined.size());
    refiner.Limit(refined, positions, tangents1, tangents2);
    return {flatten(positions), flatten(tangents1), flatten(tangents2)};
}

std::vector<double> OpenSubdivReference::refine_face_varying(std::span<const float> values) const {
    return data_->at_corners(data_->refine_channel(values));
}

std::vector<double> OpenSubdivReference::face_varying_limits(std::span<const float> values) const {
    const std::vector<Point<2>> refined = data_->refine_channel(values);
    // OpenSubdiv smooths the limits of bilinear channels along seams, though not the channels themselves.
    if (data_->refiner->GetSchemeType() == Sdc::SCHEME_BILINEAR) return data_->at_corners(refined);
    std::vector<Point<2>> limits(refined.size());
    Far::PrimvarRefinerReal<double>(*data_->refiner).LimitFaceVarying(refined, limits, 0);
    return data_->at_corners(limits);
}

std::vector<uint8_t> OpenSubdivReference::vertices_with_true_limits() const {
    const Far::TopologyLevel& last = data_->last();
    const bool linear = data_->refiner->GetSchemeType() == Sdc::SCHEME_BILINEAR;
    auto fades = [](float sharpness) { return Sdc::Crease::IsSemiSharp(sharpness); };
    std::vector<uint8_t> result(static_cast<size_t>(last.GetNumVertices()), 1);
    for (int v = 0; v < last.GetNumVertices() && !linear; ++v) {
        const Sdc::Crease::Rule rule = last.GetVertexRule(v);
        const bool two_faces = last.GetVertexFaces(v).size() == 2 && !last.IsVertexBoundary(v);
        bool other = rule == Sdc::Crease::RULE_DART || (rule == Sdc::Crease::RULE_SMOOTH && two_faces) ||
                     fades(last.GetVertexSharpness(v));
        for (const int edge : last.GetVertexEdges(v)) other = other || fades(last.GetEdgeSharpness(edge));
        if (other) result[static_cast<size_t>(v)] = 0;
    }
    return result;
}

bool OpenSubdivReference::bfr_is_safe() const {
    const Far::TopologyLevel& base = data_->refiner->GetLevel(0);
    for (int v = 0; v < base.GetNumVertices(); ++v) {
        if (base.IsVertexNonManifold(v)) return false;
        if (base.GetVertexFaces(v).size() == 2 && !base.IsVertexBoundary(v)) return false;
    }
    return true;
}

namespace {

/// OpenSubdiv's parameters span half of a ptex face where it is a part of another polygon.
void halve_parameters(ReferencePlace& place) {
    for (size_t k = 1; k < 6; ++k)
        for (double& x : place.values[k]) x *= k < 3 ? 0.5 : 0.25;
}

}  // namespace

struct OpenSubdivSurface::Data {
    std::unique_ptr<Far::TopologyRefiner> base, refiner;  ///< as it came, and refined adaptively
    std::unique_ptr<Far::PatchTable> patches;
    std::unique_ptr<Far::PatchMap> map;
    bool triangles = false;
    std::vector<std::pair<int, int>> ptex_faces;  ///< face and sub-face of each

    std::vector<Point<3>> patch_points(std::span<const float> control_points) const {
        const Far::PrimvarRefinerReal<double> primvar(*refiner);
        std::vector<Point<3>> points = points_from<3>(control_points);
        const auto total = static_cast<size_t>(refiner->GetNumVerticesTotal());
        points.resize(total + static_cast<size_t>(patches->GetNumLocalPoints()));
        Point<3>* source = points.data();
        for (int level = 1; level <= refiner->GetMaxLevel(); ++level) {
            Point<3>* target = source + refiner->GetLevel(level - 1).GetNumVertices();
            primvar.Interpolate(level, source, target);
            source = target;
        }
        if (const auto* local = patches->GetLocalPointStencilTable<double>())
            local->UpdateValues(points.data(), points.data() + total);
        return points;
    }

    void evaluate(const Far::PatchTable::PatchHandle& handle, double u, double v,
                  std::span<const Point<3>> points, ReferencePlace& place) const {
        double weights[6][20];
        patches->EvaluateBasis(handle, u, v, weights[0], weights[1], weights[2], weights[3], weights[4],
                               weights[5]);
        const Far::ConstIndexArray indices = patches->GetPatchVertices(handle);
        for (size_t k = 0; k < 6; ++k) {
            place.values[k] = {};
            for (int i = 0; i < indices.size(); ++i)
                for (size_t axis = 0; axis < 3; ++axis)
                    place.values[k][axis] += weights[k][i] * points[static_cast<size_t>(indices[i])].x[axis];
        }
    }

    /// Largest side or diagonal of an end cap.
    double cap_size(const Far::PatchTable::PatchHandle& handle, std::span<const Point<3>> points) const {
        const Far::PatchParam param = patches->GetPatchParam(handle);
        constexpr double kCorners[4][2] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}};
        ReferencePlace corners[4];
        double size = 0;
        for (size_t k = 0; k < (triangles ? 3u : 4u); ++k) {
            double u = kCorners[k][0], v = kCorners[k][1];
            if (triangles)
                param.UnnormalizeTriangle(u, v);
            else
                param.Unnormalize(u, v);
            evaluate(handle, u, v, points, corners[k]);
            for (size_t j = 0; j < k; ++j) {
                const auto &a = corners[j].values[0], &b = corners[k].values[0];
                size = std::max(size, std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]));
            }
        }
        return size;
    }
};

OpenSubdivSurface::OpenSubdivSurface(std::unique_ptr<Data> data) : data_(std::move(data)) {}
OpenSubdivSurface::OpenSubdivSurface(OpenSubdivSurface&&) noexcept = default;
OpenSubdivSurface& OpenSubdivSurface::operator=(OpenSubdivSurface&&) noexcept = default;
OpenSubdivSurface::~OpenSubdivSurface() = default;

Result<OpenSubdivSurface> OpenSubdivSurface::create(const ControlMesh& mesh, uint32_t level,
                                                    std::span<const uint32_t> faces) {
    auto base = make_refiner(mesh), refiner = make_refiner(mesh);
    if (!base) return base.error();
    if (!refiner) return refiner.error();
    auto data = std::make_unique<Data>();
    data->base = std::move(base).value();
    data->refiner = std::move(refiner).value();
    data->triangles = mesh.options.scheme == Scheme::loop;
    std::vector<int> selected(faces.begin(), faces.end());
    const Far::ConstIndexArray selection(selected.data(), static_cast<int>(selected.size()));
    Far::PatchTableFactory::Options options(level);
    options.useInfSharpPatch = true;
    options.generateLegacySharpCornerPatches = false;  // smooth corners stay smooth
    options.SetEndCapType(Far::PatchTableFactory::Options::ENDCAP_GREGORY_BASIS);
    options.SetPatchPrecision<double>();
    data->refiner->RefineAdaptive(options.GetRefineAdaptiveOptions(), selection);
    data->patches.reset(Far::PatchTableFactory::Create(*data->refiner, options, selection));
    if (!data->patches) return Error{ErrorCode::unsupported, "OpenSubdiv makes no patches of this mesh"};
    data->map = std::make_unique<Far::PatchMap>(*data->patches);
    const Far::TopologyLevel& level0 = data->base->GetLevel(0);
    for (int f = 0; f < level0.GetNumFaces(); ++f) {
        const int size = level0.GetFaceVertices(f).size(), own_size = data->triangles ? 3 : 4;
        for (int i = 0; i < (size == own_size ? 1 : size); ++i) data->ptex_faces.push_back({f, i});
    }
    return OpenSubdivSurface(std::move(data));
}

std::vector<ReferencePlace> OpenSubdivSurface::far_places(std::span<const float> control_points,
                                                          std::span<const PatchSample> samples) const {
    const std::vector<Point<3>> points = data_->patch_points(control_points);
    std::vector<ReferencePlace> places(samples.size());
    for (size_t s = 0; s < samples.size(); ++s) {
        const auto& [face, u, v] = samples[s];
        const auto* handle = data_->map->FindPatch(static_cast<int>(face), u, v);
        if (handle == nullptr) continue;
        ReferencePlace& place = places[s];
        const Far::PatchDescriptor::Type type = data_->patches->GetPatchDescriptor(*handle).GetType();
        const Far::PatchParam param = data_->patches->GetPatchParam(*handle);
        data_->evaluate(*handle, u, v, points, place);
        place.valid = true;
        place.regular =
            type != Far::PatchDescriptor::GREGORY_BASIS && type != Far::PatchDescriptor::GREGORY_TRIANGLE;
        place.depth = param.GetDepth() - (param.NonQuadRoot() ? 1u : 0u);
        if (param.NonQuadRoot()) halve_parameters(place);
        // OpenSubdiv negates second derivatives in triangles that are turned by 180 degrees.
        if (data_->triangles && param.IsTriangleRotated())
            for (size_t k = 3; k < 6; ++k)
                for (double& x : place.values[k]) x = -x;
        if (!place.regular) place.cap_size = data_->cap_size(*handle, points);
    }
    return places;
}

std::vector<ReferencePlace> OpenSubdivSurface::bfr_places(std::span<const float> control_points,
                                                          uint32_t level,
                                                          std::span<const PatchSample> samples) const {
    OpenSubdiv::Bfr::SurfaceFactory::Options options;
    options.SetApproxLevelSmooth(static_cast<int>(level)).SetApproxLevelSharp(static_cast<int>(level));
    const OpenSubdiv::Bfr::RefinerSurfaceFactory<> factory(*data_->base, options);
    OpenSubdiv::Bfr::Surface<double> surface;
    const std::vector<double> control(control_points.begin(), control_points.end());
    std::vector<double> points;
    int prepared = -1;
    std::vector<ReferencePlace> places(samples.size());
    for (size_t s = 0; s < samples.size(); ++s) {
        const auto [face, sub_face] = data_->ptex_faces[samples[s].face];
        if (face != std::exchange(prepared, face) && factory.InitVertexSurface(face, &surface)) {
            points.resize(3 * static_cast<size_t>(surface.GetNumPatchPoints()));
            surface.PreparePatchPoints(control.data(), 3, points.data(), 3);
        }
        if (!surface.IsValid()) continue;
        ReferencePlace& place = places[s];
        place.valid = true;
        const double within[2] = {samples[s].u, samples[s].v};
        double uv[2] = {within[0], within[1]};
        const OpenSubdiv::Bfr::Parameterization parameterization = surface.GetParameterization();
        if (parameterization.HasSubFaces())
            parameterization.ConvertNormalizedSubFaceToCoord(sub_face, within, uv);
        surface.Evaluate(uv, points.data(), 3, place.values[0].data(), place.values[1].data(),
                         place.values[2].data());
        if (parameterization.HasSubFaces()) halve_parameters(place);
    }
    return places;
}

}  // namespace limn::cli
