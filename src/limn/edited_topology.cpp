#include "limn/edited_topology.h"

#include <algorithm>
#include <numeric>
#include <string>

#include "limn/topology_build.h"

namespace limn {
namespace {

constexpr uint64_t kMaxCount = 0x7fffffff;

std::string text(uint64_t n) {
    return std::to_string(n);
}

/// What the mesh gives an edge, and a vertex.
float sharpness_of_edge(const EditedTopology& t, uint32_t e) {
    const uint32_t crease = t.crease_of_edge[e];
    return crease == kInvalidIndex ? 0 : clamp_sharpness(t.mesh.crease_sharpness[crease]);
}
float sharpness_of_vertex(const EditedTopology& t, uint32_t v) {
    const uint32_t corner = t.corner_of_vertex[v];
    return corner == kInvalidIndex ? 0 : clamp_sharpness(t.mesh.corner_sharpness[corner]);
}

/// The lookups of a mesh, whose edges are known. Creases of edges that are not there go.
void index_mesh(EditedTopology& t) {
    ControlMesh& mesh = t.mesh;
    t.crease_of_edge.assign(t.base.edge_count, kInvalidIndex);
    uint32_t kept = 0;
    for (uint32_t i = 0; i < mesh.crease_sharpness.size(); ++i) {
        const uint32_t a = mesh.crease_edges[2 * i], b = mesh.crease_edges[2 * i + 1],
                       e = find_edge(t.base, a, b);
        if (e == kInvalidIndex) continue;
        mesh.crease_edges[2 * kept] = a;
        mesh.crease_edges[2 * kept + 1] = b;
        mesh.crease_sharpness[kept] = mesh.crease_sharpness[i];
        t.crease_of_edge[e] = kept++;
    }
    mesh.crease_edges.resize(size_t{2} * kept);
    mesh.crease_sharpness.resize(kept);
    t.corner_of_vertex.assign(mesh.vertex_count, kInvalidIndex);
    for (uint32_t i = 0; i < mesh.corner_vertices.size(); ++i)
        t.corner_of_vertex[mesh.corner_vertices[i]] = i;
    t.is_hole.assign(mesh.face_count(), 0);
    for (const uint32_t f : mesh.holes) t.is_hole[f] = 1;
}

void sort_unique(std::vector<uint32_t>& list) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
}

/// assign_sharpness around some places. True where what is infinitely sharp, or a hole, has changed.
class Sharpening {
  public:
    explicit Sharpening(EditedTopology& t) : t_(t), base_(t.base) {}

    bool around(const TouchedPlaces& touched) {
        for (const uint32_t v : touched.vertices)
            for (const uint32_t e : base_.edges_of_vertex(v)) set(base_.edge_sharpness[e], edge_sharpness(e));
        for (const uint32_t v : touched.vertices) {
            const float before = base_.vertex_sharpness[v];
            base_.vertex_sharpness[v] = sharpness_of_vertex(t_, v);
            sharpen_vertex(base_, v, t_.non_manifold_edges);
            changed_ |= is_infinite(before) != is_infinite(base_.vertex_sharpness[v]);
        }
        if (!base_.half_edge_sharpness.empty())
            for (const uint32_t v : touched.vertices)
                for (const uint32_t e : base_.edges_of_vertex(v)) set_halves(e);
        for (const uint32_t f : touched.faces) set_hole(f);
        if (hides_boundary_faces(base_.options))
            for (const uint32_t v : touched.vertices)
                for (const uint32_t c : base_.corners_of_vertex(v)) set_hole(base_.face_of_corner(c));
        return changed_;
    }

  private:
    float edge_sharpness(uint32_t e) const {
        return is_always_infinite(base_, e, t_.non_manifold_edges) ? kInfiniteSharpness
                                                                   : sharpness_of_edge(t_, e);
    }
    void set(float& to, float sharpness) {
        changed_ |= is_infinite(to) != is_infinite(sharpness);
        to = sharpness;
    }
    void set_halves(uint32_t e) {
        for (uint32_t i = 2 * e; i < 2 * e + 2; ++i)
            base_.half_edge_sharpness[i] =
                child_edge_sharpness(base_.options.creasing, base_.edge_sharpness[e],
                                     semi_sharp_edges_around(base_, base_.edge_vertices[i]));
    }
    void set_hole(uint32_t f) {
        const auto vertices = base_.vertices_of_face(f);
        const bool hidden =
            hides_boundary_faces(base_.options) &&
            std::any_of(vertices.begin(), vertices.end(), [&](uint32_t v) {
                return hides_faces(base_, v, [&](uint32_t e) { return sharpness_of_edge(t_, e); });
            });
        const uint8_t hole = t_.is_hole[f] != 0 || hidden;
        changed_ |= base_.face_holes[f] != hole;
        base_.face_holes[f] = hole;
    }

    EditedTopology& t_;
    Topology& base_;
    bool changed_ = false;
};

Error out_of_range(const char* kind, size_t i, const char* what, uint32_t index, uint64_t count) {
    return {
        ErrorCode::index_out_of_range,
        std::string(kind) + " " + text(i) + " refers to " + what + " " + text(index) + " of " + text(count),
        i};
}
Error bad_sharpness(const char* kind, size_t i) {
    return {ErrorCode::invalid_sharpness,
            "sharpness of " + std::string(kind) + " " + text(i) + " is negative or not a number", i};
}

}  // namespace

EditedTopology make_edited_topology(ControlMesh mesh, const BuildPart& part) {
    EditedTopology t;
    t.mesh = std::move(mesh);
    t.base = build_connectivity(t.mesh, t.non_manifold_edges, part.part(0, 0.8f));
    if (part.is_cancelled()) return t;
    index_mesh(t);
    assign_sharpness(t.mesh, t.base, t.non_manifold_edges, part.part(0.8f, 1));
    return t;
}

Result<void> check_sharpness(const EditedTopology& t, const MeshEdit& edit) {
    if (edit.crease_vertices.size() != 2 * edit.crease_sharpness.size() ||
        edit.corner_vertices.size() != edit.corner_sharpness.size())
        return Error{ErrorCode::invalid_argument, "vertices and sharpness values differ in number"};
    for (size_t i = 0; i < edit.crease_sharpness.size(); ++i) {
        const uint32_t a = edit.crease_vertices[2 * i], b = edit.crease_vertices[2 * i + 1];
        if (std::max(a, b) >= t.mesh.vertex_count)
            return out_of_range("crease", i, "vertex", std::max(a, b), t.mesh.vertex_count);
        if (!(edit.crease_sharpness[i] >= 0)) return bad_sharpness("crease", i);
        if (find_edge(t.base, a, b) == kInvalidIndex)
            return Error{
                ErrorCode::missing_edge,
                "crease " + text(i) + ": no face has an edge from vertex " + text(a) + " to " + text(b), i};
    }
    for (size_t i = 0; i < edit.corner_vertices.size(); ++i) {
        if (edit.corner_vertices[i] >= t.mesh.vertex_count)
            return out_of_range("corner", i, "vertex", edit.corner_vertices[i], t.mesh.vertex_count);
        if (!(edit.corner_sharpness[i] >= 0)) return bad_sharpness("corner", i);
    }
    for (const auto& holes : {edit.holes, edit.filled_holes})
        for (size_t i = 0; i < holes.size(); ++i)
            if (holes[i] >= t.mesh.face_count())
                return out_of_range("hole", i, "face", holes[i], t.mesh.face_count());
    return {};
}

void change_sharpness(const MeshEdit& edit, EditedTopology& t, TouchedPlaces& touched) {
    ControlMesh& mesh = t.mesh;
    TouchedPlaces here;
    for (size_t i = 0; i < edit.crease_sharpness.size(); ++i) {
        const uint32_t a = edit.crease_vertices[2 * i], b = edit.crease_vertices[2 * i + 1];
        uint32_t& crease = t.crease_of_edge[find_edge(t.base, a, b)];
        if (crease == kInvalidIndex) {
            crease = static_cast<uint32_t>(mesh.crease_sharpness.size());
            mesh.crease_edges.insert(mesh.crease_edges.end(), {a, b});
            mesh.crease_sharpness.push_back(0);
        }
        mesh.crease_sharpness[crease] = edit.crease_sharpness[i];
        here.vertices.insert(here.vertices.end(), {a, b});
    }
    for (size_t i = 0; i < edit.corner_vertices.size(); ++i) {
        uint32_t& corner = t.corner_of_vertex[edit.corner_vertices[i]];
        if (corner == kInvalidIndex) {
            corner = static_cast<uint32_t>(mesh.corner_sharpness.size());
            mesh.corner_vertices.push_back(edit.corner_vertices[i]);
            mesh.corner_sharpness.push_back(0);
        }
        mesh.corner_sharpness[corner] = edit.corner_sharpness[i];
        here.vertices.push_back(edit.corner_vertices[i]);
    }
    const auto set_hole = [&](uint32_t f, uint8_t hole) {
        if (t.is_hole[f] == hole) return;
        t.is_hole[f] = hole;
        here.faces.push_back(f);
        if (hole != 0) mesh.holes.push_back(f);
    };
    for (const uint32_t f : edit.holes) set_hole(f, 1);
    for (const uint32_t f : edit.filled_holes) set_hole(f, 0);
    std::erase_if(mesh.holes, [&](uint32_t f) { return t.is_hole[f] == 0; });
    sort_unique(here.vertices);
    touched.tessellation |= Sharpening(t).around(here);
    touched.vertices.insert(touched.vertices.end(), here.vertices.begin(), here.vertices.end());
    touched.faces.insert(touched.faces.end(), here.faces.begin(), here.faces.end());
}

SharpnessLists::SharpnessLists(const ControlMesh& mesh)
    : crease_edges(mesh.crease_edges),
      corner_vertices(mesh.corner_vertices),
      holes(mesh.holes),
      crease_sharpness(mesh.crease_sharpness),
      corner_sharpness(mesh.corner_sharpness) {}

void restore_sharpness(SharpnessLists&& lists, TouchedPlaces& touched, EditedTopology& t) {
    ControlMesh& mesh = t.mesh;
    for (size_t i = lists.crease_sharpness.size(); i < mesh.crease_sharpness.size(); ++i)
        t.crease_of_edge[find_edge(t.base, mesh.crease_edges[2 * i], mesh.crease_edges[2 * i + 1])] =
            kInvalidIndex;
    for (size_t i = lists.corner_sharpness.size(); i < mesh.corner_sharpness.size(); ++i)
        t.corner_of_vertex[mesh.corner_vertices[i]] = kInvalidIndex;
    for (const uint32_t f : touched.faces) t.is_hole[f] = 0;
    for (const uint32_t f : lists.holes) t.is_hole[f] = 1;
    mesh.crease_edges = std::move(lists.crease_edges);
    mesh.crease_sharpness = std::move(lists.crease_sharpness);
    mesh.corner_vertices = std::move(lists.corner_vertices);
    mesh.corner_sharpness = std::move(lists.corner_sharpness);
    mesh.holes = std::move(lists.holes);
    Sharpening(t).around(touched);
}

namespace {

/// A face of the edit: the mesh's own number of it, and its new corners.
struct EditedFace {
    uint32_t face, size;
    const uint32_t* vertices;
};

/// Whether face i of an edit can be one of this size. `next_new` is the next new face.
Result<void> check_face(const ControlMesh& mesh, const MeshEdit& edit, size_t i, uint64_t next_new) {
    const uint32_t face = edit.faces[i], size = edit.face_sizes[i];
    const bool is_new = face >= mesh.face_count();
    if (is_new && face != next_new)
        return Error{ErrorCode::invalid_argument,
                     "new face " + text(face) + " is not numbered " + text(next_new), i};
    if (is_new ? size < 3 : size == 1 || size == 2)
        return Error{ErrorCode::face_too_small,
                     "face " + text(face) + " has " + text(size) + " vertices, needs 3", i};
    if (mesh.options.scheme == Scheme::loop && size != 3 && size != 0)
        return Error{ErrorCode::not_a_triangle,
                     "face " + text(face) + " has " + text(size) + " vertices; Loop takes triangles only", i};
    return {};
}

/// The faces of an edit, checked, in ascending order.
Result<std::vector<EditedFace>> read_faces(const ControlMesh& mesh, const MeshEdit& edit) {
    if (edit.faces.size() != edit.face_sizes.size())
        return Error{ErrorCode::invalid_argument, "faces and face sizes differ in number"};
    const uint64_t vertex_count = uint64_t{mesh.vertex_count} + edit.new_vertex_count;
    const uint64_t corner_count =
        std::accumulate(edit.face_sizes.begin(), edit.face_sizes.end(), uint64_t{0});
    if (corner_count != edit.face_vertices.size())
        return Error{ErrorCode::invalid_argument, "face sizes do not add up to the vertices given"};
    if (vertex_count > kMaxCount || corner_count + mesh.face_vertices.size() > kMaxCount)
        return Error{ErrorCode::too_large, "more than 2^31 - 1 vertices or face corners"};
    std::vector<EditedFace> out;
    const uint32_t* vertices = edit.face_vertices.data();
    uint64_t next_new = mesh.face_count();
    for (size_t i = 0; i < edit.faces.size(); ++i) {
        if (auto ok = check_face(mesh, edit, i, next_new); !ok) return ok.error();
        if (edit.faces[i] == next_new) ++next_new;
        out.push_back({edit.faces[i], edit.face_sizes[i], vertices});
        for (uint32_t k = 0; k < edit.face_sizes[i]; ++k)
            if (vertices[k] >= vertex_count)
                return out_of_range("face", i, "vertex", vertices[k], vertex_count);
        vertices += edit.face_sizes[i];
    }
    std::sort(out.begin(), out.end(),
              [](const EditedFace& a, const EditedFace& b) { return a.face < b.face; });
    const auto twice = std::adjacent_find(
        out.begin(), out.end(), [](const EditedFace& a, const EditedFace& b) { return a.face == b.face; });
    if (twice != out.end())
        return Error{ErrorCode::invalid_argument, "face " + text(twice->face) + " is changed twice"};
    return out;
}

/// Builds faces from ranges of those that stay and, between them, those of an edit.
struct FaceWriter {
    const ControlMesh& from;
    FaceChange& change;
    ControlMesh& to = change.to.mesh;

    void keep(uint32_t first, uint32_t end) {
        const auto corner = [&](uint32_t f) { return from.face_vertices.begin() + from.face_offsets[f]; };
        const uint32_t shift = to.face_offsets.back() - from.face_offsets[first];  // modulo 2^32
        to.face_vertices.insert(to.face_vertices.end(), corner(first), corner(end));
        for (uint32_t f = first; f < end; ++f) {
            change.faces[f] = to.face_count();
            to.face_offsets.push_back(from.face_offsets[f + 1] + shift);
        }
    }
    void add(const EditedFace& face) {
        if (face.face < from.face_count()) {
            change.changed[face.face] = 1;
            touch({from.face_vertices.data() + from.face_offsets[face.face],
                   from.face_offsets[face.face + 1] - from.face_offsets[face.face]});
            if (face.size != 0) change.faces[face.face] = to.face_count();
        }
        if (face.size == 0) return;
        touch({face.vertices, face.size});
        to.face_vertices.insert(to.face_vertices.end(), face.vertices, face.vertices + face.size);
        to.face_offsets.push_back(static_cast<uint32_t>(to.face_vertices.size()));
    }
    void touch(std::span<const uint32_t> vertices) {
        change.touched.vertices.insert(change.touched.vertices.end(), vertices.begin(), vertices.end());
    }
};

}  // namespace

Result<FaceChange> change_faces(const EditedTopology& from, const MeshEdit& edit) {
    const ControlMesh& mesh = from.mesh;
    if (!mesh.channels.empty())
        return Error{ErrorCode::unsupported, "changed faces of a mesh that has face-varying channels"};
    const auto faces = read_faces(mesh, edit);
    if (!faces) return faces.error();
    FaceChange out;
    out.faces.assign(mesh.face_count(), kInvalidIndex);
    out.changed.assign(mesh.face_count(), 0);
    out.touched.tessellation = true;
    FaceWriter writer{mesh, out};
    writer.to.face_offsets.assign(1, 0);
    writer.to.face_offsets.reserve(mesh.face_offsets.size() + faces->size());
    writer.to.face_vertices.reserve(mesh.face_vertices.size() + edit.face_vertices.size());
    uint32_t next = 0;
    for (const EditedFace& face : *faces) {
        const uint32_t end = std::min(face.face, mesh.face_count());
        writer.keep(next, end);
        next = std::min(face.face + 1, mesh.face_count());
        writer.add(face);
    }
    writer.keep(next, mesh.face_count());
    ControlMesh& to = out.to.mesh;
    if (to.face_count() == 0)
        return Error{ErrorCode::invalid_argument, "a control mesh needs at least one face"};
    to.options = mesh.options;
    to.vertex_count = mesh.vertex_count + edit.new_vertex_count;
    to.crease_edges = mesh.crease_edges;
    to.crease_sharpness = mesh.crease_sharpness;
    to.corner_vertices = mesh.corner_vertices;
    to.corner_sharpness = mesh.corner_sharpness;
    for (const uint32_t f : mesh.holes)
        if (out.faces[f] != kInvalidIndex) to.holes.push_back(out.faces[f]);
    out.to = make_edited_topology(std::move(to));
    sort_unique(out.touched.vertices);
    return out;
}

}  // namespace limn
