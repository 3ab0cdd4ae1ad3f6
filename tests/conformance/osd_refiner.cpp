#include "conformance/osd_refiner.h"

#include <opensubdiv/far/error.h>
#include <opensubdiv/far/topologyRefinerFactory.h>

#include <algorithm>

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
        case limn::Scheme::doo_sabin:
            break;  // which OpenSubdiv does not have
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

std::unique_ptr<osd::Far::TopologyRefiner> make_osd_refiner(const TestMesh& mesh, std::string* error) {
    using Factory = osd::Far::TopologyRefinerFactory<TestMesh>;
    osd::Far::SetErrorCallback(keep_error);
    osd::Far::SetWarningCallback(keep_warning);
    messages().clear();
    std::unique_ptr<osd::Far::TopologyRefiner> refiner(
        Factory::Create(mesh, Factory::Options(scheme_of(mesh.options.scheme), options_of(mesh.options))));
    if (!osd_is_content(error)) return nullptr;
    return refiner;
}

bool osd_is_content(std::string* error) {
    if (error) *error = messages();
    return messages().empty();
}

}  // namespace limn::test
