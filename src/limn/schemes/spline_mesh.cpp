#include "limn/schemes/spline_mesh.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "limn/schemes/sparse_rows.h"
#include "limn/topology.h"

namespace limn {
namespace {

Error unsupported(const std::string& cause) {
    return {ErrorCode::unsupported, cause};
}

/// The largest length of which all intervals are whole multiples, but for `tolerance`; too small a one where
/// there is none.
double common_measure(const std::vector<double>& breaks, double tolerance) {
    double measure = 0;
    for (size_t i = 0; i + 1 < breaks.size(); ++i) {
        double a = measure, b = breaks[i + 1] - breaks[i];
        while (b > tolerance) {
            const double rest = std::abs(a - b * std::round(a / b));
            a = b;
            b = rest;
        }
        measure = a;
    }
    return measure;
}

/// The knots of the curve with others in between and beyond the ends, so that all intervals are equal.
Result<KnotVector> space_evenly(const KnotVector& k, const SplineMeshOptions& options) {
    if (k.degree > options.degree)
        return unsupported("a surface of degree " + std::to_string(k.degree) + " is none of degree " +
                           std::to_string(options.degree));
    // Not much less than what rounding leaves, or quotients of intervals would overflow.
    const double tolerance = std::max(options.tolerance, 1e-15) * (k.end() - k.begin());
    std::vector<double> breaks = {k.begin()};
    for (uint32_t i = k.degree + 1; i <= k.point_count(); ++i) {
        if (k.knots[i] == k.begin()) continue;
        if (k.knots[i] - breaks.back() <= tolerance)
            return unsupported("knot " + std::to_string(i) +
                               " is not simple: split the surface there, or smooth it");
        breaks.push_back(k.knots[i]);
        if (k.knots[i] == k.end()) break;
    }
    if (k.degree < options.degree && breaks.size() > 2)
        return unsupported(
            "raising the degree of a surface of several intervals would leave it multiple knots");
    const double measure = common_measure(breaks, tolerance);
    if ((k.end() - k.begin()) / measure > options.max_intervals + 0.5)
        return unsupported("intervals have no common measure, or more than " +
                           std::to_string(options.max_intervals) + " of them fit in");
    KnotVector even{options.degree, {}};
    for (uint32_t i = options.degree; i > 0; --i) even.knots.push_back(k.begin() - i * measure);
    for (size_t i = 0; i + 1 < breaks.size(); ++i) {
        const double length = breaks[i + 1] - breaks[i], parts = std::round(length / measure);
        for (double part = 0; part < parts; ++part) even.knots.push_back(breaks[i] + part / parts * length);
    }
    for (uint32_t i = 0; i <= options.degree; ++i) even.knots.push_back(k.end() + i * measure);
    return even;
}

/// Control points of a surface, before it is closed.
struct Grid {
    uint32_t columns, rows, width;
    std::vector<double> points;
    double at(uint32_t i, uint32_t j, uint32_t c) const {
        return points[(size_t{j} * columns + i) * width + c];
    }
};

/// Whether the last `degree` points of each row are the first ones again, and something is left between.
bool is_closed(const Grid& grid, bool along_u, uint32_t degree, double tolerance) {
    const uint32_t count = along_u ? grid.columns : grid.rows, across = along_u ? grid.rows : grid.columns;
    if (count < degree + 3) return false;
    for (uint32_t i = 0; i < degree; ++i)
        for (uint32_t j = 0; j < across; ++j)
            for (uint32_t c = 0; c < grid.width; ++c) {
                const uint32_t last = count - degree + i;
                const double a = along_u ? grid.at(i, j, c) : grid.at(j, i, c);
                const double b = along_u ? grid.at(last, j, c) : grid.at(j, last, c);
                if (!(std::abs(a - b) <= tolerance)) return false;
            }
    return true;
}

void add_faces(SplineMesh& mesh) {
    const auto vertex = [&](uint32_t i, uint32_t j) {
        return i % mesh.u_count + j % mesh.v_count * mesh.u_count;
    };
    for (uint32_t j = 0; j < mesh.v_face_count(); ++j)
        for (uint32_t i = 0; i < mesh.u_face_count(); ++i) {
            const uint32_t corners[4] = {vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1),
                                         vertex(i, j + 1)};
            mesh.face_sizes.push_back(4);
            mesh.face_vertices.insert(mesh.face_vertices.end(), corners, corners + 4);
        }
}

/// The rows of the first vertices in each direction: those of a closed mesh.
StencilTableDouble keep_vertices(const StencilTableDouble& all, uint32_t columns, const SplineMesh& mesh) {
    StencilTableDouble kept = make_empty_table(all.source_count);
    SparseRow row;
    for (uint32_t j = 0; j < mesh.v_count; ++j)
        for (uint32_t i = 0; i < mesh.u_count; ++i) {
            const uint32_t r = j * columns + i;
            row.entries.clear();
            for (uint32_t k = all.offsets[r]; k < all.offsets[r + 1]; ++k)
                row.entries.push_back({all.indices[k], all.weights[k], 0, 0});
            append_row(kept, row, false);
        }
    return kept;
}

double length_of_interval(const KnotVector& even) {
    return (even.end() - even.begin()) / (even.point_count() - even.degree);
}

/// Where a parameter is in one direction: a face, and between its sides.
struct Along {
    uint32_t face;
    double at;
};
Along locate_along(const KnotVector& even, double parameter, bool closed) {
    const uint32_t intervals = even.point_count() - even.degree;
    const double x = std::clamp((parameter - even.begin()) / length_of_interval(even), 0.0,
                                static_cast<double>(intervals));
    const auto k = std::min(static_cast<uint32_t>(x), intervals - 1);
    return {closed ? (k + 1) % intervals : k + 1, x - k};
}

/// Faces of a mesh in rows: corners[i + j * columns] is the corner of face (i, j) at vertex (i, j).
struct QuadRows {
    uint32_t columns = 0, rows = 0;
    bool u_closed = false, v_closed = false;
    std::vector<uint32_t> corners;
};

/// Steps from a face's corner to that of the next face along u or v, if there is one.
std::optional<uint32_t> step(const Topology& t, uint32_t corner, bool along_u) {
    const uint32_t ahead = along_u ? t.next_corner(corner) : t.next_corner(t.next_corner(corner));
    const auto around = t.corners_of_edge(t.face_edges[ahead]);
    if (around.size() != 2) return {};
    const uint32_t opposite = around[0] == ahead ? around[1] : around[0];
    return along_u ? t.next_corner(opposite) : opposite;
}

/// A corner to begin at: at a corner of the mesh; or else with its edge along a boundary; or else any.
uint32_t first_corner(const Topology& t) {
    uint32_t first = 0;
    bool boundary = false;
    for (uint32_t c = 0; c < t.corner_count(); ++c) {
        if (t.corners_of_vertex(t.face_vertices[c]).size() == 1) return c;
        if (!boundary && t.corners_of_edge(t.face_edges[c]).size() == 1) {
            first = c;
            boundary = true;
        }
    }
    return first;
}

/// Walks over all faces. Nothing where they are not in rows, each vertex once.
std::optional<QuadRows> find_rows(const Topology& t) {
    QuadRows rows;
    const uint32_t first = first_corner(t);
    const auto walk = [&](uint32_t from, bool along_u, bool& closed) {
        std::vector<uint32_t> corners = {from};
        while (corners.size() <= t.face_count) {
            const auto next = step(t, corners.back(), along_u);
            closed = next == from;
            if (!next || closed) break;
            corners.push_back(*next);
        }
        return corners;
    };
    const std::vector<uint32_t> side = walk(first, false, rows.v_closed);
    rows.rows = static_cast<uint32_t>(side.size());
    for (const uint32_t begin : side) {
        bool closed = false;
        const std::vector<uint32_t> row = walk(begin, true, closed);
        if (rows.corners.empty()) {
            rows.columns = static_cast<uint32_t>(row.size());
            rows.u_closed = closed;
        }
        if (row.size() != rows.columns || closed != rows.u_closed) return {};
        rows.corners.insert(rows.corners.end(), row.begin(), row.end());
    }
    return rows.corners.size() == t.face_count ? std::optional(rows) : std::nullopt;
}

/// The vertices in rows, or nothing where faces that should meet do not.
std::optional<std::vector<uint32_t>> list_vertices(const Topology& t, const QuadRows& rows) {
    const uint32_t columns = rows.columns + (rows.u_closed ? 0 : 1),
                   lines = rows.rows + (rows.v_closed ? 0 : 1);
    std::vector<uint32_t> vertices(size_t{columns} * lines, kInvalidIndex);
    for (uint32_t j = 0; j < rows.rows; ++j)
        for (uint32_t i = 0; i < rows.columns; ++i) {
            uint32_t corner = rows.corners[size_t{j} * rows.columns + i];
            constexpr uint32_t kSteps[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
            for (const auto& [right, up] : kSteps) {
                uint32_t& vertex = vertices[size_t{(j + up) % lines} * columns + (i + right) % columns];
                const uint32_t own = t.face_vertices[corner];
                if (vertex != kInvalidIndex && vertex != own) return {};
                vertex = own;
                corner = t.next_corner(corner);
            }
        }
    std::vector<uint32_t> sorted = vertices;
    std::sort(sorted.begin(), sorted.end());
    if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) return {};
    return vertices;
}

/// What control point `index` of a surface is made of, in one direction: vertices, reflected or wrapped.
void add_along(bool closed, bool reflected, uint32_t count, uint32_t index, SparseRow& row) {
    if (closed) return row.add((index + count - 1) % count, 1);
    if (!reflected) return row.add(index, 1);
    if (index >= 1 && index <= count) return row.add(index - 1, 1);
    row.add(index == 0 ? 0 : count - 1, 2);
    row.add(index == 0 ? 1 : count - 2, -1);
}

StencilTableDouble build_along(bool closed, bool reflected, uint32_t count) {
    StencilTableDouble table = make_empty_table(count);
    const uint32_t points = closed ? count + 3 : reflected ? count + 2 : count;
    SparseRow row;
    for (uint32_t i = 0; i < points; ++i) {
        row.entries.clear();
        add_along(closed, reflected, count, i, row);
        append_row(table, row, false);
    }
    return table;
}

}  // namespace

ControlMeshDescription SplineMesh::description() const {
    ControlMeshDescription out;
    out.options.boundary = BoundaryInterpolation::none;
    out.vertex_count = u_count * v_count;
    out.face_sizes = face_sizes;
    out.face_vertices = face_vertices;
    return out;
}

Result<SplineMesh> build_spline_mesh(const BSplineSurface& surface, const SplineMeshOptions& options) {
    if (auto checked = check_surface(surface); !checked) return checked.error();
    if ((options.degree != 2 && options.degree != 3) || options.max_intervals == 0 ||
        !(options.tolerance >= 0))
        return Error{ErrorCode::invalid_argument,
                     "meshes of surfaces are of degree 2 or 3, of one interval or more"};
    SplineMesh mesh;
    mesh.degree = options.degree;
    StencilTableDouble tables[2];
    for (const bool along_u : {true, false}) {
        const KnotVector& knots = along_u ? surface.u : surface.v;
        auto even = space_evenly(knots, options);
        if (!even) return even.error();
        auto table = build_blossom_table<double>(knots, *even);
        if (!table) return table.error();
        (along_u ? mesh.u : mesh.v) = std::move(*even);
        tables[along_u ? 0 : 1] = std::move(*table);
    }
    const auto all = multiply_directions(tables[0], tables[1]);
    if (!all) return all.error();
    Grid grid{tables[0].row_count(), tables[1].row_count(), surface.width, {}};
    grid.points.resize(size_t{all->row_count()} * surface.width);
    apply_stencil_table<double>(*all, surface.points, grid.points, surface.width);
    double largest = 0;
    for (const double x : grid.points) largest = std::max(largest, std::abs(x));
    mesh.u_closed = is_closed(grid, true, options.degree, options.tolerance * largest);
    mesh.v_closed = is_closed(grid, false, options.degree, options.tolerance * largest);
    mesh.u_count = grid.columns - (mesh.u_closed ? options.degree : 0);
    mesh.v_count = grid.rows - (mesh.v_closed ? options.degree : 0);
    mesh.vertices = keep_vertices(*all, grid.columns, mesh);
    add_faces(mesh);
    return mesh;
}

StencilTable round_weights(const StencilTableDouble& table) {
    return convert_table<float>(StencilTableDouble(table));
}

PatchSample locate_on_spline_mesh(const SplineMesh& mesh, double u, double v) {
    assert(mesh.degree == 3);
    const Along along_u = locate_along(mesh.u, u, mesh.u_closed),
                along_v = locate_along(mesh.v, v, mesh.v_closed);
    return {along_v.face * mesh.u_face_count() + along_u.face, along_u.at, along_v.at};
}

Result<BSplineSurface> build_b_spline_surface(const ControlMesh& mesh, std::span<const double> points,
                                              uint32_t width) {
    if (width == 0 || points.size() / width != mesh.vertex_count || points.size() % width != 0)
        return Error{ErrorCode::invalid_argument, "not as many points as the mesh has vertices"};
    if (mesh.options.scheme != Scheme::catmull_clark)
        return unsupported("only Catmull-Clark meshes are bicubic surfaces");
    if (!mesh.crease_edges.empty() || !mesh.corner_vertices.empty() || !mesh.holes.empty())
        return unsupported("a mesh with creases, corners or holes is no bicubic surface");
    const Topology topology = build_topology(mesh);
    const auto rows = topology.face_size == 4 ? find_rows(topology) : std::nullopt;
    const auto vertices = rows ? list_vertices(topology, *rows) : std::nullopt;
    if (!vertices) return unsupported("faces are not quads in rows");
    const bool reflected = mesh.options.boundary != BoundaryInterpolation::none;
    if (mesh.options.boundary == BoundaryInterpolation::edge_only && !rows->u_closed && !rows->v_closed)
        return unsupported("where corners are round, a surface is not bicubic");
    const uint32_t columns = rows->columns + (rows->u_closed ? 0 : 1),
                   lines = rows->rows + (rows->v_closed ? 0 : 1);
    const StencilTableDouble u = build_along(rows->u_closed, reflected, columns),
                             v = build_along(rows->v_closed, reflected, lines);
    if (u.row_count() < 4 || v.row_count() < 4)
        return unsupported("no face of the mesh is part of the surface");
    const auto table = multiply_directions(u, v);
    if (!table) return table.error();
    std::vector<double> in_rows;
    for (const uint32_t vertex : *vertices)
        in_rows.insert(in_rows.end(), &points[size_t{vertex} * width],
                       &points[size_t{vertex} * width] + width);
    BSplineSurface surface{
        make_uniform_knots(3, u.row_count()), make_uniform_knots(3, v.row_count()), width, {}};
    surface.points.resize(size_t{table->row_count()} * width);
    apply_stencil_table<double>(*table, in_rows, surface.points, width);
    return surface;
}

}  // namespace limn
