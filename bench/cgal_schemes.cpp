// CGAL's Subdivision_method_3, over its Surface_mesh.
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/subdivision_method_3.h>

#include <chrono>

#include "scheme_peers.h"

namespace limn::peers {
namespace {

using Mesh = CGAL::Surface_mesh<CGAL::Simple_cartesian<double>::Point_3>;

Mesh read(const PolygonMesh& mesh) {
    Mesh out;
    std::vector<Mesh::Vertex_index> vertices, face;
    for (size_t v = 0; v < mesh.points.size(); v += 3)
        vertices.push_back(out.add_vertex({mesh.points[v], mesh.points[v + 1], mesh.points[v + 2]}));
    size_t corner = 0;
    for (const uint32_t size : mesh.face_sizes) {
        face.clear();
        for (uint32_t i = 0; i < size; ++i) face.push_back(vertices[mesh.face_vertices[corner++]]);
        if (out.add_face(face) == Mesh::null_face()) return {};
    }
    return out;
}

PolygonMesh write(const Mesh& mesh) {
    PolygonMesh out;
    std::vector<uint32_t> number(mesh.num_vertices());
    for (const auto v : mesh.vertices()) {
        const auto& p = mesh.point(v);
        number[v] = static_cast<uint32_t>(out.points.size() / 3);
        out.points.insert(out.points.end(), {p.x(), p.y(), p.z()});
    }
    for (const auto f : mesh.faces()) {
        const size_t first = out.face_vertices.size();
        for (const auto v : mesh.vertices_around_face(mesh.halfedge(f)))
            out.face_vertices.push_back(number[v]);
        out.face_sizes.push_back(static_cast<uint32_t>(out.face_vertices.size() - first));
    }
    return out;
}

template <class Refine>
PolygonMesh refine(const PolygonMesh& mesh, uint32_t level, double* milliseconds, const Refine& step) {
    Mesh own = read(mesh);
    if (own.num_faces() == 0) return {};
    const auto start = std::chrono::steady_clock::now();
    step(own, CGAL::parameters::number_of_iterations(level));
    const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - start;
    if (milliseconds != nullptr) *milliseconds = time.count();
    return write(own);
}

#define LIMN_CGAL(function, method)                                                       \
    PolygonMesh function(const PolygonMesh& mesh, uint32_t level, double* milliseconds) { \
        return refine(mesh, level, milliseconds, [](Mesh& own, const auto& parameters) {  \
            CGAL::Subdivision_method_3::method(own, parameters);                          \
        });                                                                               \
    }
LIMN_CGAL(catmull_clark, CatmullClark_subdivision)
LIMN_CGAL(loop, Loop_subdivision)
LIMN_CGAL(doo_sabin, DooSabin_subdivision)
LIMN_CGAL(sqrt3, Sqrt3_subdivision)
#undef LIMN_CGAL

}  // namespace

Library cgal_schemes() {
    static constexpr PeerScheme schemes[] = {
        {"catmark", "CatmullClark_subdivision", Boundaries::same, catmull_clark},
        {"loop", "Loop_subdivision", Boundaries::same, loop},
        {"doo-sabin", "DooSabin_subdivision", Boundaries::none, doo_sabin},
        {"sqrt3", "Sqrt3_subdivision", Boundaries::same, sqrt3},
    };
    return {"cgal", schemes};
}

}  // namespace limn::peers
