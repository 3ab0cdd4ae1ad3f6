#include "limn/schemes/corner_values.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace limn {
namespace {

/// Calls body(corner, the one before it, the next one) for all corners.
template <class Body>
void for_each_corner(const ControlMesh& mesh, const Body& body) {
    for (uint32_t f = 0; f < mesh.face_count(); ++f) {
        const uint32_t begin = mesh.face_offsets[f], end = mesh.face_offsets[f + 1];
        for (uint32_t c = begin; c < end; ++c) body(c, c == begin ? end - 1 : c - 1, c + 1 == end ? begin : c + 1);
    }
}

/// An edge as seen from `from`; one entry.
struct DirectedInterval {
    uint32_t from, to;
    float value;
    bool found = false;
};
bool comes_before(const DirectedInterval& a, const DirectedInterval& b) {
    return a.from != b.from ? a.from < b.from : a.to < b.to;
}

Error entry_error(ErrorCode code, size_t entry, const char* cause) {
    return Error{code, "knot interval " + std::to_string(entry) + " " + cause, entry};
}

}  // namespace

Result<std::vector<double>> corner_intervals(const ControlMesh& mesh, std::span<const uint32_t> edges,
                                             std::span<const float> values) {
    if (edges.size() / 2 != values.size() || edges.size() % 2 != 0)
        return Error{ErrorCode::invalid_argument, "knot intervals are not one for each edge"};
    std::vector<DirectedInterval> given;
    for (size_t i = 0; i < values.size(); ++i) {
        if (!(values[i] >= 0) || std::isinf(values[i]))
            return entry_error(ErrorCode::invalid_argument, i, "is negative or no number");
        given.push_back({edges[2 * i], edges[2 * i + 1], values[i]});
    }
    std::vector<DirectedInterval> sorted = given;
    std::stable_sort(sorted.begin(), sorted.end(), comes_before);
    /// The last entry of this direction, or null.
    auto find = [&](uint32_t from, uint32_t to) -> DirectedInterval* {
        auto end = std::upper_bound(sorted.begin(), sorted.end(), DirectedInterval{from, to, 0}, comes_before);
        if (end == sorted.begin()) return nullptr;
        --end;
        return end->from == from && end->to == to ? &*end : nullptr;
    };
    std::vector<double> out(mesh.face_vertices.size(), 1);
    for_each_corner(mesh, [&](uint32_t c, uint32_t, uint32_t next) {
        const uint32_t a = mesh.face_vertices[c], b = mesh.face_vertices[next];
        DirectedInterval *own = find(a, b), *other = find(b, a);
        if (own != nullptr || other != nullptr) out[c] = static_cast<double>((own != nullptr ? own : other)->value);
        if (own != nullptr) own->found = true;
        if (other != nullptr) other->found = true;
    });
    for (size_t i = 0; i < given.size(); ++i)
        if (!find(given[i].from, given[i].to)->found)
            return entry_error(ErrorCode::missing_edge, i, "is of vertices that no edge joins");
    return out;
}

Result<std::vector<double>> corner_angles(const ControlMesh& mesh, std::span<const float> positions) {
    if (positions.size() / 3 < mesh.vertex_count)
        return Error{ErrorCode::invalid_argument, "positions are not three for each vertex"};
    std::vector<double> out(mesh.face_vertices.size());
    for_each_corner(mesh, [&](uint32_t c, uint32_t previous, uint32_t next) {
        double dot = 0, length_a = 0, length_b = 0;
        for (size_t k = 0; k < 3; ++k) {
            auto at = [&](uint32_t corner) {
                return static_cast<double>(positions[3 * size_t{mesh.face_vertices[corner]} + k]);
            };
            const double a = at(next) - at(c), b = at(previous) - at(c);
            dot += a * b;
            length_a += a * a;
            length_b += b * b;
        }
        const double lengths = std::sqrt(length_a) * std::sqrt(length_b);
        out[c] = lengths == 0 ? 0 : std::acos(std::clamp(dot / lengths, -1.0, 1.0));
    });
    return out;
}

}  // namespace limn
