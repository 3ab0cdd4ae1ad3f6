// A control mesh and its topology, and what it takes to change both. Not part of the public interface.
#pragma once

#include <vector>

#include "limn/mesh_edit.h"

namespace limn {

struct EditedTopology {
    ControlMesh mesh;
    Topology base;
    Array<uint8_t> non_manifold_edges;       ///< as build_connectivity makes them
    std::vector<uint32_t> crease_of_edge;    ///< the mesh's last crease along each edge, or kInvalidIndex
    std::vector<uint32_t> corner_of_vertex;  ///< likewise
    std::vector<uint8_t> is_hole;            ///< of the mesh's holes
};
/// Not to be used where `part` is cancelled.
EditedTopology make_edited_topology(ControlMesh mesh, const BuildPart& part = {});

/// Where a topology has changed.
struct TouchedPlaces {
    std::vector<uint32_t> vertices;  ///< around which there are other faces, or another sharpness
    std::vector<uint32_t> faces;     ///< that became holes or stopped being such
    bool tessellation = false;       ///< what is infinitely sharp, or a hole, has changed
};

/// Whether sharpness and holes of an edit, whose faces are changed already, are such. Errors: as
/// EditableMesh::edit.
Result<void> check_sharpness(const EditedTopology& topology, const MeshEdit& edit);
/// Makes changes of sharpness and holes that have been checked, and adds to `touched` what they touch.
void change_sharpness(const MeshEdit& edit, EditedTopology& topology, TouchedPlaces& touched);

/// What change_sharpness changes of a mesh, to be taken back.
struct SharpnessLists {
    std::vector<uint32_t> crease_edges, corner_vertices, holes;
    std::vector<float> crease_sharpness, corner_sharpness;

    explicit SharpnessLists(const ControlMesh& mesh);
};
/// Takes back a change_sharpness that began with these lists.
void restore_sharpness(SharpnessLists&& lists, TouchedPlaces& touched, EditedTopology& topology);

/// A mesh with other faces.
struct FaceChange {
    EditedTopology to;
    std::vector<uint32_t> faces;   ///< what each face has become, kInvalidIndex where it is gone
    std::vector<uint8_t> changed;  ///< per face before: it is gone, or has other vertices
    TouchedPlaces touched;
};
/// Errors: as EditableMesh::edit.
Result<FaceChange> change_faces(const EditedTopology& from, const MeshEdit& edit);

}  // namespace limn
