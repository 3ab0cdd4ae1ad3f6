#include "cli/opensubdiv_reference.h"

#include <opensubdiv/far/error.h>
#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>

#include <array>

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

}  // namespace

struct OpenSubdivReference::Data {
    std::unique_ptr<Far::TopologyRefiner> refiner;

    const Far::TopologyLevel& last() const { return refiner->GetLevel(refiner->GetMaxLevel()); }

    template <size_t N, class Step>
    std::vector<Point<N>> run(std::vector<Point<N>> points, const Step& step) const {
        for (int level = 1; level <= refiner->GetMaxLevel(); ++level) points = step(level, points);
        return points;
    }
};

OpenSubdivReference::OpenSubdivReference(std::unique_ptr<Data> data) : data_(std::move(data)) {}
OpenSubdivReference::OpenSubdivReference(OpenSubdivReference&&) noexcept = default;
OpenSubdivReference& OpenSubdivReference::operator=(OpenSubdivReference&&) noexcept = default;
OpenSubdivReference::~OpenSubdivReference() = default;

Result<OpenSubdivReference> OpenSubdivReference::create(const ControlMesh& mesh, uint32_t level) {
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
    auto data = std::make_unique<Data>();
    data->refiner.reset(
        Factory::Create(descriptor, Factory::Options(scheme_of(mesh.options.scheme), options)));
    if (!data->refiner) return Error{ErrorCode::unsupported, "OpenSubdiv refuses this mesh"};
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
    const Far::PrimvarRefinerReal<double> refiner(*data_->refiner);
    const auto refined = data_->run(points_from<2>(values), [&](int level, std::vector<Point<2>>& from) {
        std::vector<Point<2>> to(static_cast<size_t>(data_->refiner->GetLevel(level).GetNumFVarValues(0)));
        refiner.InterpolateFaceVarying(level, from, to, 0);
        return to;
    });
    const Far::TopologyLevel& last = data_->last();
    std::vector<double> corners;
    for (int f = 0; f < last.GetNumFaces(); ++f)
        for (const int value : last.GetFaceFVarValues(f, 0))
            for (const double x : refined[static_cast<size_t>(value)].x) corners.push_back(x);
    return corners;
}

}  // namespace limn::cli
