// A mesh whose topology changes while its surface is drawn: creases, corners, holes and faces, edited in
// place. Its tables are, to the bit, those that builders make of the mesh as it is now; but a change walks
// around those faces again that it touches, and around few others.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "limn/patch_table.h"
#include "limn/tessellation_table.h"
#include "limn/topology.h"

namespace limn {

/// Changes that are made at once: first of faces, then of sharpness, then of holes, so that the latter two
/// refer to faces as they are numbered afterwards. The spans are read during EditableMesh::edit only.
struct MeshEdit {
    /// Faces that change, each at most once. A face of the mesh gets other vertices or, where its size is 0,
    /// is removed: those behind it move up, in their order. face_count() and what follows, in ascending
    /// order, are new faces.
    std::span<const uint32_t> faces;
    std::span<const uint32_t> face_sizes;     ///< one per face: 0, or >= 3 (Loop: exactly 3)
    std::span<const uint32_t> face_vertices;  ///< sum(face_sizes), counter-clockwise
    uint32_t new_vertex_count = 0;  ///< behind the others. Vertices never go; faces need not use them
    std::span<const uint32_t> crease_vertices;  ///< pairs, each along an edge
    std::span<const float>
        crease_sharpness;  ///< one per pair, >= 0; 0 smoothes the edge. The last one for an edge holds
    std::span<const uint32_t> corner_vertices;
    std::span<const float> corner_sharpness;  ///< one per corner vertex, likewise
    std::span<const uint32_t> holes;          ///< faces that become holes
    std::span<const uint32_t> filled_holes;   ///< faces that are none any more
};

struct EditableMeshOptions {
    PatchTableOptions patches;
    bool split_creases = true;       ///< as TessellationTableOptions
    std::vector<uint32_t> channels;  ///< likewise
};

/// What an edit has made again.
struct EditWork {
    /// Faces that were walked around again: of 128 that follow each other, all or none. All of them are where
    /// a mesh of quads alone gets its first other face, or loses its last.
    uint32_t face_count = 0;
    bool tessellation = false;  ///< else the tessellation table is what it was
};

/// A mesh and its tables. One thread at a time; tables may be read by any while none edits. They change in
/// place: what is drawn meanwhile needs uploads, or copies, of its own. Beside its tables a mesh takes
/// some 1.6 times their memory; while faces change, that once more.
///
/// Tables are those of vertex (or varying) data. Those of face-varying channels are not made here, but by
/// build_face_varying_patch_table of mesh(); and a mesh that has channels keeps its faces.
class EditableMesh {
  public:
    /// Builds all tables. `cache` may be null, else it outlives this. Errors: as build_patch_table and
    /// build_tessellation_table; unsupported (Doo-Sabin).
    static Result<EditableMesh> create(ControlMesh mesh, const EditableMeshOptions& options,
                                       const PlanCache* cache = nullptr);

    /// Makes the changes. Errors, which leave everything as it was: index_out_of_range, missing_edge,
    /// invalid_sharpness, face_too_small, not_a_triangle (the element is the one of the edit's faces,
    /// creases, corners or holes); invalid_argument (lengths that disagree, a face twice, no faces left);
    /// unsupported (faces of a mesh that has channels, and as build_patch_table); too_large.
    Result<EditWork> edit(const MeshEdit& edit);

    /// As ControlMesh::create makes it of everything that has been asked for. An edge keeps its entry among
    /// the creases, and a vertex among the corners, whatever its sharpness becomes; new ones come last.
    /// Creases of edges that no face has any more are gone.
    const ControlMesh& mesh() const;
    const Topology& topology() const;  ///< build_topology(mesh())
    const PatchTable& patches() const;
    const TessellationTable& tessellation() const;

    EditableMesh(EditableMesh&&) noexcept;
    EditableMesh& operator=(EditableMesh&&) noexcept;
    ~EditableMesh();

    struct State;

  private:
    explicit EditableMesh(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace limn
