#include "limn/ply.h"

#include <algorithm>
#include <bit>

#include "limn/file.h"

namespace limn {
namespace {

char* put_u32(char* to, uint32_t value) {
    for (int i = 0; i < 4; ++i) *to++ = static_cast<char>(value >> (8 * i) & 0xff);
    return to;
}

char* put_float(char* to, float value) {
    return put_u32(to, std::bit_cast<uint32_t>(value));
}

char* put_length(char* to, size_t length, bool wide) {
    if (wide) return put_u32(to, static_cast<uint32_t>(length));
    *to++ = static_cast<char>(length);
    return to;
}

/// What the header announces and the records follow.
struct PlyLayout {
    bool normals = false;
    bool vertex_texture = false;
    bool face_texture = false;
    bool wide_lists = false;
    size_t face_count = 0;  // less the skipped ones
};

PlyLayout ply_layout(const MeshOutput& mesh) {
    PlyLayout layout;
    layout.normals = !mesh.normals.empty();
    layout.face_texture = !mesh.face_texture_coordinates.empty();
    layout.vertex_texture = !mesh.texture_coordinates.empty() && !layout.face_texture;
    uint64_t longest = 0;
    for (size_t face = 0; face < mesh.face_count(); ++face) {
        if (mesh.skips(face)) continue;
        ++layout.face_count;
        longest = std::max(longest, uint64_t{mesh.size_of_face(face)} * (layout.face_texture ? 2 : 1));
    }
    layout.wide_lists = longest > 255;
    return layout;
}

std::string ply_header(const PlyLayout& layout, size_t vertex_count) {
    const std::string list = layout.wide_lists ? "property list uint " : "property list uchar ";
    std::string text = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                       std::to_string(vertex_count) +
                       "\nproperty float x\nproperty float y\nproperty float z\n";
    if (layout.normals) text += "property float nx\nproperty float ny\nproperty float nz\n";
    if (layout.vertex_texture) text += "property float s\nproperty float t\n";
    text += "element face " + std::to_string(layout.face_count) + "\n" + list + "int vertex_indices\n";
    if (layout.face_texture) text += list + "float texcoord\n";
    return text + "end_header\n";
}

void write_vertices(FileWriter& writer, const MeshOutput& mesh, const PlyLayout& layout) {
    for (size_t vertex = 0; vertex < mesh.vertex_count(); ++vertex) {
        char* to = writer.room(32);
        for (size_t i = 0; i < 3; ++i) to = put_float(to, mesh.positions[3 * vertex + i]);
        for (size_t i = 0; i < 3 && layout.normals; ++i) to = put_float(to, mesh.normals[3 * vertex + i]);
        for (size_t i = 0; i < 2 && layout.vertex_texture; ++i)
            to = put_float(to, mesh.texture_coordinates[2 * vertex + i]);
        writer.advance(to);
    }
}

void write_face(FileWriter& writer, const MeshOutput& mesh, const PlyLayout& layout, size_t offset,
                size_t size) {
    writer.advance(put_length(writer.room(4), size, layout.wide_lists));
    for (size_t corner = offset; corner < offset + size; ++corner)
        writer.advance(put_u32(writer.room(4), mesh.face_vertices[corner]));
    if (!layout.face_texture) return;
    writer.advance(put_length(writer.room(4), 2 * size, layout.wide_lists));
    for (size_t corner = offset; corner < offset + size; ++corner) {
        const size_t value = mesh.face_texture_coordinates[corner];
        char* to = put_float(writer.room(8), mesh.texture_coordinates[2 * value]);
        writer.advance(put_float(to, mesh.texture_coordinates[2 * value + 1]));
    }
}

}  // namespace

Result<void> write_ply(const std::string& path, const MeshOutput& mesh) {
    if (auto checked = check_mesh_output(mesh); !checked) {
        Error error = checked.error();
        error.message = printable(path) + ": " + error.message;
        return error;
    }
    const PlyLayout layout = ply_layout(mesh);
    auto writer = FileWriter::create(path);
    if (!writer) return writer.error();
    writer->append(ply_header(layout, mesh.vertex_count()));
    write_vertices(*writer, mesh, layout);
    size_t offset = 0;
    for (size_t face = 0; face < mesh.face_count(); ++face) {
        const size_t size = mesh.size_of_face(face);
        if (!mesh.skips(face)) write_face(*writer, mesh, layout, offset, size);
        offset += size;
    }
    return writer->commit();
}

}  // namespace limn
