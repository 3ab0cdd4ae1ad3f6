// OpenMesh's uniform subdividers, over its array kernel.
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/CatmullClarkT.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/Composite/CompositeTraits.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/CompositeLoopT.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/CompositeSqrt3T.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/LoopT.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/MidpointT.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/ModifiedButterFlyT.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/Sqrt3InterpolatingSubdividerLabsikGreinerT.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/Sqrt3T.hh>
#include <chrono>

#include "scheme_peers.h"

namespace limn::peers {
namespace {

struct Traits : OpenMesh::DefaultTraits {
    using Point = OpenMesh::Vec3d;
    using Normal = OpenMesh::Vec3d;  // LoopT adds points up as normals
};
struct CompositeTraits : OpenMesh::Subdivider::Uniform::CompositeTraits {
    using Point = OpenMesh::Vec3d;
};
using Triangles = OpenMesh::TriMesh_ArrayKernelT<Traits>;
using Polygons = OpenMesh::PolyMesh_ArrayKernelT<Traits>;
using CompositeTriangles = OpenMesh::TriMesh_ArrayKernelT<CompositeTraits>;

template <class Mesh>
Mesh read(const PolygonMesh& mesh) {
    Mesh out;
    std::vector<OpenMesh::VertexHandle> vertices, face;
    for (size_t v = 0; v < mesh.points.size(); v += 3)
        vertices.push_back(out.add_vertex({mesh.points[v], mesh.points[v + 1], mesh.points[v + 2]}));
    size_t corner = 0;
    for (const uint32_t size : mesh.face_sizes) {
        face.clear();
        for (uint32_t i = 0; i < size; ++i) face.push_back(vertices[mesh.face_vertices[corner++]]);
        if (!out.add_face(face).is_valid()) return {};
    }
    return out;
}

template <class Mesh>
PolygonMesh write(const Mesh& mesh) {
    PolygonMesh out;
    for (const auto v : mesh.vertices())
        for (size_t k = 0; k < 3; ++k) out.points.push_back(mesh.point(v)[k]);
    for (const auto f : mesh.faces()) {
        const size_t first = out.face_vertices.size();
        for (const auto v : mesh.fv_range(f)) out.face_vertices.push_back(static_cast<uint32_t>(v.idx()));
        out.face_sizes.push_back(static_cast<uint32_t>(out.face_vertices.size() - first));
    }
    return out;
}

template <class Subdivider, class Mesh>
PolygonMesh refine(const PolygonMesh& mesh, uint32_t level, double* milliseconds) {
    Mesh own = read<Mesh>(mesh);
    if (own.n_faces() == 0) return {};
    Subdivider subdivider;
    const auto start = std::chrono::steady_clock::now();
    subdivider.attach(own);
    subdivider(level);
    subdivider.detach();
    const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - start;
    if (milliseconds != nullptr) *milliseconds = time.count();
    return write(own);
}

namespace uniform = OpenMesh::Subdivider::Uniform;

}  // namespace

Library openmesh_schemes() {
    static constexpr PeerScheme schemes[] = {
        {"catmark", "CatmullClarkT", Boundaries::other,
         refine<uniform::CatmullClarkT<Polygons, double>, Polygons>},
        {"loop", "LoopT", Boundaries::same, refine<uniform::LoopT<Triangles, double>, Triangles>},
        {"loop", "CompositeLoopT", Boundaries::crashing,
         refine<uniform::CompositeLoopT<CompositeTriangles, double>, CompositeTriangles>},
        {"sqrt3", "Sqrt3T", Boundaries::same, refine<uniform::Sqrt3T<Triangles, double>, Triangles>},
        {"sqrt3", "CompositeSqrt3T", Boundaries::crashing,
         refine<uniform::CompositeSqrt3T<CompositeTriangles, double>, CompositeTriangles>},
        {"butterfly", "ModifiedButterflyT", Boundaries::same,
         refine<uniform::ModifiedButterflyT<Triangles, double>, Triangles>},
        {"sqrt3-interpolatory", "InterpolatingSqrt3LGT", Boundaries::other,
         refine<uniform::InterpolatingSqrt3LGT<Triangles, double>, Triangles>},
        {"mid-edge", "MidpointT", Boundaries::same, refine<uniform::MidpointT<Polygons, double>, Polygons>},
    };
    return {"openmesh", schemes};
}

}  // namespace limn::peers
