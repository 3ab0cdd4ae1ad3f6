// Writing OBJ files.
#include <charconv>
#include <span>

#include "limn/file.h"
#include "limn/obj.h"

namespace limn {
namespace {

constexpr size_t kNumberBytes = 24;  // more than the longest float or uint32_t and a separator

char* put_number(char* to, float value) {
    return std::to_chars(to, to + kNumberBytes, value).ptr;
}
char* put_number(char* to, uint32_t value) {
    return std::to_chars(to, to + kNumberBytes, value).ptr;
}

void write_floats(FileWriter& writer, std::string_view keyword, std::span<const float> values,
                  size_t per_line) {
    for (size_t i = 0; i + per_line <= values.size(); i += per_line) {
        char* to = writer.room(8 + per_line * kNumberBytes);
        to = std::copy(keyword.begin(), keyword.end(), to);
        for (size_t j = 0; j < per_line; ++j) {
            *to++ = ' ';
            to = put_number(to, values[i + j]);
        }
        *to++ = '\n';
        writer.advance(to);
    }
}

/// ` i`, ` i/j`, ` i//k` or ` i/j/k`.
char* put_corner(char* to, const MeshOutput& mesh, size_t corner) {
    const uint32_t vertex = mesh.face_vertices[corner] + 1;
    *to++ = ' ';
    to = put_number(to, vertex);
    if (!mesh.texture_coordinates.empty()) {
        *to++ = '/';
        const bool indexed = !mesh.face_texture_coordinates.empty();
        to = put_number(to, indexed ? mesh.face_texture_coordinates[corner] + 1 : vertex);
    }
    if (mesh.normals.empty()) return to;
    *to++ = '/';
    if (mesh.texture_coordinates.empty()) *to++ = '/';
    return put_number(to, vertex);
}

void write_faces(FileWriter& writer, const MeshOutput& mesh) {
    size_t corner = 0;
    for (size_t face = 0; face < mesh.face_count(); ++face) {
        const size_t end = corner + mesh.size_of_face(face);
        if (mesh.skips(face)) {
            corner = end;
            continue;
        }
        writer.append("f");
        for (; corner < end; ++corner)
            writer.advance(put_corner(writer.room(4 * kNumberBytes), mesh, corner));
        writer.append("\n");
    }
}

}  // namespace

Result<void> write_obj(const std::string& path, const MeshOutput& mesh) {
    if (auto checked = check_mesh_output(mesh); !checked) {
        Error error = checked.error();
        error.message = printable(path) + ": " + error.message;
        return error;
    }
    auto writer = FileWriter::create(path);
    if (!writer) return writer.error();
    write_floats(*writer, "v", mesh.positions, 3);
    write_floats(*writer, "vt", mesh.texture_coordinates, 2);
    write_floats(*writer, "vn", mesh.normals, 3);
    write_faces(*writer, mesh);
    return writer->commit();
}

}  // namespace limn
