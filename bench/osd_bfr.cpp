#include "osd_bfr.h"

#include <opensubdiv/bfr/refinerSurfaceFactory.h>
#include <opensubdiv/bfr/surface.h>
#include <opensubdiv/bfr/tessellation.h>

#include <cmath>

#include "limn/parallel.h"

namespace limn::bench {
namespace {

namespace bfr = OpenSubdiv::Bfr;

void write_normal(const float* u, const float* v, float* normal) {
    const float n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    const float length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int k = 0; k < 3; ++k) normal[k] = length > 0 ? n[k] / length : 0;
}

}  // namespace

struct BfrTessellation::Faces {
    struct Face {
        bfr::Surface<float> surface;
        std::unique_ptr<bfr::Tessellation> pattern;
        std::vector<float> coordinates;  ///< u v each
        size_t first_vertex = 0, first_triangle = 0;
    };
    OsdRefiner refiner;  ///< which surfaces refer to
    std::unique_ptr<bfr::RefinerSurfaceFactory<>> factory;
    std::vector<Face> faces;
};

BfrTessellation::BfrTessellation() = default;
BfrTessellation::~BfrTessellation() = default;

std::unique_ptr<BfrTessellation> BfrTessellation::create(const OsdMesh& mesh, uint32_t rate) {
    std::unique_ptr<BfrTessellation> out(new BfrTessellation);
    out->faces_ = std::make_unique<Faces>();
    Faces& all = *out->faces_;
    all.refiner = mesh.create();
    if (all.refiner == nullptr) return nullptr;
    all.factory = std::make_unique<bfr::RefinerSurfaceFactory<>>(*all.refiner, bfr::SurfaceFactory::Options());
    all.faces.resize(static_cast<size_t>(all.refiner->GetLevel(0).GetNumFaces()));
    size_t vertices = 0, triangles = 0;
    for (size_t f = 0; f < all.faces.size(); ++f) {
        Faces::Face& face = all.faces[f];
        if (!all.factory->InitVertexSurface(static_cast<int>(f), &face.surface)) continue;
        face.pattern = std::make_unique<bfr::Tessellation>(face.surface.GetParameterization(), static_cast<int>(rate));
        face.coordinates.resize(static_cast<size_t>(face.pattern->GetNumCoords()) * 2);
        face.pattern->GetCoords(face.coordinates.data());
        face.first_vertex = vertices;
        face.first_triangle = triangles;
        vertices += static_cast<size_t>(face.pattern->GetNumCoords());
        triangles += static_cast<size_t>(face.pattern->GetNumFacets());
    }
    out->vertices.resize(6 * vertices);
    out->indices.resize(3 * triangles);
    return out;
}

void BfrTessellation::run(const std::vector<float>& positions) {
    for_each_index(
        static_cast<uint32_t>(faces_->faces.size()),
        [&](uint32_t f) {
            Faces::Face& face = faces_->faces[f];
            if (face.pattern == nullptr) return;
            std::vector<float> points(static_cast<size_t>(face.surface.GetNumPatchPoints()) * 3);
            face.surface.PreparePatchPoints(positions.data(), 3, points.data(), 3);
            float* vertex = vertices.data() + 6 * face.first_vertex;
            for (size_t i = 0; i < face.coordinates.size(); i += 2, vertex += 6) {
                float u[3], v[3];
                face.surface.Evaluate(face.coordinates.data() + i, points.data(), 3, vertex, u, v);
                write_normal(u, v, vertex + 3);
            }
            int* triangle = indices.data() + 3 * face.first_triangle;
            face.pattern->GetFacets(triangle);
            face.pattern->TransformFacetCoordIndices(triangle, static_cast<int>(face.first_vertex));
        },
        16);
}

}  // namespace limn::bench
