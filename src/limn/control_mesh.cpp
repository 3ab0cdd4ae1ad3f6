#include "limn/control_mesh.h"

#include <cmath>
#include <string>
#include <unordered_set>

namespace limn {
namespace {

constexpr uint64_t kMaxCount = 0x7fffffff;

Error fail(ErrorCode code, std::string message, uint64_t element = kNoElement) {
    return Error{code, std::move(message), element, 0};
}

std::string text(uint64_t n) {
    return std::to_string(n);
}

Result<void> check_faces(const ControlMeshDescription& d) {
    if (d.vertex_count > kMaxCount) return fail(ErrorCode::too_large, "more than 2^31 - 1 vertices");
    if (d.face_sizes.empty())
        return fail(ErrorCode::invalid_argument, "a control mesh needs at least one face");
    if (d.face_sizes.size() > kMaxCount) return fail(ErrorCode::too_large, "more than 2^31 - 1 faces");
    uint64_t corner = 0;
    for (size_t f = 0; f < d.face_sizes.size(); ++f) {
        const uint32_t size = d.face_sizes[f];
        if (size < 3)
            return fail(ErrorCode::face_too_small,
                        "face " + text(f) + " has " + text(size) + " vertices, needs 3", f);
        if (d.options.scheme == Scheme::loop && size != 3)
            return fail(ErrorCode::not_a_triangle,
                        "face " + text(f) + " has " + text(size) + " vertices; Loop takes triangles only", f);
        corner += size;
        if (corner > kMaxCount) return fail(ErrorCode::too_large, "more than 2^31 - 1 face corners", f);
        if (corner > d.face_vertices.size()) break;
        for (uint64_t c = corner - size; c < corner; ++c) {
            if (d.face_vertices[c] < d.vertex_count) continue;
            return fail(ErrorCode::index_out_of_range,
                        "face " + text(f) + " refers to vertex " + text(d.face_vertices[c]) + " of " +
                            text(d.vertex_count),
                        f);
        }
    }
    if (corner != d.face_vertices.size())
        return fail(ErrorCode::invalid_argument, "face sizes add up to " + text(corner) + " corners, " +
                                                     text(d.face_vertices.size()) + " are given");
    return {};
}

Result<void> check_positions(const ControlMeshDescription& d) {
    if (d.positions.empty()) return {};
    if (d.positions.size() != uint64_t{3} * d.vertex_count)
        return fail(ErrorCode::invalid_argument, text(d.positions.size()) + " coordinates for " +
                                                     text(d.vertex_count) + " vertices, 3 each are needed");
    for (size_t i = 0; i < d.positions.size(); ++i)
        if (!std::isfinite(d.positions[i]))
            return fail(ErrorCode::not_finite, "position of vertex " + text(i / 3) + " is not finite", i / 3);
    return {};
}

Result<void> check_sharpness(float sharpness, const char* kind, size_t i) {
    if (sharpness >= 0) return {};  // false for NaN
    return fail(ErrorCode::invalid_sharpness,
                "sharpness of " + std::string(kind) + " " + text(i) + " is negative or not a number", i);
}

uint64_t edge_key(uint32_t a, uint32_t b) {
    return a < b ? uint64_t{a} << 32 | b : uint64_t{b} << 32 | a;
}

/// Flattens crease chains to vertex pairs. `owner` receives the chain of each pair, for messages.
Result<void> collect_creases(const ControlMeshDescription& d, ControlMesh& mesh,
                             std::vector<uint32_t>& owner) {
    const size_t chains = d.crease_sizes.empty() ? d.crease_vertices.size() / 2 : d.crease_sizes.size();
    uint64_t total = 0;
    for (size_t i = 0; i < chains; ++i) total += d.crease_sizes.empty() ? 2 : d.crease_sizes[i];
    if (total != d.crease_vertices.size() || chains != d.crease_sharpness.size())
        return fail(ErrorCode::invalid_argument, "crease sizes, vertices and sharpness values do not agree");
    size_t first = 0;
    for (size_t i = 0; i < chains; ++i) {
        const size_t size = d.crease_sizes.empty() ? 2 : d.crease_sizes[i];
        if (size < 2)
            return fail(ErrorCode::invalid_argument, "crease " + text(i) + " has fewer than 2 vertices", i);
        if (auto ok = check_sharpness(d.crease_sharpness[i], "crease", i); !ok) return ok;
        for (size_t k = 0; k < size; ++k) {
            const uint32_t v = d.crease_vertices[first + k];
            if (v >= d.vertex_count)
                return fail(
                    ErrorCode::index_out_of_range,
                    "crease " + text(i) + " refers to vertex " + text(v) + " of " + text(d.vertex_count), i);
            if (k == 0) continue;
            mesh.crease_edges.push_back(d.crease_vertices[first + k - 1]);
            mesh.crease_edges.push_back(v);
            mesh.crease_sharpness.push_back(d.crease_sharpness[i]);
            owner.push_back(static_cast<uint32_t>(i));
        }
        first += size;
    }
    return {};
}

/// Every crease must follow an edge. Only edges between vertices that carry creases are looked up.
Result<void> check_crease_edges(const ControlMesh& mesh, const std::vector<uint32_t>& owner) {
    if (mesh.crease_edges.empty()) return {};
    std::unordered_set<uint64_t> missing;
    std::vector<bool> creased(mesh.vertex_count);
    for (size_t i = 0; i < mesh.crease_sharpness.size(); ++i) {
        const uint32_t a = mesh.crease_edges[2 * i], b = mesh.crease_edges[2 * i + 1];
        missing.insert(edge_key(a, b));
        creased[a] = creased[b] = true;
    }
    for (uint32_t f = 0; f < mesh.face_count(); ++f) {
        const uint32_t begin = mesh.face_offsets[f], end = mesh.face_offsets[f + 1];
        for (uint32_t c = begin; c < end; ++c) {
            const uint32_t a = mesh.face_vertices[c], b = mesh.face_vertices[c + 1 == end ? begin : c + 1];
            if (creased[a] && creased[b]) missing.erase(edge_key(a, b));
        }
    }
    for (size_t i = 0; !missing.empty() && i < mesh.crease_sharpness.size(); ++i) {
        const uint32_t a = mesh.crease_edges[2 * i], b = mesh.crease_edges[2 * i + 1];
        if (missing.count(edge_key(a, b)) == 0) continue;
        return fail(
            ErrorCode::missing_edge,
            "crease " + text(owner[i]) + ": no face has an edge from vertex " + text(a) + " to " + text(b),
            owner[i]);
    }
    return {};
}

Result<void> collect_corners(const ControlMeshDescription& d, ControlMesh& mesh) {
    if (d.corner_vertices.size() != d.corner_sharpness.size())
        return fail(ErrorCode::invalid_argument, "corner vertices and sharpness values differ in number");
    for (size_t i = 0; i < d.corner_vertices.size(); ++i) {
        if (d.corner_vertices[i] >= d.vertex_count)
            return fail(ErrorCode::index_out_of_range,
                        "corner " + text(i) + " refers to vertex " + text(d.corner_vertices[i]) + " of " +
                            text(d.vertex_count),
                        i);
        if (auto ok = check_sharpness(d.corner_sharpness[i], "corner", i); !ok) return ok;
    }
    mesh.corner_vertices.assign(d.corner_vertices.begin(), d.corner_vertices.end());
    mesh.corner_sharpness.assign(d.corner_sharpness.begin(), d.corner_sharpness.end());
    return {};
}

Result<void> collect_channels(const ControlMeshDescription& d, ControlMesh& mesh) {
    for (size_t k = 0; k < d.channels.size(); ++k) {
        const FaceVaryingDescription& channel = d.channels[k];
        if (channel.face_values.size() != d.face_vertices.size())
            return fail(ErrorCode::invalid_argument,
                        "face-varying channel " + text(k) + " has " + text(channel.face_values.size()) +
                            " values for " + text(d.face_vertices.size()) + " face corners",
                        k);
        if (channel.value_count > kMaxCount)
            return fail(ErrorCode::too_large, "more than 2^31 - 1 face-varying values", k);
        for (const uint32_t value : channel.face_values) {
            if (value < channel.value_count) continue;
            return fail(ErrorCode::index_out_of_range,
                        "face-varying channel " + text(k) + " refers to value " + text(value) + " of " +
                            text(channel.value_count),
                        k);
        }
        mesh.channels.push_back({channel.value_count,
                                 {channel.face_values.begin(), channel.face_values.end()},
                                 channel.interpolation});
    }
    return {};
}

/// Clockwise to counter-clockwise: the first corner stays, the others are reversed.
void reverse_faces(const std::vector<uint32_t>& face_offsets, std::vector<uint32_t>& corners) {
    for (size_t f = 0; f + 1 < face_offsets.size(); ++f)
        for (uint32_t a = face_offsets[f] + 1, b = face_offsets[f + 1] - 1; a < b; ++a, --b)
            std::swap(corners[a], corners[b]);
}

}  // namespace

Result<ControlMesh> ControlMesh::create(const ControlMeshDescription& d) {
    if (auto ok = check_faces(d); !ok) return ok.error();
    if (auto ok = check_positions(d); !ok) return ok.error();
    ControlMesh mesh;
    mesh.options = d.options;
    mesh.vertex_count = d.vertex_count;
    mesh.face_vertices.assign(d.face_vertices.begin(), d.face_vertices.end());
    mesh.face_offsets.reserve(d.face_sizes.size() + 1);
    mesh.face_offsets.push_back(0);
    for (const uint32_t size : d.face_sizes) mesh.face_offsets.push_back(mesh.face_offsets.back() + size);

    std::vector<uint32_t> crease_owner;
    if (auto ok = collect_creases(d, mesh, crease_owner); !ok) return ok.error();
    if (auto ok = check_crease_edges(mesh, crease_owner); !ok) return ok.error();
    if (auto ok = collect_corners(d, mesh); !ok) return ok.error();
    for (size_t i = 0; i < d.holes.size(); ++i)
        if (d.holes[i] >= mesh.face_count())
            return fail(
                ErrorCode::index_out_of_range,
                "hole " + text(i) + " refers to face " + text(d.holes[i]) + " of " + text(mesh.face_count()),
                i);
    mesh.holes.assign(d.holes.begin(), d.holes.end());
    if (auto ok = collect_channels(d, mesh); !ok) return ok.error();
    if (d.left_handed) {
        reverse_faces(mesh.face_offsets, mesh.face_vertices);
        for (Channel& channel : mesh.channels) reverse_faces(mesh.face_offsets, channel.face_values);
    }
    return mesh;
}

}  // namespace limn
