#include "osd.h"

#include <opensubdiv/far/error.h>
#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/stencilTableFactory.h>

#include <array>

namespace limn::bench {
namespace {

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

struct Point {
    std::array<double, 3> x{};
    void Clear() { x = {}; }
    void AddWithWeight(const Point& other, double weight) {
        for (size_t i = 0; i < 3; ++i) x[i] += weight * other.x[i];
    }
};

std::vector<int> to_int(const std::vector<uint32_t>& values) {
    return {values.begin(), values.end()};
}

Sdc::SchemeType scheme_of(Scheme scheme) {
    switch (scheme) {
        case Scheme::loop:
            return Sdc::SCHEME_LOOP;
        case Scheme::bilinear:
            return Sdc::SCHEME_BILINEAR;
        default:
            return Sdc::SCHEME_CATMARK;
    }
}

Sdc::Options options_of(const SchemeOptions& from) {
    Sdc::Options options;
    switch (from.boundary) {
        case BoundaryInterpolation::none:
            options.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_NONE);
            break;
        case BoundaryInterpolation::edge_only:
            options.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_EDGE_ONLY);
            break;
        case BoundaryInterpolation::edge_and_corner:
            options.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER);
            break;
    }
    options.SetCreasingMethod(from.creasing == CreasingMethod::chaikin ? Sdc::Options::CREASE_CHAIKIN
                                                                       : Sdc::Options::CREASE_UNIFORM);
    options.SetTriangleSubdivision(from.triangles == TriangleSubdivision::smooth
                                       ? Sdc::Options::TRI_SUB_SMOOTH
                                       : Sdc::Options::TRI_SUB_CATMARK);
    return options;
}

}  // namespace

OsdMesh::OsdMesh(const ControlMesh& mesh)
    : face_vertices_(to_int(mesh.face_vertices)),
      creases_(to_int(mesh.crease_edges)),
      corners_(to_int(mesh.corner_vertices)),
      holes_(to_int(mesh.holes)),
      crease_sharpness_(mesh.crease_sharpness),
      corner_sharpness_(mesh.corner_sharpness),
      scheme_(scheme_of(mesh.options.scheme)),
      options_(options_of(mesh.options)) {
    Far::SetErrorCallback([](Far::ErrorType, const char*) {});
    Far::SetWarningCallback([](const char*) {});
    for (uint32_t f = 0; f < mesh.face_count(); ++f)
        face_sizes_.push_back(static_cast<int>(mesh.face_offsets[f + 1] - mesh.face_offsets[f]));
    descriptor_.numVertices = static_cast<int>(mesh.vertex_count);
    descriptor_.numFaces = static_cast<int>(mesh.face_count());
    descriptor_.numVertsPerFace = face_sizes_.data();
    descriptor_.vertIndicesPerFace = face_vertices_.data();
    descriptor_.numCreases = static_cast<int>(crease_sharpness_.size());
    descriptor_.creaseVertexIndexPairs = creases_.data();
    descriptor_.creaseWeights = crease_sharpness_.data();
    descriptor_.numCorners = static_cast<int>(corners_.size());
    descriptor_.cornerVertexIndices = corners_.data();
    descriptor_.cornerWeights = corner_sharpness_.data();
    descriptor_.numHoles = static_cast<int>(holes_.size());
    descriptor_.holeIndices = holes_.data();
}

OsdRefiner OsdMesh::create() const {
    using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
    return OsdRefiner(Factory::Create(descriptor_, Factory::Options(scheme_, options_)));
}

OsdRefiner OsdMesh::refine(uint32_t level) const {
    OsdRefiner refiner = create();
    if (refiner) refiner->RefineUniform(Far::TopologyRefiner::UniformOptions(static_cast<int>(level)));
    return refiner;
}

std::vector<double> osd_points(const Far::TopologyRefiner& refiner, const std::vector<float>& positions) {
    std::vector<Point> points(positions.size() / 3);
    for (size_t i = 0; i < positions.size(); ++i) points[i / 3].x[i % 3] = static_cast<double>(positions[i]);
    const Far::PrimvarRefinerReal<double> primvars(refiner);
    for (int level = 1; level <= refiner.GetMaxLevel(); ++level) {
        std::vector<Point> next(static_cast<size_t>(refiner.GetLevel(level).GetNumVertices()));
        primvars.Interpolate(level, points, next);
        points = std::move(next);
    }
    std::vector<double> values;
    values.reserve(3 * points.size());
    for (const Point& point : points) values.insert(values.end(), point.x.begin(), point.x.end());
    return values;
}

OsdTable build_osd_table(const Far::TopologyRefiner& refiner, OsdTableKind kind) {
    Far::StencilTableFactory::Options options;
    options.generateOffsets = true;
    options.generateIntermediateLevels = kind != OsdTableKind::last_level;
    options.factorizeIntermediateLevels = kind != OsdTableKind::all_levels_chained;
    OsdTable result{
        kind,
        std::unique_ptr<const Far::StencilTable>(Far::StencilTableFactory::Create(refiner, options)),
        static_cast<uint32_t>(refiner.GetLevel(0).GetNumVertices()),
        {}};
    if (kind == OsdTableKind::all_levels_chained) {
        uint32_t begin = 0, source = 0;
        for (int level = 1; level <= refiner.GetMaxLevel(); ++level) {
            const uint32_t end = begin + static_cast<uint32_t>(refiner.GetLevel(level).GetNumVertices());
            result.passes.push_back({begin, end, source});
            source = result.control_count + begin;
            begin = end;
        }
    } else {
        result.passes.push_back({0, static_cast<uint32_t>(result.row_count()), 0});
    }
    return result;
}

uint64_t OsdTable::moved_points() const {
    uint64_t points = control_count + row_count();  // control points read, rows written
    if (kind == OsdTableKind::all_levels_chained) points += last_level_begin();  // rows read by the next pass
    return points;
}

}  // namespace limn::bench
