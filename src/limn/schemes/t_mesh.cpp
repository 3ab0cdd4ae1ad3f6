#include "limn/schemes/t_mesh.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "limn/row_table.h"
#include "limn/schemes/scheme_refinement.h"
#include "limn/schemes/star.h"
#include "limn/schemes/t_mesh_split.h"

namespace limn {
namespace {

/// The mesh without T-junctions, as blending functions see it.
struct Grid {
    Topology topology;
    std::vector<double> lengths;     // of edges
    std::vector<uint8_t> is_inside;  // of edges: not there in the T-mesh
    uint32_t old_count;              // vertices of the T-mesh
};

bool is_regular(const Topology& t, uint32_t v) {
    return !is_boundary_vertex(t, v) && face_valence(t, v) == 4;
}

/// A place on the grid and which way its first direction, u, points there: a position among the vertex's edges.
struct Place {
    uint32_t vertex, u;
};
uint32_t edge_of(const Topology& t, const Place& place, uint32_t quarter) {
    return t.edges_of_vertex(place.vertex)[(place.u + quarter) % 4];
}
/// The next place, `quarter` turns counter-clockwise from u; none where that one is not regular.
std::optional<Place> step(const Topology& t, const Place& from, uint32_t quarter) {
    const uint32_t e = edge_of(t, from, quarter), v = t.other_vertex(e, from.vertex);
    if (!is_regular(t, v)) return {};
    return Place{v, (edge_position(t, v, e) + 6 - quarter) % 4};
}

/// Whether the T-mesh has a line across direction `quarter` here.
bool is_knot(const Grid& grid, const Place& place, uint32_t quarter) {
    const Topology& t = grid.topology;
    return place.vertex < grid.old_count || grid.is_inside[edge_of(t, place, quarter + 1)] == 0 ||
           grid.is_inside[edge_of(t, place, quarter + 3)] == 0;
}

/// Knots of one direction around a vertex, whose own is 0: those of the grid within the support of the T-mesh's
/// blending function, and the five that are this function's own.
struct Knots {
    std::vector<double> all, own;
    uint32_t before = 0;  ///< of the grid below 0
};
/// None where the support leaves what is regular.
std::optional<Knots> read_knots(const Grid& grid, const Place& center, uint32_t quarter) {
    Knots knots;
    for (const uint32_t side : {quarter + 2, quarter}) {
        const double sign = side == quarter ? 1 : -1;
        Place at = center;
        double distance = 0;
        for (uint32_t found = 0; found < 2;) {
            distance += sign * grid.lengths[edge_of(grid.topology, at, side)];
            const auto next = step(grid.topology, at, side % 4);
            if (!next) return {};
            at = *next;
            knots.all.push_back(distance);
            knots.before += sign < 0;
            if (!is_knot(grid, at, side)) continue;
            knots.own.push_back(distance);
            ++found;
        }
    }
    knots.all.push_back(0);
    knots.own.push_back(0);
    std::sort(knots.all.begin(), knots.all.end());
    std::sort(knots.own.begin(), knots.own.end());
    return knots;
}

/// The blending function on `own` knots as a sum of those on each five successive ones of `all` (Boehm 1980).
std::vector<double> refine_function(const Knots& knots) {
    std::vector<double> weights = {1}, t = knots.own;
    for (const double knot : knots.all) {
        if (std::binary_search(knots.own.begin(), knots.own.end(), knot)) continue;
        const auto j = static_cast<size_t>(std::upper_bound(t.begin(), t.end(), knot) - t.begin()) - 1;
        std::vector<double> next(weights.size() + 1);
        for (size_t i = 0; i < next.size(); ++i) {
            const double a = i + 3 <= j ? 1 : i > j ? 0 : (knot - t[i]) / (t[i + 3] - t[i]);
            next[i] = (i < weights.size() ? a * weights[i] : 0) + (i > 0 ? (1 - a) * weights[i - 1] : 0);
        }
        weights = std::move(next);
        t.insert(t.begin() + static_cast<std::ptrdiff_t>(j) + 1, knot);
    }
    return weights;
}

/// A control point of the T-mesh in one of the grid.
struct Share {
    uint32_t grid_vertex, vertex;
    double weight;
};

/// Whether the T-mesh is as it was within two rings of faces around v.
bool is_untouched(const Grid& grid, uint32_t v) {
    const Topology& t = grid.topology;
    std::vector<uint32_t> vertices = {v};
    for (int ring = 0; ring < 2; ++ring)
        for (size_t i = 0, count = vertices.size(); i < count; ++i)
            for (const uint32_t c : t.corners_of_vertex(vertices[i]))
                for (const uint32_t u : t.vertices_of_face(t.face_of_corner(c))) vertices.push_back(u);
    return std::all_of(vertices.begin(), vertices.end(), [&](uint32_t u) {
        const auto edges = t.edges_of_vertex(u);
        return u < grid.old_count &&
               std::all_of(edges.begin(), edges.end(), [&](uint32_t e) { return grid.is_inside[e] == 0; });
    });
}

/// Shares of vertex v in the places of its support, all of which must be regular. False where one is not.
bool add_shares(const Grid& grid, uint32_t v, const Knots& u, const Knots& w, std::vector<Share>& shares) {
    const Topology& t = grid.topology;
    const std::vector<double> in_u = refine_function(u), in_w = refine_function(w);
    std::optional<Place> row = Place{v, 0};
    auto walk = [&](std::optional<Place>& place, uint32_t quarter, uint32_t steps) {
        for (uint32_t i = 0; place && i < steps; ++i) place = step(t, *place, quarter);
    };
    walk(row, 3, w.before);
    for (uint32_t j = 0; j < w.all.size(); ++j) {
        std::optional<Place> at = row;
        if (at) walk(at, 2, u.before);
        for (uint32_t i = 0; i < u.all.size(); ++i) {
            if (!at) return false;
            const uint32_t a = i - 2, b = j - 2;  // functions have their middle at the third knot
            const double weight = a < in_u.size() && b < in_w.size() ? in_u[a] * in_w[b] : 0;
            if (weight != 0) shares.push_back({at->vertex, v, weight});
            if (i + 1 < u.all.size()) at = step(t, *at, 0);
        }
        if (j + 1 < w.all.size()) row = step(t, *row, 1);
        if (!row) return false;
    }
    return true;
}

bool add_vertex(const Grid& grid, uint32_t v, std::vector<Share>& shares) {
    if (face_valence(grid.topology, v) == 0) {
        shares.push_back({v, v, 1});
        return true;
    }
    if (is_regular(grid.topology, v)) {
        const auto u = read_knots(grid, {v, 0}, 0), w = read_knots(grid, {v, 0}, 1);
        if (u && w) {
            if (u->all.size() > 5 || w->all.size() > 5) return add_shares(grid, v, *u, *w, shares);
            shares.push_back({v, v, 1});  // its function is the grid's
            return true;
        }
    }
    shares.push_back({v, v, 1});
    return is_untouched(grid, v);
}

/// Numbers of corners as numbers of edges, their mean.
std::vector<double> mean_of_edges(const Topology& t, std::span<const double> of_corners) {
    std::vector<double> out(t.edge_count);
    for (uint32_t e = 0; e < t.edge_count; ++e)
        for (const uint32_t c : t.corners_of_edge(e))
            out[e] += of_corners[c] / static_cast<double>(t.corners_of_edge(e).size());
    return out;
}

Grid make_grid(const TMeshSplit& split, Topology topology, uint32_t old_count) {
    Grid grid{std::move(topology), {}, {}, old_count};
    const Topology& t = grid.topology;
    grid.lengths = mean_of_edges(t, split.intervals);
    for (uint32_t e = 0; e < t.edge_count; ++e) grid.is_inside.push_back(split.is_inside[t.corners_of_edge(e)[0]]);
    return grid;
}

Error near_irregular(uint32_t v) {
    return Error{
        ErrorCode::unsupported,
        "a T-junction's edge goes on too near to an irregular vertex or a boundary: around vertex " + std::to_string(v),
        v};
}

}  // namespace

Result<ConvertedTMesh> convert_t_mesh(const ControlMesh& mesh, std::span<const uint8_t> straight,
                                      std::span<const double> intervals) {
    if (straight.size() != mesh.face_vertices.size() || intervals.size() != mesh.face_vertices.size())
        return Error{ErrorCode::invalid_argument, "flags and intervals of a T-mesh are not one for each corner"};
    for (size_t c = 0; c < intervals.size(); ++c)
        if (!(intervals[c] > 0) || !std::isfinite(intervals[c]))
            return Error{ErrorCode::invalid_argument,
                         "the knot interval of corner " + std::to_string(c) + " is not positive", c};
    const SubdivisionScheme& nurss = *find_subdivision_scheme("nurss");
    const auto stage = build_first_stage(mesh, nurss);
    if (!stage) return stage.error();
    auto split = split_t_mesh(stage->topology, straight, mean_of_edges(stage->topology, intervals));
    if (!split) return split.error();
    auto grid_stage = build_first_stage(split->mesh, nurss);
    if (!grid_stage) return grid_stage.error();
    const Grid grid = make_grid(*split, std::move(grid_stage->topology), mesh.vertex_count);

    std::vector<Share> shares;
    for (uint32_t v = 0; v < mesh.vertex_count; ++v)
        if (!add_vertex(grid, v, shares)) return near_irregular(v);
    std::stable_sort(shares.begin(), shares.end(),
                     [](const Share& a, const Share& b) { return a.grid_vertex < b.grid_vertex; });
    std::vector<size_t> first(size_t{grid.topology.vertex_count} + 1);
    for (const Share& share : shares) ++first[size_t{share.grid_vertex} + 1];
    for (size_t v = 0; v + 1 < first.size(); ++v) {
        if (first[v + 1] == 0) return near_irregular(static_cast<uint32_t>(v));
        first[v + 1] += first[v];
    }
    ConvertedTMesh out;
    for (size_t v = 0; v + 1 < first.size(); ++v) {
        double sum = 0;
        for (size_t i = first[v]; i < first[v + 1]; ++i) sum += shares[i].weight;
        out.rational |= std::abs(sum - 1) > 1e-12;
    }
    auto table =
        build_table_of_rows<double>(mesh.vertex_count, grid.topology.vertex_count, {}, [&](uint32_t r, Row& row) {
            for (size_t i = first[r]; i < first[size_t{r} + 1]; ++i) add(row, shares[i].vertex, shares[i].weight);
        });
    if (!table) return table.error();
    out.points = std::move(*table);
    out.mesh = std::move(split->mesh);
    out.intervals = std::move(split->intervals);
    return out;
}

}  // namespace limn
