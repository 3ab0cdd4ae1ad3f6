#include "shapes/tessellation_checks.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "limn/topology.h"

namespace limn::test {
namespace {

using Uses = std::pair<uint32_t, uint32_t>;  // triangles one way, and the other; the larger first
Uses make_uses(uint32_t a, uint32_t b) {
    return {std::max(a, b), std::min(a, b)};
}

bool is_drawn(const TessellationTable& table, std::span<const uint32_t> rates, uint32_t ptex) {
    const uint32_t* words = table.faces.data() + size_t{ptex} * shared::kTessFaceWords;
    if (words[0] == shared::kNoSide) return false;
    for (uint32_t k = 0; k < (table.options.scheme == Scheme::loop ? 3u : 4u); ++k)
        if (rates[table.rows[size_t{shared::side_row(words[k])} * shared::kTessRowWords]] == 0) return false;
    return true;
}

/// How many segments of the control mesh's edges have how many triangles, where not one on either side; from the
/// control mesh alone.
std::map<Uses, uint64_t> expected_uses(const ControlMesh& mesh, const TessellationTable& table,
                                       std::span<const uint32_t> rates, TessellationSpacing spacing) {
    const Topology base = build_topology(mesh);
    const uint32_t own = base.options.scheme == Scheme::loop ? 3 : 4;
    std::map<Uses, uint64_t> expected;
    std::vector<uint32_t> first_ptex, first_sub;
    uint32_t ptex = 0, sub = base.edge_count;
    for (uint32_t f = 0; f < base.face_count; ++f) {
        const uint32_t n = base.size_of_face(f);
        first_ptex.push_back(ptex);
        first_sub.push_back(sub);
        ptex += n == own ? 1 : n;
        sub += n == own ? 0 : n;
    }
    const auto add = [&](uint32_t edge, Uses uses) {
        if (uses != Uses{0, 0} && uses != Uses{1, 1})
            expected[uses] += shared::segment_count(rates[edge], spacing == TessellationSpacing::fractional);
    };
    for (uint32_t e = 0; e < base.edge_count; ++e) {
        bool halves = false;
        for (const uint32_t c : base.corners_of_edge(e)) {
            const uint32_t f = base.face_of_corner(c);
            halves |= base.size_of_face(f) != own && base.face_holes[f] == 0;
        }
        for (uint32_t half = 0; half <= static_cast<uint32_t>(halves); ++half) {
            uint32_t ways[2] = {0, 0};
            for (const uint32_t c : base.corners_of_edge(e)) {
                const uint32_t f = base.face_of_corner(c), n = base.size_of_face(f), i = c - base.face_begin(f);
                const uint32_t way = base.face_vertices[c] == base.edge_vertices[2 * e] ? 0 : 1;
                // The half that begins at the edge's first vertex is the corner's own if the face runs that way.
                const uint32_t quad = n == own ? 0 : half == way ? i : (i + 1) % n;
                if (is_drawn(table, rates, first_ptex[f] + quad)) ++ways[way];
            }
            add(e, make_uses(ways[0], ways[1]));
        }
    }
    for (uint32_t f = 0; f < base.face_count; ++f) {
        const uint32_t n = base.size_of_face(f);
        for (uint32_t j = 0; n != own && j < n; ++j)
            add(first_sub[f] + j, make_uses(is_drawn(table, rates, first_ptex[f] + j),
                                            is_drawn(table, rates, first_ptex[f] + (j + 1) % n)));
    }
    return expected;
}

/// Then two corners of a face are one vertex, and edges from both to a vertex inside are one edge.
bool has_edge_of_one_vertex(const ControlMesh& mesh) {
    const Topology base = build_topology(mesh);
    for (uint32_t e = 0; e < base.edge_count; ++e)
        if (base.edge_vertices[2 * e] == base.edge_vertices[2 * e + 1]) return true;
    return false;
}

bool all_rates_positive(std::span<const uint32_t> rates) {
    return std::find(rates.begin(), rates.end(), 0u) == rates.end();
}

/// Vertices - edges + faces of what is drawn. Dividing faces and edges does not change it.
int64_t euler_characteristic(const ControlMesh& mesh) {
    const Topology base = build_topology(mesh);
    std::vector<uint8_t> vertices(base.vertex_count, 0), edges(base.edge_count, 0);
    int64_t faces = 0;
    for (uint32_t f = 0; f < base.face_count; ++f) {
        if (base.face_holes[f] != 0) continue;
        ++faces;
        for (const uint32_t v : base.vertices_of_face(f)) vertices[v] = 1;
        for (const uint32_t e : base.edges_of_face(f)) edges[e] = 1;
    }
    return std::count(vertices.begin(), vertices.end(), 1) - std::count(edges.begin(), edges.end(), 1) + faces;
}

/// Of each ptex face: its triangles.
std::vector<std::vector<uint32_t>> triangles_of_faces(const TessellationTable& table, const Tessellation& t) {
    std::vector<std::vector<uint32_t>> triangles(table.face_count);
    for (uint32_t i = 0; i < t.triangle_faces.size(); ++i) triangles[t.triangle_faces[i]].push_back(i);
    return triangles;
}

uint32_t expected_triangles(const TessellationTable& table, std::span<const uint32_t> rates, TessellationSpacing spacing,
                            uint32_t f) {
    if (!is_drawn(table, rates, f)) return 0;
    const uint32_t* words = table.faces.data() + size_t{f} * shared::kTessFaceWords;
    const bool triangle = table.options.scheme == Scheme::loop;
    uint32_t side[4] = {}, halves = 0;
    for (uint32_t k = 0; k < (triangle ? 3u : 4u); ++k) {
        side[k] = rates[table.rows[size_t{shared::side_row(words[k])} * shared::kTessRowWords]];
        if ((words[k] & shared::kSideHalves) != 0) halves |= 1u << k;
    }
    return shared::triangle_count(shared::make_pattern(triangle, static_cast<uint32_t>(spacing), side[0], side[1], side[2],
                                                       side[3], halves));
}

}  // namespace

std::vector<uint32_t> random_rates(const ControlMesh& mesh, const TessellationTable& table,
                                   TessellationSpacing spacing, uint32_t most, std::mt19937& random) {
    std::vector<uint32_t> rates(table.rate_edge_count);
    for (uint32_t& r : rates) {
        if (spacing == TessellationSpacing::fractional)
            r = static_cast<uint32_t>(2 * shared::kRateOne + random() % ((most - 1) * shared::kRateOne));
        else if (spacing == TessellationSpacing::power_of_two)
            r = shared::kRateOne << random() % 5;
        else
            r = static_cast<uint32_t>(1 + random() % most) * shared::kRateOne;
    }
    const Topology base = build_topology(mesh);
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> first;
    for (uint32_t e = 0; e < base.edge_count; ++e) {
        const uint32_t a = base.edge_vertices[2 * e], b = base.edge_vertices[2 * e + 1];
        const auto [at, is_new] = first.try_emplace({std::min(a, b), std::max(a, b)}, e);
        const uint32_t few = (spacing == TessellationSpacing::power_of_two ? 4 : 3) * shared::kRateOne;
        if (a == b || !is_new)
            for (const uint32_t edge : {e, at->second}) rates[edge] = std::max(rates[edge], few);
    }
    return rates;
}

std::string find_tessellation_fault(const ControlMesh& mesh, const TessellationTable& table,
                                    std::span<const uint32_t> rates, TessellationSpacing spacing,
                                    const Tessellation& t) {
    if (t.indices.size() != 3 * t.triangle_faces.size()) return "triangles and their faces do not agree";
    std::map<std::pair<uint32_t, uint32_t>, Uses> edges;  // of the lower vertex first: this way, that way
    std::vector<uint8_t> used(t.places.size(), 0);
    for (size_t i = 0; i < t.indices.size(); i += 3) {
        for (size_t c = 0; c < 3; ++c) {
            if (t.indices[i + c] >= t.vertex_count()) return "an index is out of range";
            used[t.indices[i + c]] = 1;
            const uint32_t a = t.position_sources[t.indices[i + c]];
            const uint32_t b = t.position_sources[t.indices[i + (c + 1) % 3]];
            Uses& uses = edges[{std::min(a, b), std::max(a, b)}];
            ++(a < b ? uses.first : uses.second);
        }
    }
    auto missing = expected_uses(mesh, table, rates, spacing);
    const bool balance_is_enough = has_edge_of_one_vertex(mesh);
    for (const auto& [edge, uses] : edges) {
        const Uses sorted = make_uses(uses.first, uses.second);
        if (sorted == Uses{1, 1} || (balance_is_enough && uses.first == uses.second)) continue;
        const auto at = missing.find(sorted);
        if (at == missing.end() || at->second == 0)
            return "edge " + std::to_string(edge.first) + "-" + std::to_string(edge.second) + " has " +
                   std::to_string(uses.first) + " triangles one way and " + std::to_string(uses.second) + " the other";
        --at->second;
    }
    for (const auto& [uses, count] : missing)
        if (count != 0 && !(balance_is_enough && uses.first == uses.second))
            return "segments of the control mesh's edges are missing";
    const auto triangles = triangles_of_faces(table, t);
    for (uint32_t f = 0; f < table.face_count; ++f)
        if (triangles[f].size() != expected_triangles(table, rates, spacing, f))
            return "face " + std::to_string(f) + " has " + std::to_string(triangles[f].size()) + " triangles";
    bool all_drawn = true;
    for (uint32_t f = 0; f < table.face_count; ++f) all_drawn &= is_drawn(table, rates, f);
    std::vector<uint8_t> points(t.places.size(), 0);
    for (const uint32_t index : t.indices) points[t.position_sources[index]] = 1;
    const int64_t euler = std::count(points.begin(), points.end(), 1) - static_cast<int64_t>(edges.size()) +
                          static_cast<int64_t>(t.triangle_faces.size());
    if (all_rates_positive(rates) && !balance_is_enough && euler != euler_characteristic(mesh))
        return "the Euler characteristic is not the control mesh's";
    if (all_drawn && std::find(used.begin(), used.end(), 0) != used.end()) return "a vertex is in no triangle";
    return "";
}

double largest_channel_fault(const PatchTable& channel, const TessellationTable& table, std::span<const uint32_t> rates,
                             const Tessellation& t, std::span<const double> points, std::span<const double> values) {
    const bool triangle = table.options.scheme == Scheme::loop;
    const auto triangles = triangles_of_faces(table, t);
    double worst = 0;
    for (uint32_t f = 0; f < table.face_count; ++f) {
        if (!is_drawn(table, rates, f)) continue;
        const uint32_t* words = table.faces.data() + size_t{f} * shared::kTessFaceWords;
        std::vector<uint32_t> in_use;
        for (const uint32_t i : triangles[f]) in_use.insert(in_use.end(), &t.indices[3 * i], &t.indices[3 * i] + 3);
        for (uint32_t k = 0; k < (triangle ? 3u : 4u); ++k) {
            const uint32_t vertex = words[4 + k];
            if (std::find(in_use.begin(), in_use.end(), vertex) == in_use.end()) return INFINITY;
            PatchSample s = {f, 0, 0};
            shared::locate_on_side(triangle, k, 0, s.u, s.v);
            double expected[2];
            SampleStatus status;
            evaluate_patches(channel, {&s, 1}, points, 2, Derivatives::none, expected, {&status, 1});
            for (size_t i = 0; i < 2; ++i)
                worst = std::max(worst, std::abs(expected[i] - values[2 * size_t{vertex} + i]));
        }
        // Rows: next to each side, a vertex within it is where the face says.
        for (uint32_t k = 0; k < (triangle ? 3u : 4u); ++k) {
            const uint32_t row = shared::side_row(words[k]);
            const uint32_t* row_words = table.rows.data() + size_t{row} * shared::kTessRowWords;
            if (rates[row_words[0]] < 2 * shared::kRateOne || (words[k] & shared::kSideHalves) != 0) continue;
            const double t_face = 1.0 / (rates[row_words[0]] / shared::kRateOne);
            PatchSample s = {f, 0, 0}, own = {row_words[1], 0, 0};
            shared::locate_on_side(triangle, k, (words[k] & shared::kSideReversed) != 0 ? 1 - t_face : t_face, s.u, s.v);
            shared::locate_on_row(row_words[2], t_face, own.u, own.v);
            double here[2], there[2];
            SampleStatus status;
            evaluate_patches(channel, {&s, 1}, points, 2, Derivatives::none, here, {&status, 1});
            evaluate_patches(channel, {&own, 1}, points, 2, Derivatives::none, there, {&status, 1});
            for (size_t i = 0; i < 2; ++i) worst = std::max(worst, std::abs(here[i] - there[i]));
        }
    }
    return worst;
}

}  // namespace limn::test
