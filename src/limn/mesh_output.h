// A mesh on its way to a file: what the OBJ and PLY writers take.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "limn/result.h"

namespace limn {

/// Arrays that the caller keeps alive while a writer runs. Corner c of face f is entry offset(f) + c of the
/// per-corner arrays, offset(f) = f * face_size, or the sum of face_sizes before f.
struct MeshOutput {
    std::span<const float> positions;  ///< x y z, 3 per vertex
    std::span<const float> normals;    ///< 3 per vertex, or empty
    /// u v, 2 per value, or empty. Without face_texture_coordinates there is one value per vertex.
    std::span<const float> texture_coordinates;
    std::span<const uint32_t> face_texture_coordinates;  ///< one value index per corner, or empty
    uint32_t face_size = 0;                              ///< vertices of every face, or 0: see face_sizes
    std::span<const uint32_t> face_sizes;                ///< one per face when face_size is 0, else empty
    std::span<const uint32_t> face_vertices;             ///< one vertex index per corner
    std::span<const uint8_t> face_skip;                  ///< empty, or one per face: 1 leaves the face out

    size_t vertex_count() const { return positions.size() / 3; }
    size_t face_count() const {
        return face_size == 0 ? face_sizes.size() : face_vertices.size() / face_size;
    }
    uint32_t size_of_face(size_t face) const { return face_size == 0 ? face_sizes[face] : face_size; }
    bool skips(size_t face) const { return !face_skip.empty() && face_skip[face] != 0; }
};

namespace detail {

inline Error mesh_output_error(ErrorCode code, std::string message) {
    return {code, std::move(message)};
}

/// Every entry of `indices` is less than `count`; skipped faces are no exception.
inline Result<void> check_indices(std::span<const uint32_t> indices, size_t count, const char* name) {
    const auto largest = std::max_element(indices.begin(), indices.end());
    if (largest == indices.end() || *largest < count) return {};
    const auto at = static_cast<size_t>(largest - indices.begin());
    Error error =
        mesh_output_error(ErrorCode::index_out_of_range, std::string(name) + "[" + std::to_string(at) +
                                                             "] is " + std::to_string(*largest) +
                                                             ", but there are " + std::to_string(count));
    error.element = at;
    return error;
}

}  // namespace detail

/// Whether the arrays of `mesh` agree. Errors: invalid_argument (lengths), index_out_of_range (Error::element
/// is the corner), too_large (more than 2^31 - 1 vertices or texture coordinates). Linear in the corners.
inline Result<void> check_mesh_output(const MeshOutput& mesh) {
    const auto invalid = [](const char* cause) {
        return detail::mesh_output_error(ErrorCode::invalid_argument, cause);
    };
    if (mesh.positions.size() % 3 != 0) return invalid("positions are not 3 per vertex");
    if (!mesh.normals.empty() && mesh.normals.size() != mesh.positions.size())
        return invalid("normals are not 3 per vertex");
    if (mesh.texture_coordinates.size() % 2 != 0) return invalid("texture coordinates are not 2 per value");
    const size_t value_count = mesh.texture_coordinates.size() / 2;
    if (mesh.face_texture_coordinates.empty() && value_count != 0 && value_count != mesh.vertex_count())
        return invalid("texture coordinates are neither indexed nor one per vertex");
    if (!mesh.face_texture_coordinates.empty() &&
        mesh.face_texture_coordinates.size() != mesh.face_vertices.size())
        return invalid("face_texture_coordinates are not one per face corner");
    if (std::max(mesh.vertex_count(), value_count) > 0x7fffffff)
        return detail::mesh_output_error(ErrorCode::too_large, "more than 2^31 - 1 vertices");

    uint64_t corner_count = 0;
    if (mesh.face_size == 0) {
        for (const uint32_t size : mesh.face_sizes) corner_count += size;
    } else {
        if (!mesh.face_sizes.empty()) return invalid("both face_size and face_sizes are given");
        corner_count = uint64_t{mesh.face_size} * mesh.face_count();
    }
    if (corner_count != mesh.face_vertices.size()) return invalid("face_vertices do not fill the faces");
    if (!mesh.face_skip.empty() && mesh.face_skip.size() != mesh.face_count())
        return invalid("face_skip is not one per face");

    if (auto checked = detail::check_indices(mesh.face_vertices, mesh.vertex_count(), "face_vertices");
        !checked)
        return checked;
    return detail::check_indices(mesh.face_texture_coordinates, value_count, "face_texture_coordinates");
}

}  // namespace limn
