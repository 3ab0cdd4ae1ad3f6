// The control mesh: what the caller models, checked once.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "limn/result.h"
#include "limn/scheme.h"

namespace limn {

/// One face-varying channel (a texture coordinate set, say) as the caller has it.
struct FaceVaryingDescription {
    uint32_t value_count = 0;
    /// One value index per face corner, in the order of `face_vertices`; each < value_count.
    std::span<const uint32_t> face_values;
    FaceVaryingInterpolation interpolation = FaceVaryingInterpolation::all;
};

/// A control mesh as the caller has it. The spans are read during ControlMesh::create only.
/// Accepted, with the surface that OpenSubdiv gives them: faces of any size >= 3, boundaries, edges of more
/// than two faces, vertices whose faces do not form one fan, degenerate edges, vertices that no face uses.
struct ControlMeshDescription {
    SchemeOptions options;
    uint32_t vertex_count = 0;
    std::span<const uint32_t> face_sizes;     ///< vertices of each face, >= 3 (Loop: exactly 3)
    std::span<const uint32_t> face_vertices;  ///< sum(face_sizes) indices, faces one after the other
    /// Creases: chains of vertices, each along existing edges. `crease_sizes` holds the vertices of each
    /// chain (>= 2); left empty, every chain is a pair. A later crease on the same edge replaces an earlier
    /// one.
    std::span<const uint32_t> crease_sizes;
    std::span<const uint32_t> crease_vertices;
    std::span<const float>
        crease_sharpness;  ///< one per chain, >= 0; kInfiniteSharpness and above is infinite
    std::span<const uint32_t> corner_vertices;
    std::span<const float> corner_sharpness;  ///< one per corner vertex
    std::span<const uint32_t> holes;          ///< faces that take part in refinement but not in the surface
    std::span<const FaceVaryingDescription> channels;
    /// Optional: 3 * vertex_count coordinates, checked to be finite. Not kept.
    std::span<const float> positions;
    bool left_handed = false;  ///< faces are clockwise; they are reversed, keeping each first vertex first
};

/// A validated control mesh. Plain arrays; treat as immutable. Corner c of face f is entry face_offsets[f] +
/// c.
struct ControlMesh {
    /// Checks the description and copies it. Errors: index_out_of_range, face_too_small, not_a_triangle
    /// (Loop), invalid_sharpness, missing_edge, not_finite, too_large (counts past 2^31 - 1 or products that
    /// overflow), invalid_argument (array lengths that disagree, no faces). Error::element is the face,
    /// crease, corner, hole or vertex that the message names.
    static Result<ControlMesh> create(const ControlMeshDescription& description);

    struct Channel {
        uint32_t value_count = 0;
        std::vector<uint32_t> face_values;  ///< face_vertices.size() entries
        FaceVaryingInterpolation interpolation = FaceVaryingInterpolation::all;
    };

    SchemeOptions options;
    uint32_t vertex_count = 0;
    std::vector<uint32_t> face_offsets;   ///< face_count() + 1 entries
    std::vector<uint32_t> face_vertices;  ///< face_offsets.back() entries, counter-clockwise
    std::vector<uint32_t> crease_edges;   ///< vertex pairs, 2 per sharp edge
    std::vector<float> crease_sharpness;  ///< one per sharp edge
    std::vector<uint32_t> corner_vertices;
    std::vector<float> corner_sharpness;  ///< one per corner vertex
    std::vector<uint32_t> holes;
    std::vector<Channel> channels;

    uint32_t face_count() const { return static_cast<uint32_t>(face_offsets.size()) - 1; }
};

}  // namespace limn
