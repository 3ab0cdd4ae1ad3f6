#include "limn/tessellation_table.h"

#include <algorithm>
#include <numeric>
#include <string>
#include <vector>

#include "limn/parallel.h"
#include "limn/topology.h"

namespace limn {
namespace {

/// Disjoint sets, each named after its smallest member.
struct Sets {
    std::vector<uint32_t> parent;
    explicit Sets(size_t count) : parent(count) { std::iota(parent.begin(), parent.end(), 0u); }
    uint32_t find(uint32_t i) {
        while (parent[i] != i) i = parent[i] = parent[parent[i]];
        return i;
    }
    void join(uint32_t a, uint32_t b) {
        a = find(a);
        b = find(b);
        parent[std::max(a, b)] = std::min(a, b);
    }
};

constexpr uint32_t kCorners = 4;  ///< numbers of corners that a ptex face takes up

struct Builder {
    const ControlMesh& mesh;
    const TessellationTableOptions& options;
    const Topology& base;
    TessellationTable& out;
    uint32_t own_size = 4;                   ///< of faces that are one ptex face
    std::vector<uint32_t> first_ptex = {};   ///< of each face
    std::vector<uint32_t> first_sub = {};    ///< of each face's sub-face edges
    std::vector<uint8_t> halved = {};        ///< mesh edges beside faces that are split at their middle
    std::vector<uint8_t> shared_rows = {};   ///< mesh edges whose two faces share a row
    std::vector<uint32_t> row_of_corner = {};  ///< mesh corner -> the row, or the first of two, of the edge there
    std::vector<uint32_t> rows = {}, row_copies = {}, sub_rows = {};

    bool is_split(uint32_t face) const { return base.size_of_face(face) != own_size; }
    bool is_drawn(uint32_t face) const { return base.face_holes[face] == 0; }
    bool is_drawn_corner(uint32_t corner) const { return is_drawn(base.face_of_corner(corner)); }
    uint32_t index_in_face(uint32_t corner) const {
        return corner - base.face_begin(base.face_of_corner(corner));
    }
    /// Corner number (face's ptex faces times kCorners) of the vertex at a mesh corner.
    uint32_t number(uint32_t corner) const {
        const uint32_t face = base.face_of_corner(corner), i = index_in_face(corner);
        return is_split(face) ? kCorners * (first_ptex[face] + i) : kCorners * first_ptex[face] + i;
    }
    /// That of the middle of the edge that begins at a mesh corner; only of split faces.
    uint32_t middle_number(uint32_t corner) const { return number(corner) + 1; }

    bool has_seam(uint32_t a, uint32_t b) const {
        for (const uint32_t channel : options.channels) {
            const std::vector<uint32_t>& values = mesh.channels[channel].face_values;
            if (values[a] != values[base.next_corner(b)] || values[base.next_corner(a)] != values[b]) return true;
        }
        return false;
    }
    bool find_shared(uint32_t e) const {
        const auto corners = base.corners_of_edge(e);
        if (corners.size() != 2 || !is_drawn_corner(corners[0]) || !is_drawn_corner(corners[1])) return false;
        if (base.face_vertices[corners[0]] == base.face_vertices[corners[1]]) return false;  // wound differently
        if (options.split_creases &&
            (is_infinite(base.edge_sharpness[e]) || base.options.scheme == Scheme::bilinear))
            return false;
        return !has_seam(corners[0], corners[1]);
    }
    /// Faces around a vertex of this rule have no normal in common, even where they share an edge.
    bool has_corner_normals(uint32_t vertex) const {
        return options.split_creases &&
               (base.vertex_rules[vertex] == VertexRule::corner && !is_semi_sharp(vertex));
    }
    /// The rule passes: nothing infinite makes it a corner.
    bool is_semi_sharp(uint32_t v) const {
        if (is_infinite(base.vertex_sharpness[v])) return false;
        const auto edges = base.edges_of_vertex(v);
        return std::count_if(edges.begin(), edges.end(),
                             [&](uint32_t e) { return is_infinite(base.edge_sharpness[e]); }) <= 2;
    }

    bool is_shared(uint32_t e) const { return shared_rows[e] != 0; }

    void count_faces(const BuildPart& part);
    void share_rows(const BuildPart& part);
    void add_rows_of_edge(uint32_t e);
    void add_sub_rows(uint32_t face);
    uint32_t add_row(uint32_t rate_edge, uint32_t corner, bool along, bool is_halved);
    void write_sides(const BuildPart& part);
    void write_corners(Sets& corners, const BuildPart& part);
    void join_corners(Sets& corners, const BuildPart& part) const;
};

void Builder::count_faces(const BuildPart& part) {
    own_size = base.options.scheme == Scheme::loop ? 3 : 4;
    first_ptex.resize(base.face_count);
    first_sub.resize(base.face_count);
    halved.assign(base.edge_count, 0);
    out.mesh_edge_count = base.edge_count;
    out.rate_edge_count = base.edge_count;
    for_each_in_order(base.face_count, part, [&](uint32_t f) {
        first_ptex[f] = out.face_count;
        first_sub[f] = out.rate_edge_count;
        out.face_count += is_split(f) ? base.size_of_face(f) : 1;
        if (!is_split(f)) return;
        out.rate_edge_count += base.size_of_face(f);
        if (is_drawn(f))
            for (const uint32_t e : base.edges_of_face(f)) halved[e] = 1;
    });
}

void Builder::share_rows(const BuildPart& part) {
    shared_rows.resize(base.edge_count);
    for_each_index(base.edge_count, part, [&](uint32_t e) { shared_rows[e] = find_shared(e); });
    rows.reserve(size_t{out.rate_edge_count} * shared::kTessRowWords);  // or somewhat more of them
}

/// Adds one row, or two halves, of the edge that begins at `corner` of its face, from its beginning there or
/// (`along` false) from its end; returns the first.
uint32_t Builder::add_row(uint32_t rate_edge, uint32_t corner, bool along, bool is_halved) {
    const uint32_t face = base.face_of_corner(corner), i = index_in_face(corner);
    const auto first = static_cast<uint32_t>(rows.size() / shared::kTessRowWords);
    const auto add = [&](uint32_t ptex, uint32_t place) {
        rows.insert(rows.end(), {rate_edge, ptex, place, kInvalidIndex});
    };
    if (is_split(face)) {
        const uint32_t n = base.size_of_face(face), own = first_ptex[face] + i, next = first_ptex[face] + (i + 1) % n;
        // The first half is side 0 of the corner's quad, the second side 3 of the next one's.
        if (along) {
            add(own, shared::pack_row_place(0, 0, 2, 0));
            add(next, shared::pack_row_place(0, 2, 0, 0));
        } else {
            add(next, shared::pack_row_place(0, 0, 0, 2));
            add(own, shared::pack_row_place(2, 0, 0, 0));
        }
        return first;
    }
    const uint32_t u[4] = {0, 2, own_size == 4 ? 2u : 0u, 0}, v[4] = {0, 0, 2, 2};
    const uint32_t from = along ? i : (i + 1) % own_size, to = along ? (i + 1) % own_size : i;
    const uint32_t middle_u = (u[from] + u[to]) / 2, middle_v = (v[from] + v[to]) / 2;
    if (!is_halved) {
        add(first_ptex[face], shared::pack_row_place(u[from], v[from], u[to], v[to]));
    } else {
        add(first_ptex[face], shared::pack_row_place(u[from], v[from], middle_u, middle_v));
        add(first_ptex[face], shared::pack_row_place(middle_u, middle_v, u[to], v[to]));
    }
    return first;
}

/// All rows of an edge run as it does at its first drawn corner.
void Builder::add_rows_of_edge(uint32_t e) {
    const bool is_halved = halved[e] != 0;
    uint32_t primary = kInvalidIndex, begin = 0, drawn = 0, faces[2] = {shared::kNoFace, shared::kNoFace};
    for (const uint32_t corner : base.corners_of_edge(e)) {
        if (!is_drawn_corner(corner)) continue;
        const uint32_t face = base.face_of_corner(corner);
        if (drawn < 2) faces[drawn] = first_ptex[face] + (is_split(face) ? index_in_face(corner) : 0);
        ++drawn;
        if (primary == kInvalidIndex) {
            begin = base.face_vertices[corner];
            row_of_corner[corner] = primary = add_row(e, corner, true, is_halved);
        } else if (is_shared(e)) {
            row_of_corner[corner] = primary;
        } else {
            const bool along = base.face_vertices[corner] == begin;
            const uint32_t row = row_of_corner[corner] = add_row(e, corner, along, is_halved);
            for (uint32_t half = 0; half <= static_cast<uint32_t>(is_halved); ++half)
                row_copies.insert(row_copies.end(), {row + half, primary + half});
        }
    }
    // Halves lie beside two ptex faces of a split face, and both of those must know: then every face counts.
    if (drawn > 2 || is_halved) faces[0] = shared::kManyFaces;
    uint32_t* words = out.rate_edges.data() + size_t{e} * shared::kRateEdgeWords;
    words[0] = primary == kInvalidIndex ? shared::kNoRateEdge : primary | (is_halved ? shared::kRateEdgeHalves : 0);
    words[1] = faces[0];
    words[2] = faces[1];
}

/// Sub-face edge j goes from the middle of the face's edge j to the middle of the face: side 1 of quad j, and
/// side 2 of the next one against it.
void Builder::add_sub_rows(uint32_t face) {
    const uint32_t n = base.size_of_face(face);
    for (uint32_t j = 0; j < n; ++j) {
        const uint32_t edge = first_sub[face] + j, ptex = first_ptex[face] + j;
        const auto row = static_cast<uint32_t>(rows.size() / shared::kTessRowWords);
        uint32_t* words = out.rate_edges.data() + size_t{edge} * shared::kRateEdgeWords;
        words[0] = is_drawn(face) ? row | shared::kRateEdgeSubFace : shared::kNoRateEdge;
        words[1] = ptex;
        words[2] = first_ptex[face] + (j + 1) % n;
        if (!is_drawn(face)) continue;
        sub_rows[edge - base.edge_count] = row;
        rows.insert(rows.end(), {edge, ptex, shared::pack_row_place(2, 0, 2, 2), kInvalidIndex});
    }
}

void Builder::join_corners(Sets& corners, const BuildPart& part) const {
    for_each_in_order(base.edge_count, part.part(0, 0.7f), [&](uint32_t e) {
        if (!is_shared(e)) return;
        const uint32_t a = base.corners_of_edge(e)[0], b = base.corners_of_edge(e)[1];
        if (!has_corner_normals(base.face_vertices[a])) corners.join(number(a), number(base.next_corner(b)));
        if (!has_corner_normals(base.face_vertices[b])) corners.join(number(b), number(base.next_corner(a)));
        const bool split_a = is_split(base.face_of_corner(a)), split_b = is_split(base.face_of_corner(b));
        if (split_a && split_b) corners.join(middle_number(a), middle_number(b));
    });
    for_each_in_order(base.face_count, part.part(0.7f, 1), [&](uint32_t f) {
        if (!is_split(f)) return;
        const uint32_t n = base.size_of_face(f), first = kCorners * first_ptex[f];
        for (uint32_t j = 0; j < n; ++j) {
            const uint32_t next = first + kCorners * ((j + 1) % n);
            corners.join(first + kCorners * j + 1, next + 3);  // the middle of edge j
            corners.join(first + kCorners * j + 2, next + 2);  // the middle of the face
        }
    });
}

/// What faces are, but for their corners.
void Builder::write_sides(const BuildPart& part) {
    out.faces.assign(size_t{out.face_count} * shared::kTessFaceWords, shared::kNoSide);
    for_each_index(base.face_count, part, [&](uint32_t f) {
        if (!is_drawn(f)) return;
        const uint32_t n = base.size_of_face(f), begin = base.face_begin(f);
        const auto side = [&](uint32_t j) {  // of edge j, whole
            const uint32_t e = base.face_edges[begin + j], row = row_of_corner[begin + j];
            const uint32_t first = base.face_vertices[begin + j];
            uint32_t along_first = kInvalidIndex;
            for (const uint32_t c : base.corners_of_edge(e))
                if (is_drawn_corner(c) && along_first == kInvalidIndex) along_first = base.face_vertices[c];
            return row | (first == along_first ? 0 : shared::kSideReversed) | (halved[e] != 0 ? shared::kSideHalves : 0);
        };
        const auto half = [&](uint32_t j, bool second) {
            const uint32_t whole = side(j), reversed = whole & shared::kSideReversed;
            return (shared::side_row(whole) + (second != (reversed != 0) ? 1 : 0)) | reversed;
        };
        for (uint32_t q = 0; q < (is_split(f) ? n : 1); ++q) {
            uint32_t* words = out.faces.data() + size_t{first_ptex[f] + q} * shared::kTessFaceWords;
            if (is_split(f)) {
                const uint32_t previous = (q + n - 1) % n, sub = first_sub[f] - base.edge_count;
                words[0] = half(q, false);
                words[1] = sub_rows[sub + q];
                words[2] = sub_rows[sub + previous] | shared::kSideReversed;
                words[3] = half(previous, true);
            } else {
                for (uint32_t j = 0; j < n; ++j) words[j] = side(j);
            }
        }
    });
}

/// Numbers corners in the order of faces, and finds those that have the position of another.
void Builder::write_corners(Sets& corners, const BuildPart& part) {
    std::vector<uint32_t> numbers(size_t{out.face_count} * kCorners, kInvalidIndex), words, copies;
    // Of mesh vertices and middles of edges: the corner whose position the others have.
    std::vector<uint32_t> of_vertex(base.vertex_count, kInvalidIndex), of_edge(base.edge_count, kInvalidIndex);
    words.reserve(numbers.size() * shared::kTessCornerWords);  // one that grows keeps a cancellation waiting
    const uint32_t half_u[4] = {0, 2, own_size == 4 ? 2u : 0u, 0}, half_v[4] = {0, 0, 2, 2};
    const auto add = [&](uint32_t ptex, uint32_t u, uint32_t v, uint32_t* first) {
        words.insert(words.end(), {ptex, u | v << 2});
        const auto corner = static_cast<uint32_t>(words.size() / shared::kTessCornerWords - 1);
        if (first == nullptr) return corner;
        if (*first == kInvalidIndex)
            *first = corner;
        else
            copies.insert(copies.end(), {corner, *first});
        return corner;
    };
    for_each_in_order(base.face_count, part.part(0, 0.7f), [&](uint32_t f) {
        if (!is_drawn(f)) return;
        for (uint32_t q = 0; q < (is_split(f) ? base.size_of_face(f) : 1); ++q) {
            const uint32_t ptex = first_ptex[f] + q, n = base.size_of_face(f);
            for (uint32_t k = 0; k < own_size; ++k) {
                const uint32_t set = corners.find(kCorners * ptex + k);
                uint32_t* first = nullptr;
                if (!is_split(f) || k == 0) first = &of_vertex[base.face_vertices[base.face_begin(f) + q + k]];
                if (is_split(f) && k == 1) first = &of_edge[base.face_edges[base.face_begin(f) + q]];
                if (is_split(f) && k == 3) first = &of_edge[base.face_edges[base.face_begin(f) + (q + n - 1) % n]];
                if (numbers[set] == kInvalidIndex) numbers[set] = add(ptex, half_u[k], half_v[k], first);
                out.faces[size_t{ptex} * shared::kTessFaceWords + 4 + k] = numbers[set];
            }
        }
    });
    // Middles of halved edges: at rows of quads that do not share them with a split face they are corners, too.
    for_each_in_order(base.edge_count, part.part(0.7f, 1), [&](uint32_t e) {
        if (halved[e] == 0) return;
        for (const uint32_t corner : base.corners_of_edge(e)) {
            if (!is_drawn_corner(corner)) continue;
            const uint32_t face = base.face_of_corner(corner);
            uint32_t& middle = rows[size_t{row_of_corner[corner]} * shared::kTessRowWords + 3];
            if (is_split(face)) middle = numbers[corners.find(middle_number(corner))];
        }
        for (const uint32_t corner : base.corners_of_edge(e)) {
            if (!is_drawn_corner(corner)) continue;
            uint32_t& middle = rows[size_t{row_of_corner[corner]} * shared::kTessRowWords + 3];
            if (middle != kInvalidIndex) continue;
            const uint32_t i = index_in_face(corner), next = (i + 1) % own_size;
            middle = add(first_ptex[base.face_of_corner(corner)], (half_u[i] + half_u[next]) / 2,
                         (half_v[i] + half_v[next]) / 2, &of_edge[e]);
        }
    });
    const auto copy = [](const std::vector<uint32_t>& from, Array<uint32_t>& to) {
        to.allocate(from.size());
        std::copy(from.begin(), from.end(), to.begin());
    };
    copy(words, out.corners);
    copy(copies, out.corner_copies);
    copy(row_copies, out.row_copies);
    copy(rows, out.rows);
    out.corner_count = static_cast<uint32_t>(words.size() / shared::kTessCornerWords);
    out.row_count = static_cast<uint32_t>(rows.size() / shared::kTessRowWords);
}

Result<void> check(const ControlMesh& mesh, const TessellationTableOptions& options) {
    for (const uint32_t channel : options.channels)
        if (channel >= mesh.channels.size())
            return Error{ErrorCode::index_out_of_range,
                         "channel " + std::to_string(channel) + " of " + std::to_string(mesh.channels.size()),
                         channel};
    if (mesh.face_vertices.size() >= size_t{1} << 28)
        return Error{ErrorCode::too_large, "a tessellation of 2^28 corners or more"};
    return {};
}

}  // namespace

Result<TessellationTable> build_tessellation_table(const ControlMesh& mesh, const Topology& base,
                                                   const TessellationTableOptions& options) {
    if (auto ok = check(mesh, options); !ok) return ok.error();
    const BuildPart& part = options.control;
    if (auto ok = part.start(); !ok) return ok.error();
    TessellationTable out;
    Builder b{mesh, options, base, out};
    out.options = base.options;
    b.count_faces(part.part(0, 0.05f));
    b.share_rows(part.part(0.05f, 0.1f));
    if (auto ok = part.check(); !ok) return ok.error();
    out.rate_edges.allocate(size_t{out.rate_edge_count} * shared::kRateEdgeWords);
    b.row_of_corner.assign(base.corner_count(), kInvalidIndex);
    b.sub_rows.assign(out.rate_edge_count - base.edge_count, kInvalidIndex);
    for_each_in_order(base.edge_count, part.part(0.1f, 0.3f), [&](uint32_t e) { b.add_rows_of_edge(e); });
    for_each_in_order(base.face_count, part.part(0.3f, 0.4f), [&](uint32_t f) {
        if (b.is_split(f)) b.add_sub_rows(f);
    });
    if (auto ok = part.check(); !ok) return ok.error();
    Sets corners(size_t{out.face_count} * kCorners);
    b.join_corners(corners, part.part(0.4f, 0.6f));
    if (auto ok = part.check(); !ok) return ok.error();
    b.write_sides(part.part(0.6f, 0.7f));
    if (auto ok = part.check(); !ok) return ok.error();
    b.write_corners(corners, part.part(0.7f, 0.98f));
    if (auto ok = part.reach(1); !ok) return ok.error();
    return out;
}

Result<TessellationTable> build_tessellation_table(const ControlMesh& mesh,
                                                   const TessellationTableOptions& options) {
    constexpr float kTopologyEnd = 0.35f;  // of progress
    if (auto ok = check(mesh, options); !ok) return ok.error();
    if (auto ok = options.control.start(); !ok) return ok.error();
    const Topology base = build_topology(mesh, options.control.part(0, kTopologyEnd));
    if (auto ok = options.control.check(); !ok) return ok.error();
    TessellationTableOptions rest = options;
    rest.control = options.control.part(kTopologyEnd, 1);
    return build_tessellation_table(mesh, base, rest);
}

Array<uint32_t> list_instances(const TessellationTable& table) {
    const uint32_t count = table.instance_count();
    Array<uint32_t> words;
    words.allocate(2 * size_t{count} + 2);
    words[0] = count;
    words[1] = 0;
    words[count + 1] = table.face_count;
    std::copy(table.instance_faces.begin(), table.instance_faces.end(), words.begin() + 1);
    uint32_t* numbers = words.data() + count + 2;
    std::iota(numbers, numbers + count, 0);
    std::copy(table.instance_numbers.begin(), table.instance_numbers.end(), numbers);
    return words;
}

}  // namespace limn
