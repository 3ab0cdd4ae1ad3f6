// OBJ files, with the tag lines of OpenSubdiv.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "limn/control_mesh.h"
#include "limn/mesh_output.h"
#include "limn/result.h"
#include "limn/scheme.h"

namespace limn {

/// A model file as arrays that a ControlMeshDescription can refer to. Every index is within its range.
struct Model {
    std::vector<float> positions;         ///< x y z, 3 per vertex, finite
    std::vector<uint32_t> face_sizes;     ///< >= 3 each
    std::vector<uint32_t> face_vertices;  ///< sum(face_sizes) vertices, faces one after the other

    std::vector<float>
        texture_coordinates;  ///< u v, 2 per `vt` line (v is 0 where the line has none), finite
    /// One value index per corner, as face_vertices, when every corner of the file has one; else empty.
    std::vector<uint32_t> face_texture_coordinates;

    std::vector<uint32_t> crease_sizes;     ///< vertices of each chain, >= 2
    std::vector<uint32_t> crease_vertices;  ///< sum(crease_sizes) vertices
    std::vector<float> crease_sharpness;    ///< one per chain, >= 0, may be infinite
    std::vector<uint32_t> corner_vertices;
    std::vector<float> corner_sharpness;  ///< one per corner vertex, >= 0, may be infinite
    std::vector<uint32_t> holes;          ///< faces

    std::vector<uint32_t> interval_edges;  ///< pairs of vertices
    std::vector<float> intervals;          ///< one per pair, finite, >= 0: corner_intervals() takes both

    /// What the tags say about the surface; the last tag of a kind counts.
    std::optional<BoundaryInterpolation> boundary;
    std::optional<FaceVaryingInterpolation> face_varying;
    std::optional<CreasingMethod> creasing;
    std::optional<TriangleSubdivision> triangles;

    FaceVaryingDescription channel;  ///< storage of describe()

    size_t vertex_count() const { return positions.size() / 3; }
    size_t face_count() const { return face_sizes.size(); }
};

/// A description that refers to `model`: valid until the model is changed, moved or destroyed. Options are
/// `defaults` where no tag says otherwise. Texture coordinates are a channel where every corner has one.
ControlMeshDescription describe(Model& model, const SchemeOptions& defaults = {});

/// Reads an OBJ file. Linear in the size of the file; does not depend on the locale.
/// - `v`: 3 numbers; more (w, a colour) are checked and dropped.
/// - `vt`: 1 to 3 numbers, the third dropped. `vn`: 3 numbers, dropped; NaN is let pass there.
/// - `f`: corners `i`, `i/j`, `i//k` or `i/j/k`; nothing after a slash is the same as no slash. Indices
///   count from 1, or back from the last element so far where negative, and may refer to later ones.
/// - `t crease N/M/0`: N >= 2 vertices, an edge or the chain along them; M sharpness values, 1 or N - 1.
/// - `t interval N/M/0`: the same with knot intervals of non-uniform schemes; not a tag of OpenSubdiv.
/// - `t corner N/M/0`: N vertices; M sharpness values, 1 or N.
/// - `t hole N/0/0`: N faces.
/// - `t interpolateboundary 1/0/0`: 0 none, 1 edge and corner, 2 edge only.
/// - `t facevaryinginterpolateboundary 1/0/0`: 0 to 5, in the order of FaceVaryingInterpolation.
/// - `t creasemethod 0/0/1`: normal or chaikin. `t smoothtriangles 0/0/1`: catmark or smooth.
///
/// Indices in tags count from 0. Other tags and keywords (points, lines, groups, materials ...) are ignored,
/// and so is what follows a `#`. A `\` before a line end continues the line. Lines end in LF or CR LF.
///
/// Errors: cannot_open and out_of_memory as read_file(); parse_error, not_finite, index_out_of_range,
/// face_too_small, invalid_sharpness, invalid_argument (an interval), too_large (more than 2^31 - 1 of anything). Except for the first two,
/// Error::element is the line, counted from 1, and Error::message is one line, `PATH:LINE: cause`.
Result<Model> read_obj(const std::string& path);

/// The same for text that is at hand; `name` stands for the path in messages.
Result<Model> parse_obj(std::string_view text, const std::string& name);

/// Writes v, vt, vn and f lines with floats that read back to the same bits. Memory use is constant.
/// Errors: as check_mesh_output(), cannot_open, out_of_memory, on one line, `PATH: cause`; the file is then
/// as it was.
Result<void> write_obj(const std::string& path, const MeshOutput& mesh);

}  // namespace limn
