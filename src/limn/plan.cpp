#include "limn/plan.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <numbers>
#include <numeric>

#include "limn/gregory.h"
#include "limn/local_refinement.h"
#include "limn/plan_writer.h"
#include "limn/topology_build.h"

namespace limn {
namespace {

/// The sector around the first corner of face 0: what lies beyond infinitely sharp edges does not matter to
/// the surface there. Its star begins at the same place in every mesh.
Topology cut_sector(const Topology& t, std::vector<uint32_t>& vertices) {
    Topology cut = extract_faces(t, faces_of_sector(t, t.face_begin(0)), vertices);
    const uint32_t v = cut.face_vertices[0];
    std::fill(cut.vertex_manifold.begin(), cut.vertex_manifold.end(), uint8_t{0});
    cut.vertex_manifold[v] = 1;
    std::sort(cut.vertex_corners.begin() + cut.vertex_corner_offsets[v],
              cut.vertex_corners.begin() + cut.vertex_corner_offsets[v + 1]);
    order_stars(cut);
    return cut;
}

/// Turns the tangents of a smooth vertex so that they go along its face's edges.
void align_tangents(const Topology& t, uint32_t v, uint32_t corner, std::vector<TangentWeights>& tangents) {
    const auto corners = t.corners_of_vertex(v);
    const size_t n = corners.size();
    if (t.vertex_rules[v] != VertexRule::smooth || n < 3) return;
    const auto at = static_cast<double>(std::find(corners.begin(), corners.end(), corner) - corners.begin());
    const double theta = 2 * std::numbers::pi / static_cast<double>(n);
    for (TangentWeights& w : tangents) {
        const double x = w.tangent1, y = w.tangent2;
        w.tangent1 = std::cos(at * theta) * x + std::sin(at * theta) * y;
        w.tangent2 = std::cos((at + 1) * theta) * x + std::sin((at + 1) * theta) * y;
    }
}

}  // namespace

void PlanWriter::write_corner_rows(const Topology& t, const VertexRows& rows) {
    std::vector<uint32_t> vertices;
    Topology star = cut_sector(t, vertices);
    // A crease that does not bound the sector on both sides is one of the whole star.
    const auto edges = star.edges_of_vertex(star.face_vertices[0]);
    const auto sharp =
        std::count_if(edges.begin(), edges.end(), [&](uint32_t e) { return star.edge_sharpness[e] > 0; });
    if (star.vertex_rules[star.face_vertices[0]] == VertexRule::crease && sharp != 2) {
        star = t;
        vertices.resize(t.vertex_count);
        std::iota(vertices.begin(), vertices.end(), 0u);
    }
    // OpenSubdiv's masks are not those of its rules: a table that used them would be torn at the vertex.
    star.options.opensubdiv_compatible = false;
    write_limit_rows(star, vertices, rows);
}

void PlanWriter::write_limit_rows(const Topology& star, const std::vector<uint32_t>& vertices, const VertexRows& rows) {
    const uint32_t v = star.face_vertices[0];
    Row row;
    std::vector<TangentWeights> tangents;
    limit_row(star, v, row, tangents);
    align_tangents(star, v, 0, tangents);
    std::vector<double> sums[3];
    for (auto& sum : sums) sum.assign(width(), 0.0);
    for (size_t i = 0; i < row.size(); ++i) {
        const double* from = rows.row(vertices[row[i].index]);
        const double weights[3] = {row[i].weight, tangents[i].tangent1, tangents[i].tangent2};
        for (size_t k = 0; k < 3; ++k)
            for (size_t j = 0; j < width(); ++j) sums[k][j] += weights[k] * from[j];
    }
    // Told by their place, also where two rows are equal.
    for (const auto& sum : sums) this->rows().append(sum.data());
    plan.has_corner_rows = true;
}

namespace {

/// One step across a crease: four lines of points that run along it, `step` numbers a line, give five; line 1
/// is the crease.
void refine_crease(const double* lines, size_t step, double sharp, double* child) {
    const double *p0 = lines, *p1 = p0 + step, *p2 = p1 + step, *p3 = p2 + step;
    for (size_t j = 0; j < step; ++j) {
        const double smooth = (p0[j] + 6 * p1[j] + p2[j]) / 8;
        child[j] = (p0[j] + p1[j]) / 2;
        child[step + j] = sharp * p1[j] + (1 - sharp) * smooth;
        child[2 * step + j] = (p1[j] + p2[j]) / 2;
        child[3 * step + j] = (p1[j] + 6 * p2[j] + p3[j]) / 8;
        child[4 * step + j] = (p2[j] + p3[j]) / 2;
    }
}

}  // namespace

/// Each step leaves one patch beyond the crease.
void PlanWriter::write_crease(uint32_t node, const PatchPoints& patch, LazyRows& from) {
    const bool across_v = patch.crease_edge % 2 == 0;
    const bool at_end = patch.crease_edge == 1 || patch.crease_edge == 2;
    // Where point k of a patch lies in its four lines.
    auto place = [&](uint32_t k) {
        const uint32_t across = across_v ? k / 4 : k % 4, along = across_v ? k % 4 : k / 4;
        return (4 * (at_end ? 3 - across : across) + along) * width();
    };
    auto write = [&](uint32_t at, double* lines) {
        begin_node(at, PlanNodeKind::bicubic);
        for (uint32_t k = 0; k < 16; ++k) plan.points.push_back(rows().write(lines + place(k)));
    };
    const size_t step = 4 * width();
    std::vector<double>&lines = scratch.lines, &child = scratch.child_lines;
    lines.assign(5 * step, 0.0);
    child.resize(5 * step);
    for (uint32_t k = 0; k < 16; ++k) add_point(patch.points[k], from, lines.data() + place(k));
    const PlanNodeKind kind = across_v ? PlanNodeKind::split_v : PlanNodeKind::split_u;
    for (float sharpness = patch.crease_sharpness; sharpness > 0; sharpness = child_sharpness(sharpness)) {
        refine_crease(lines.data(), step, std::min(sharpness, 1.0f), child.data());
        const uint32_t first = add_nodes(2);
        plan.nodes[node] = {shared::pack_node(static_cast<uint32_t>(kind), 0, 0), first};
        // Zeros that are made positive here do not matter to the lines of the next step.
        write(at_end ? first : first + 1, child.data() + step);
        node = at_end ? first + 1 : first;
        std::swap(lines, child);
    }
    write(node, lines.data());
}

void PlanWriter::write_reference(uint32_t node, const Topology& t, uint32_t face, LazyRows& from) {
    const uint32_t corner = choose_plan_corner(t, face);
    Neighborhood& hood = scratch.hood;
    walk_around({t}, face, {corner, false}, hood);
    const PlanKey key = make_plan_key(t, hood, options);
    write_plan_node(node, corner, key, hood.ring, from, [&] { return request_plan(t, hood, corner); });
}

void PlanWriter::write_patch_reference(uint32_t node, const QuadNet& net, const QuadPattern& pattern, LazyRows& from) {
    LocalPatch& local = scratch.patch;
    make_local(net, pattern, local);
    const PlanKey key = make_patch_key(scheme, local);
    write_plan_node(node, local.rotation, key, local.ring, from, [&] { return request_patch_plan(local); });
}

bool PlanWriter::write_regular(uint32_t node, const Topology& t, uint32_t face, LazyRows& from) {
    PatchPoints patch;
    if (!find_patch(t, face, options, patch)) return false;
    if (patch.crease_sharpness > 0 && node != 0) {
        QuadNet net;
        const QuadPattern pattern = read_quad_patch(patch, net);
        write_patch_reference(node, net, pattern, from);
    } else {
        write_leaf(node, patch, from);
    }
    return true;
}

/// Where there is no such patch, the face itself: its corners' limits and what is between them.
void PlanWriter::write_gregory(uint32_t node, const Topology& t, uint32_t face, LazyRows& from) {
    GregoryPoints gregory;
    const bool triangles = t.options.scheme == Scheme::loop;
    PatchPoints patch;
    if (!find_gregory_points(t, face, gregory)) {
        find_patch_points(t, face, true, patch);
        return write_leaf(node, patch, from);
    }
    begin_node(node, triangles ? PlanNodeKind::gregory_triangle : PlanNodeKind::gregory);
    for (uint32_t k = 0; k < gregory.count; ++k) plan.points.push_back(write_point(gregory.points[k], from));
}

/// Face 0 of t, which is no patch.
void PlanWriter::split(uint32_t node, const Topology& t, const VertexRows& rows, uint32_t depth) {
    PlanScratch::Level& level = scratch.levels[depth];
    Topology& child = level.child;
    refine_once(t, true, child);
    level.rows.begin(t, rows, child.vertex_count);
    const uint32_t first = add_nodes(4);
    plan.nodes[node] = {shared::pack_node(static_cast<uint32_t>(PlanNodeKind::split), 0, 0), first};
    for (uint32_t j = 0; j < 4; ++j) {
        if (write_regular(first + j, child, j, level.rows)) continue;
        if (depth + 1 == options.depth) {
            if (options.end_cap == EndCap::exact)
                write_reference(first + j, child, j, level.rows);
            else
                write_gregory(first + j, child, j, level.rows);
        } else {
            extract_faces(child, faces_touching_face(child, j), level.vertices, level.part);
            level.part_rows.copy(level.rows, level.vertices);
            split(first + j, level.part, level.part_rows, depth + 1);
        }
    }
}

namespace {

/// Whether rules around the vertices of face 0, which are all that its plan depends on, are still to change.
bool has_fading_rules(const Topology& t) {
    auto is_finite = [](float s) { return s > 0 && !is_infinite(s); };
    auto fades = [&](uint32_t v) {
        const auto edges = t.edges_of_vertex(v);
        return is_finite(t.vertex_sharpness[v]) || std::any_of(edges.begin(), edges.end(), [&](uint32_t e) {
                   return is_finite(t.edge_sharpness[e]);
               });
    };
    const auto vertices = t.vertices_of_face(0);
    return std::any_of(vertices.begin(), vertices.end(), [&](uint32_t v) {
        const size_t pair = t.find_dependent(v);
        return fades(v) || child_rule_of_vertex(t, v) != t.vertex_rules[v] ||
               (pair != Topology::kNotDependent &&
                (t.dependent_seam_sharpness[pair] > 0 || fades(t.dependent_vertices[2 * pair + 1])));
    });
}

}  // namespace

void PlanWriter::write_root(const Topology& t, const VertexRows& rows) {
    const uint32_t root = add_nodes(1);
    scratch.root.begin(rows, t.vertex_count);
    if (write_regular(root, t, 0, scratch.root)) return;
    if (options.end_cap != EndCap::exact && options.depth == 0)
        return write_gregory(root, t, 0, scratch.root);
    if (options.end_cap == EndCap::exact && !has_fading_rules(t)) write_corner_rows(t, rows);
    split(root, t, rows, 0);
}

namespace {

/// Turns face 0 so that its corner `rotation` comes first.
void rotate_first_face(Topology& t, uint32_t rotation) {
    const uint32_t size = t.size_of_face(0);
    std::rotate(t.face_vertices.begin(), t.face_vertices.begin() + rotation, t.face_vertices.begin() + size);
    std::rotate(t.face_edges.begin(), t.face_edges.begin() + rotation, t.face_edges.begin() + size);
    for (Array<uint32_t>* corners : {&t.edge_corners, &t.vertex_corners})
        for (uint32_t& c : *corners)
            if (c < size) c = (c + size - rotation) % size;
}

}  // namespace

/// What keys of patches and stars go on with, in the place of the size of a ring.
constexpr uint32_t kPatchPlan = ~uint32_t{0}, kStarPlan = kPatchPlan - 1;

PlanKey begin_plan_key(const SchemeOptions& o, const PlanOptions& options) {
    return {static_cast<uint32_t>(o.scheme),
            static_cast<uint32_t>(o.creasing),
            static_cast<uint32_t>(o.triangles),
            o.opensubdiv_compatible,
            options.linear,
            options.end_cap != EndCap::exact,
            options.depth};
}

bool find_patch(const Topology& t, uint32_t face, const PlanOptions& options, PatchPoints& out) {
    // OpenSubdiv's evaluators know no single-crease patches.
    return find_patch_points(t, face, options.linear, out) &&
           (out.crease_sharpness == 0 || options.end_cap == EndCap::exact);
}

void make_local(QuadNet net, QuadPattern pattern, LocalPatch& out) {
    out.rotation = turn_quad_patch(net, pattern);
    out.ring.clear();
    for (const uint32_t v : net)
        if (v != kInvalidIndex) out.ring.push_back(v);
    out.signature = {static_cast<uint32_t>(PlanNodeKind::bicubic), pattern.sharp_edges,
                     std::bit_cast<uint32_t>(pattern.crease_sharpness)};
}

void make_local(const PatchPoints& patch, LocalPatch& out) {
    if (patch.kind == PlanNodeKind::bicubic) {
        QuadNet net;
        const QuadPattern pattern = read_quad_patch(patch, net);
        return make_local(net, pattern, out);
    }
    out.rotation = 0;
    out.ring.clear();
    out.signature = {static_cast<uint32_t>(patch.kind)};
    for (uint32_t k = 0; k < patch.count; ++k) {
        out.signature.push_back(patch.points[k].count);
        for (const RowEntry& e : patch.points[k]) {
            const auto at = std::find(out.ring.begin(), out.ring.end(), e.index);
            out.signature.push_back(static_cast<uint32_t>(at - out.ring.begin()));
            out.signature.push_back(std::bit_cast<uint32_t>(static_cast<float>(e.weight)));
            if (at == out.ring.end()) out.ring.push_back(e.index);
        }
    }
}

namespace {

/// The patch over places in its ring.
PatchPoints read_signature(const std::vector<uint32_t>& signature) {
    PatchPoints patch;
    patch.kind = static_cast<PlanNodeKind>(signature[0]);
    if (patch.kind == PlanNodeKind::bicubic) {
        const QuadPattern pattern{signature[1], std::bit_cast<float>(signature[2]), 0};
        QuadNet net;
        uint32_t place = 0;
        for (uint32_t k = 0; k < 16; ++k) net[k] = pattern.is_outside(k) ? kInvalidIndex : place++;
        return make_quad_patch(net, pattern);
    }
    for (size_t at = 1; at < signature.size(); ++patch.count) {
        PatchPoint& point = patch.points[patch.count];
        for (const size_t end = at + 1 + 2 * size_t{signature[at]}; ++at < end; ++at)
            point.entries[point.count++] = {signature[at], static_cast<double>(std::bit_cast<float>(signature[at + 1]))};
    }
    return patch;
}

}  // namespace

NewPlan build_plan(const PlanRequest& request, const SchemeOptions& scheme, const PlanOptions& options,
                   const KnownPlans& known, PlanScratch& scratch) {
    NewPlan out;
    BuiltPlan& plan = *out.plan;
    plan.ring_size = request.ring_size;
    plan.nodes.reserve(1 + 4 * size_t{options.depth});
    plan.points.reserve(64 * size_t{options.depth});
    const bool is_part = request.part != nullptr;
    const size_t count = is_part ? request.slots.size() : request.ring_size;
    VertexRows rows{plan.ring_size, std::vector<double>(count * plan.ring_size, 0.0)};
    for (uint32_t v = 0; v < count; ++v) rows.row(v)[is_part ? request.slots[v] : v] = 1;
    scratch.rows.begin(plan);
    PlanWriter writer{scheme, options, known, out, plan, scratch};
    if (is_part)
        writer.write_root(*request.part, rows);
    else if (request.star)
        writer.write_star_root(*request.star, rows);
    else
        writer.write_patch_root(read_signature(request.patch), rows);
    scratch.rows.end();
    return out;
}

LocalPatch make_regular_patch(const SchemeOptions& options, bool linear) {
    const bool triangles = options.scheme == Scheme::loop;
    PatchPoints patch;
    patch.count = linear ? (triangles ? 3 : 4) : (triangles ? 12 : 16);
    patch.kind = linear ? (triangles ? PlanNodeKind::linear : PlanNodeKind::bilinear)
                        : (triangles ? PlanNodeKind::box_spline : PlanNodeKind::bicubic);
    for (uint32_t k = 0; k < patch.count; ++k) {
        patch.points[k].entries[0] = {k, 1};
        patch.points[k].count = 1;
    }
    LocalPatch local;
    make_local(patch, local);
    return local;
}

PlanKey make_patch_key(const SchemeOptions& options, const LocalPatch& patch) {
    // Nothing but the scheme and the patch matters.
    PlanKey key = begin_plan_key({.scheme = options.scheme}, {false, EndCap::exact, 0});
    key.push_back(kPatchPlan);
    key.insert(key.end(), patch.signature.begin(), patch.signature.end());
    return key;
}

PlanKey make_star_key(const SchemeOptions& scheme, const PlanOptions& options, const QuadStar& star) {
    PlanKey key = begin_plan_key(scheme, options);
    key.push_back(kStarPlan);
    star.append_to(key);
    return key;
}

PlanRequest request_star_plan(const QuadStar& star) {
    PlanRequest request;
    request.ring_size = StarRing(star).size;
    request.star = star;
    return request;
}

PlanRequest request_patch_plan(const LocalPatch& patch) {
    PlanRequest request;
    request.ring_size = static_cast<uint32_t>(patch.ring.size());
    request.patch = patch.signature;
    return request;
}

PlanKey make_plan_key(const Topology& t, const Neighborhood& hood, const PlanOptions& options) {
    PlanKey key = begin_plan_key(t.options, options);
    key.push_back(static_cast<uint32_t>(hood.ring.size()));
    key.insert(key.end(), hood.signature.begin(), hood.signature.end());
    return key;
}

PlanRequest request_plan(const Topology& t, const Neighborhood& hood, uint32_t corner) {
    PlanRequest request;
    request.ring_size = static_cast<uint32_t>(hood.ring.size());
    std::vector<uint32_t> vertices;
    request.part = std::make_unique<Topology>(extract_faces(t, hood.faces, vertices));
    rotate_first_face(*request.part, corner);
    for (const uint32_t v : vertices)
        request.slots.push_back(
            static_cast<uint32_t>(std::find(hood.ring.begin(), hood.ring.end(), v) - hood.ring.begin()));
    return request;
}

uint32_t choose_plan_corner(const Topology& t, uint32_t face, const std::vector<uint8_t>* regular) {
    const uint32_t begin = t.face_begin(face), size = t.size_of_face(face);
    uint32_t best = 0;
    size_t most = 0;
    for (uint32_t i = 0; i < size; ++i) {
        const uint32_t v = t.face_vertices[begin + i];
        const bool smooth = t.vertex_rules[v] == VertexRule::smooth;
        const bool is_regular =
            regular != nullptr && smooth ? (*regular)[v] != 0 : is_regular_corner(t, begin + i);
        const size_t oddness = size_t{2} * !is_regular + !smooth;
        const size_t key = (oddness << 32) + t.edges_of_vertex(v).size() + 1;
        if (key > most) {
            most = key;
            best = i;
        }
    }
    return best;
}

}  // namespace limn
