// Plans of quads that are irregular at a corner. Each level repeats the one before around that corner, so that the
// faces around the quad need not be refined: only the rows of vertices that patches and the next level have are made.
#include <algorithm>
#include <cassert>
#include <numeric>

#include "limn/plan_writer.h"
#include "limn/topology_build.h"

namespace limn {
namespace {

/// Lists the faces around the quad of a star.
class FaceList {
  public:
    explicit FaceList(Topology& t) : vertices_(t.face_vertices), face_count_(t.face_count) {
        vertices_.allocate(0);
        face_count_ = 0;
    }
    uint32_t add(uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
        for (const uint32_t v : {a, b, c, d}) vertices_.push_back(v);
        return face_count_++;
    }

  private:
    Array<uint32_t>& vertices_;
    uint32_t& face_count_;
};

void list_faces(StarMesh& mesh) {
    const QuadStar& star = mesh.star;
    const StarRing at(star);
    const uint32_t next = at.edge(star.own), previous = at.edge(star.edge_after(star.own, 1));
    const uint32_t middle = at.face(star.own);
    FaceList faces(mesh.topology);
    for (uint32_t j = 0; j < star.face_count; ++j) {
        const uint32_t i = star.face_after(star.own, j);
        faces.add(StarRing::corner(), at.edge(i), at.face(i), at.edge(star.edge_after(i, 1)));
    }
    mesh.side_next = faces.add(next, at.beyond_next, at.side_next, middle);
    mesh.side_previous = faces.add(previous, middle, at.side_previous, at.beyond_previous);
    if (at.has_far_next)
        mesh.far_next =
            faces.add(next, at.face(star.face_after(star.own, star.face_count - 1)), at.far_next, at.beyond_next);
    if (at.has_far_previous)
        mesh.far_previous =
            faces.add(previous, at.beyond_previous, at.far_previous, at.face(star.face_after(star.own, 1)));
    mesh.rest = mesh.topology.face_count;
    for (uint32_t k = 0; k + 3 < star.opposite; ++k)
        faces.add(middle, k == 0 ? at.side_next : at.rest + 2 * k - 1, at.rest + 2 * k,
                  k + 4 == star.opposite ? at.side_previous : at.rest + 2 * k + 1);
    mesh.topology.vertex_count = at.size;
}

/// Sharpness, of edges that go on through the ends of the star's too, and rules of the quad's vertices.
void set_sharpness(StarMesh& mesh) {
    Topology& t = mesh.topology;
    const QuadStar& star = mesh.star;
    const uint32_t next = star.own, previous = star.edge_after(star.own, 1);
    for (uint32_t i = 0; i < star.edge_count(); ++i)
        t.edge_sharpness[mesh.star_edge_child(i) - child_of_edge(t, 0)] = star.sharpness[i];
    t.edge_sharpness[t.face_edges[4 * mesh.side_next]] = star.sharpness[next];
    t.edge_sharpness[t.face_edges[4 * mesh.side_previous + 3]] = star.sharpness[previous];
    const auto rule_of_end = [&](uint32_t i) {
        return star.sharpness[i] > 0 ? VertexRule::crease : VertexRule::smooth;
    };
    const auto sharp = std::count_if(star.sharpness.begin(), star.sharpness.end(), [](float s) { return s > 0; });
    t.vertex_sharpness[0] = star.corner_sharpness;
    t.vertex_rules[0] = vertex_rule(star.corner_sharpness, static_cast<uint32_t>(sharp));
    t.vertex_rules[1 + next] = rule_of_end(next);
    t.vertex_rules[1 + previous] = rule_of_end(previous);
}

bool have_same_faces(const QuadStar& a, const QuadStar& b) {
    return a.face_count == b.face_count && a.edge_count() == b.edge_count() && a.own == b.own &&
           a.opposite == b.opposite;
}

/// All values above 1 have the same rows: the child is sharp, too.
QuadStar without_levels(const QuadStar& star) {
    const auto level = [](float s) { return s > 1 ? kInfiniteSharpness : s; };
    QuadStar out = star;
    out.corner_sharpness = level(star.corner_sharpness);
    for (float& s : out.sharpness) s = level(s);
    return out;
}

}  // namespace

StarMesh::StarMesh(const SchemeOptions& options, const QuadStar& from) : star(without_levels(from)) {
    topology.options = options;
    topology.options.opensubdiv_compatible = false;  // as write_corner_rows does it
    topology.face_size = 4;
    list_faces(*this);
    [[maybe_unused]] const bool made = build_manifold_incidence(topology);
    assert(made);
    topology.edge_sharpness.assign(topology.edge_count, 0.0f);
    topology.vertex_sharpness.assign(topology.vertex_count, 0.0f);
    topology.vertex_manifold.assign(topology.vertex_count, 1);
    topology.vertex_rules.assign(topology.vertex_count, VertexRule::smooth);
    topology.face_holes.assign(topology.face_count, 0);
    set_sharpness(*this);
    rows.clear(child_count());
}

void StarMesh::sharpen(const QuadStar& from) {
    QuadStar next = without_levels(from);
    if (next == star) return;
    star = std::move(next);
    set_sharpness(*this);
    rows.clear(child_count());
}

StarMesh& PlanScratch::find_star_mesh(const SchemeOptions& options, const QuadStar& star) {
    constexpr size_t kMost = 32;
    const auto at =
        std::find_if(stars.begin(), stars.end(), [&](const auto& mesh) { return have_same_faces(mesh->star, star); });
    if (at == stars.end()) {
        if (stars.size() == kMost) stars.pop_back();
        stars.insert(stars.begin(), std::make_unique<StarMesh>(options, star));
    } else {
        std::rotate(stars.begin(), at, at + 1);
        stars.front()->sharpen(star);
    }
    return *stars.front();
}

uint32_t StarMesh::star_edge_child(uint32_t i) const {
    // The last edge of an open star ends its last face.
    return i < star.face_count ? edge_child(star_face(i), 0) : edge_child(star_face(i - 1), 3);
}

namespace {

/// Vertices of the next level: those around the quad's four children, a grid but for the irregular corner.
struct ChildGrid {
    const StarMesh& mesh;
    std::array<uint32_t, 25> vertices;

    uint32_t& at(uint32_t v, uint32_t u) { return vertices[5 * v + u]; }

    explicit ChildGrid(const StarMesh& m) : mesh(m) {
        vertices.fill(kInvalidIndex);
        const QuadStar& star = mesh.star;
        const StarRing ring(star);
        const uint32_t next = star.own, previous = star.edge_after(star.own, 1), faces = star.face_count;
        at(1, 1) = child_of_vertex(StarRing::corner());
        at(1, 2) = mesh.star_edge_child(next);
        at(1, 3) = child_of_vertex(ring.edge(next));
        at(1, 4) = mesh.edge_child(mesh.side_next, 0);
        at(2, 1) = mesh.star_edge_child(previous);
        at(2, 2) = mesh.face_child(0);
        at(2, 3) = mesh.edge_child(0, 1);
        at(2, 4) = mesh.face_child(mesh.side_next);
        at(3, 1) = child_of_vertex(ring.edge(previous));
        at(3, 2) = mesh.edge_child(0, 2);
        at(3, 3) = child_of_vertex(ring.face(star.own));
        at(3, 4) = mesh.edge_child(mesh.side_next, 2);
        at(4, 1) = mesh.edge_child(mesh.side_previous, 3);
        at(4, 2) = mesh.face_child(mesh.side_previous);
        at(4, 3) = mesh.edge_child(mesh.side_previous, 1);
        if (star.opposite == 4) at(4, 4) = mesh.face_child(mesh.rest);
        if (ring.has_far_next) {
            at(0, 1) = mesh.star_edge_child(star.edge_after(next, star.edge_count() - 1));
            at(0, 2) = mesh.face_child(mesh.star_face(star.face_after(next, faces - 1)));
            at(0, 3) = mesh.edge_child(mesh.far_next, 0);
            at(0, 4) = mesh.face_child(mesh.far_next);
        }
        if (ring.has_far_previous) {
            at(1, 0) = mesh.star_edge_child(star.edge_after(previous, 1));
            at(2, 0) = mesh.face_child(mesh.star_face(star.face_after(next, 1)));
            at(3, 0) = mesh.edge_child(mesh.far_previous, 3);
            at(4, 0) = mesh.face_child(mesh.far_previous);
        }
    }
    /// Of the child that begins at row v and column u.
    QuadNet net(uint32_t v, uint32_t u) {
        QuadNet out;
        for (uint32_t k = 0; k < 16; ++k) out[k] = at(v + k / 4, u + k % 4);
        return out;
    }
    /// Of the star at corner 0.
    void list_corner_ring(std::vector<uint32_t>& out) {
        const QuadStar& star = mesh.star;
        out.assign(1, at(1, 1));
        for (uint32_t i = 0; i < star.edge_count(); ++i) out.push_back(mesh.star_edge_child(i));
        for (uint32_t i = 0; i < star.face_count; ++i) out.push_back(mesh.face_child(mesh.star_face(i)));
        out.insert(out.end(), {at(1, 3), at(2, 3), at(3, 1), at(3, 2)});
        if (at(0, 3) != kInvalidIndex) out.push_back(at(0, 3));
        if (at(3, 0) != kInvalidIndex) out.push_back(at(3, 0));
        out.push_back(at(3, 3));
    }
    /// Of the star at corner 2, where that is irregular, too: edges to corner 3, to corner 1, and on.
    std::vector<uint32_t> opposite_ring() {
        const uint32_t rest = mesh.star.opposite - 3;
        std::vector<uint32_t> out = {at(3, 3), at(3, 2), at(2, 3), at(3, 4)};
        for (uint32_t k = 0; k < rest; ++k) out.push_back(mesh.edge_child(mesh.rest + k, 3));
        out.insert(out.end(), {at(2, 2), at(2, 4)});
        for (uint32_t k = 0; k < rest; ++k) out.push_back(mesh.face_child(mesh.rest + k));
        out.insert(out.end(), {at(4, 2), at(3, 1), at(2, 1), at(1, 3), at(1, 2), at(4, 1), at(1, 4), at(1, 1)});
        return out;
    }
};

/// The pattern of a child beside the star's edge of this sharpness, which is edge `edge` of the child.
QuadPattern side_pattern(float sharpness, uint32_t edge) {
    if (is_infinite(sharpness)) return {1u << edge, 0, 0};
    return {0, child_sharpness(sharpness), edge};
}

}  // namespace

void PlanWriter::write_star_reference(uint32_t node, uint32_t rotation, const QuadStar& star,
                                      const std::vector<uint32_t>& ring, LazyRows& from) {
    const PlanKey key = make_star_key(scheme, options, star);
    write_plan_node(node, rotation, key, ring, from, [&] { return request_star_plan(star); });
}

void PlanWriter::write_star_root(const QuadStar& root, const VertexRows& root_rows) {
    QuadStar star = root;
    uint32_t node = add_nodes(1);
    for (uint32_t depth = 0;; ++depth) {
        PlanScratch::Level& level = scratch.levels[depth];
        StarMesh& mesh = scratch.find_star_mesh(scheme, star);
        // Where the corner itself is regular, its first child is a patch: evaluation must not end at the corner.
        if (depth == 0 && !star.has_finite_sharpness() && !find_pattern(child_star(star))) {
            level.vertices.resize(plan.ring_size);
            std::iota(level.vertices.begin(), level.vertices.end(), 0u);
            write_limit_rows(mesh.topology, level.vertices, root_rows);
        }
        if (depth == 0)
            level.rows.begin_star(mesh.topology, mesh.rows, plan.ring_size, mesh.child_count());
        else
            level.rows.begin_star(mesh.topology, mesh.rows, scratch.levels[depth - 1].rows,
                                  scratch.levels[depth - 1].vertices, mesh.child_count());
        const uint32_t first = add_nodes(4);
        plan.nodes[node] = {shared::pack_node(static_cast<uint32_t>(PlanNodeKind::split), 0, 0), first};
        ChildGrid grid(mesh);
        const auto write_side = [&](uint32_t child, float sharpness, uint32_t edge, uint32_t v, uint32_t u) {
            write_quad_patch(first + child, grid.net(v, u), side_pattern(sharpness, edge), level.rows);
        };
        write_side(1, star.sharpness[star.own], 0, 0, 1);
        if (star.opposite == 4)
            write_side(2, 0, 0, 1, 1);
        else
            write_star_reference(first + 2, 2, {std::vector<float>(star.opposite, 0.0f), 0, star.opposite, 0, 4},
                                 grid.opposite_ring(), level.rows);
        write_side(3, star.sharpness[star.edge_after(star.own, 1)], 3, 1, 0);

        std::vector<uint32_t>& ring = level.vertices;
        grid.list_corner_ring(ring);
        star = child_star(star);
        cut_to_sector(star, ring);
        if (const auto pattern = find_pattern(star))
            return write_quad_patch(first, star_net(star, *pattern, ring), *pattern, level.rows);
        if (depth + 1 == options.depth) return write_star_reference(first, 0, star, ring, level.rows);
        for (const uint32_t v : ring) level.rows.row(v);  // while there is this mesh
        node = first;
    }
}

}  // namespace limn
