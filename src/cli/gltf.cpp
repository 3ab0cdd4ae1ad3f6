#include "cli/gltf.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <ostream>
#include <streambuf>
#include <vector>

#include "limn/file.h"

namespace limn::cli {
namespace {

constexpr uint64_t kMaxFileBytes = 0xffffffff;  // the header's length field has 32 bits
constexpr uint64_t kFrameBytes = 8192;          // more than the headers and the JSON take

Error too_large() {
    return {ErrorCode::too_large, "takes more than the 2^32 - 1 bytes that a .glb file can hold"};
}

Error not_finite(const char* what, size_t element) {
    return {ErrorCode::not_finite, std::string(what) + " " + std::to_string(element) + " is not finite",
            element};
}

/// Numbers the pairs of vertex and texture coordinate in order of first use; a hash table.
class VertexPairs {
  public:
    uint32_t find_or_insert(uint32_t vertex, uint32_t value) {
        if (2 * vertices_.size() >= slots_.size()) grow();
        uint32_t& slot = slot_of(vertex, value);
        if (slot == kEmpty) {
            slot = static_cast<uint32_t>(vertices_.size());
            vertices_.push_back(vertex);
            values_.push_back(value);
        }
        return slot;
    }
    std::vector<uint32_t> take_vertices() { return std::move(vertices_); }
    std::vector<uint32_t> take_values() { return std::move(values_); }

  private:
    static constexpr uint32_t kEmpty = ~uint32_t{0};

    /// Where the pair is, or has its place.
    uint32_t& slot_of(uint32_t vertex, uint32_t value) {
        const uint64_t key = uint64_t{value} << 32 | vertex;
        size_t at = (key * 0x9e3779b97f4a7c15u) >> 32;  // the upper half depends on all of the key
        for (;; ++at) {
            uint32_t& slot = slots_[at & (slots_.size() - 1)];
            if (slot == kEmpty || (vertices_[slot] == vertex && values_[slot] == value)) return slot;
        }
    }
    void grow() {
        slots_.assign(std::max<size_t>(1024, 2 * slots_.size()), kEmpty);
        for (size_t pair = 0; pair < vertices_.size(); ++pair)
            slot_of(vertices_[pair], values_[pair]) = static_cast<uint32_t>(pair);
    }

    std::vector<uint32_t> slots_;  // a power of two of them, at most half of them in use
    std::vector<uint32_t> vertices_, values_;
};

/// What is left of the faces, and the vertices that they refer to.
struct Triangles {
    std::vector<uint32_t> indices;  // 3 per triangle
    size_t vertex_count = 0;
    // The vertex and the texture coordinate of `mesh` that each is made of; empty: the one of its own number.
    std::vector<uint32_t> vertices, values;
};

uint64_t count_triangles(const MeshOutput& mesh) {
    uint64_t count = 0;
    for (size_t face = 0; face < mesh.face_count(); ++face)
        if (!mesh.skips(face)) count += std::max(2u, mesh.size_of_face(face)) - 2;
    return count;
}

/// Precondition: `triangle_count` triangles fit a file, so that their corners and vertices fit 32 bits.
Triangles triangulate(const MeshOutput& mesh, uint64_t triangle_count) {
    Triangles out;
    out.indices.reserve(3 * triangle_count);
    const bool split = !mesh.face_texture_coordinates.empty();
    VertexPairs pairs;
    const auto vertex_at = [&](size_t corner) {
        const uint32_t vertex = mesh.face_vertices[corner];
        return split ? pairs.find_or_insert(vertex, mesh.face_texture_coordinates[corner]) : vertex;
    };
    size_t offset = 0;
    for (size_t face = 0; face < mesh.face_count(); ++face) {
        const size_t end = offset + mesh.size_of_face(face);
        if (!mesh.skips(face) && end - offset >= 3) {
            const uint32_t first = vertex_at(offset);
            uint32_t previous = vertex_at(offset + 1);
            for (size_t corner = offset + 2; corner < end; ++corner) {
                const uint32_t next = vertex_at(corner);
                out.indices.insert(out.indices.end(), {first, previous, next});
                previous = next;
            }
        }
        offset = end;
    }
    out.vertices = pairs.take_vertices();
    out.values = pairs.take_values();
    out.vertex_count = split ? out.vertices.size() : mesh.vertex_count();
    return out;
}

// The binary chunk: one buffer, a view and an accessor for each array.

unsigned char* put_u32(unsigned char* to, uint32_t value) {
    for (int i = 0; i < 4; ++i) *to++ = static_cast<unsigned char>(value >> (8 * i) & 0xff);
    return to;
}

/// Adds `count` elements of `components` 4-byte values, a multiple of 4 bytes from the start as glTF wants.
/// Returns where to put them; the last accessor is theirs.
unsigned char* append_array(tinygltf::Model& model, size_t count, int components, int component_type,
                            int type, int target) {
    std::vector<unsigned char>& data = model.buffers[0].data;
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = data.size();
    view.byteLength = count * static_cast<size_t>(components) * 4;
    view.target = target;
    tinygltf::Accessor accessor;
    accessor.bufferView = static_cast<int>(model.bufferViews.size());
    accessor.componentType = component_type;
    accessor.type = type;
    accessor.count = count;
    data.resize(data.size() + view.byteLength);
    model.bufferViews.push_back(view);
    model.accessors.push_back(accessor);
    return data.data() + view.byteOffset;
}

int last_accessor(const tinygltf::Model& model) {
    return static_cast<int>(model.accessors.size()) - 1;
}

int append_indices(tinygltf::Model& model, const std::vector<uint32_t>& indices) {
    unsigned char* to = append_array(model, indices.size(), 1, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT,
                                     TINYGLTF_TYPE_SCALAR, TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
    for (const uint32_t index : indices) to = put_u32(to, index);
    return last_accessor(model);
}

/// An array of `mesh`: which elements are written is said by `picked`, empty for all in order.
struct Attribute {
    const char* semantic;  // for glTF
    const char* name;      // for people
    std::span<const float> values;
    const std::vector<uint32_t>& picked;
    int components;
    bool flip = false;  // (u, v) becomes (u, 1 - v)
};

Result<int> append_attribute(tinygltf::Model& model, const Attribute& attribute, size_t count) {
    const auto components = static_cast<size_t>(attribute.components);
    unsigned char* to =
        append_array(model, count, attribute.components, TINYGLTF_COMPONENT_TYPE_FLOAT,
                     components == 3 ? TINYGLTF_TYPE_VEC3 : TINYGLTF_TYPE_VEC2, TINYGLTF_TARGET_ARRAY_BUFFER);
    std::vector<double>& least = model.accessors.back().minValues;
    std::vector<double>& largest = model.accessors.back().maxValues;
    least.assign(components, HUGE_VAL);
    largest.assign(components, -HUGE_VAL);
    for (size_t i = 0; i < count; ++i) {
        const size_t element = attribute.picked.empty() ? i : attribute.picked[i];
        for (size_t k = 0; k < components; ++k) {
            float value = attribute.values[element * components + k];
            if (attribute.flip && k == 1) value = 1 - value;
            if (!std::isfinite(value)) return not_finite(attribute.name, element);
            least[k] = std::min<double>(least[k], value);
            largest[k] = std::max<double>(largest[k], value);
            to = put_u32(to, std::bit_cast<uint32_t>(value));
        }
    }
    return last_accessor(model);
}

Result<void> append_mesh(tinygltf::Model& model, const MeshOutput& mesh, const Triangles& triangles) {
    tinygltf::Primitive primitive;
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    primitive.material = 0;
    primitive.indices = append_indices(model, triangles.indices);
    const Attribute attributes[] = {
        {"POSITION", "position", mesh.positions, triangles.vertices, 3},
        {"NORMAL", "normal", mesh.normals, triangles.vertices, 3},
        {"TEXCOORD_0", "texture coordinate", mesh.texture_coordinates, triangles.values, 2, true}};
    for (const Attribute& attribute : attributes) {
        if (attribute.values.empty()) continue;
        const Result<int> accessor = append_attribute(model, attribute, triangles.vertex_count);
        if (!accessor) return accessor.error();
        primitive.attributes[attribute.semantic] = *accessor;
    }

    tinygltf::Material material;
    material.pbrMetallicRoughness.metallicFactor = 0;
    material.pbrMetallicRoughness.roughnessFactor = 0.6;
    model.materials.push_back(material);
    model.meshes.emplace_back();
    model.meshes[0].name = "surface";
    model.meshes[0].primitives.push_back(primitive);
    model.nodes[0].mesh = 0;
    return {};
}

/// Everything but the mesh.
tinygltf::Model empty_model() {
    tinygltf::Model model;
    model.asset.version = "2.0";
    model.asset.generator = "limn " LIMN_VERSION;
    model.nodes.emplace_back();
    model.nodes[0].name = "surface";
    model.scenes.emplace_back();
    model.scenes[0].nodes = {0};
    model.defaultScene = 0;
    return model;
}

/// Room in `model` for the mesh, once it is known to fit.
Result<void> reserve_buffer(tinygltf::Model& model, const MeshOutput& mesh, const Triangles& triangles) {
    const uint64_t vertex_bytes = 4 * ((mesh.positions.empty() ? 0u : 3u) + (mesh.normals.empty() ? 0u : 3u) +
                                       (mesh.texture_coordinates.empty() ? 0u : 2u));
    // Neither product overflows: there are fewer than 2^31 vertices and 2^32 / 12 triangles.
    const uint64_t bytes = 4 * uint64_t{triangles.indices.size()} + vertex_bytes * triangles.vertex_count;
    if (bytes > kMaxFileBytes - kFrameBytes) return too_large();
    model.buffers.emplace_back();
    model.buffers[0].data.reserve(bytes);
    return {};
}

Result<tinygltf::Model> build_model(const MeshOutput& mesh) {
    if (auto checked = check_mesh_output(mesh); !checked) return checked.error();
    tinygltf::Model model = empty_model();
    const uint64_t triangle_count = count_triangles(mesh);
    if (triangle_count == 0) return model;  // arrays of no elements are not glTF
    if (triangle_count > kMaxFileBytes / 12) return too_large();
    const Triangles triangles = triangulate(mesh, triangle_count);
    if (auto reserved = reserve_buffer(model, mesh, triangles); !reserved) return reserved.error();
    if (auto appended = append_mesh(model, mesh, triangles); !appended) return appended.error();
    return model;
}

/// What tinygltf writes, into a FileWriter.
class WriterStream : public std::streambuf {
  public:
    explicit WriterStream(FileWriter& writer) : writer_(writer) {}

  protected:
    std::streamsize xsputn(const char* text, std::streamsize size) override {
        std::string_view rest(text, static_cast<size_t>(size));
        while (!rest.empty()) {
            const std::string_view part = rest.substr(0, FileWriter::kBufferBytes);
            writer_.append(part);
            rest.remove_prefix(part.size());
        }
        return size;
    }
    int_type overflow(int_type c) override {
        if (traits_type::eq_int_type(c, traits_type::eof())) return traits_type::not_eof(c);
        const char character = traits_type::to_char_type(c);
        xsputn(&character, 1);
        return c;
    }

  private:
    FileWriter& writer_;
};

}  // namespace

Result<void> write_glb(const std::string& path, const MeshOutput& mesh) {
    const Result<tinygltf::Model> model = build_model(mesh);
    if (!model) {
        Error error = model.error();
        error.message = printable(path) + ": " + error.message;
        return error;
    }
    auto writer = FileWriter::create(path);
    if (!writer) return writer.error();
    WriterStream buffer(*writer);
    std::ostream stream(&buffer);
    tinygltf::TinyGLTF().WriteGltfSceneToStream(&*model, stream, false, true);
    return writer->commit();
}

}  // namespace limn::cli
