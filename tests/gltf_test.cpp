// Binary glTF out: read back by hand, as the specification has it, and with tinygltf.
#include "cli/gltf.h"

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <random>

#include "files.h"
#include "limn/obj.h"

namespace limn::cli {
namespace {

namespace fs = std::filesystem;
using Indices = std::vector<uint32_t>;
using Floats = std::vector<float>;

/// The arrays of a .glb file.
struct Arrays {
    Floats positions, normals, texture;
    Indices indices;
    nlohmann::json json;
};

/// The JSON of a .glb file, which leaves `reader` at the first byte of the binary chunk or at the end.
nlohmann::json read_chunks(ByteReader& reader, size_t& binary_size) {
    const size_t size = reader.bytes.size();
    EXPECT_EQ(reader.u32(), 0x46546c67u);  // "glTF"
    EXPECT_EQ(reader.u32(), 2u);
    EXPECT_EQ(reader.u32(), size);
    const size_t json_size = reader.u32();
    EXPECT_EQ(json_size % 4, 0u);
    EXPECT_EQ(reader.u32(), 0x4e4f534au);  // "JSON"
    nlohmann::json json = nlohmann::json::parse(reader.bytes.substr(20, json_size));
    reader.at = 20 + json_size;
    binary_size = 0;
    if (reader.at == size) return json;
    binary_size = reader.u32();
    EXPECT_EQ(binary_size % 4, 0u);
    EXPECT_EQ(reader.u32(), 0x004e4942u);  // "BIN"
    EXPECT_EQ(reader.at + binary_size, size);
    return json;
}

/// The bytes of an accessor, checked against its view and the view against the buffer.
ByteReader accessor_bytes(const Arrays& file, const std::string& binary, size_t index, size_t components,
                          int target) {
    const auto& accessor = file.json.at("accessors").at(index);
    const auto& view = file.json.at("bufferViews").at(accessor.at("bufferView").get<size_t>());
    const size_t offset = view.value("byteOffset", size_t{0}), length = view.at("byteLength");
    EXPECT_EQ(view.at("buffer"), 0);
    EXPECT_EQ(view.at("target"), target);
    EXPECT_FALSE(view.contains("byteStride") || accessor.contains("byteOffset"));
    EXPECT_EQ(offset % 4, 0u);
    EXPECT_LE(offset + length, file.json.at("buffers").at(0).at("byteLength").get<size_t>());
    const size_t count = accessor.at("count");
    EXPECT_GT(count, 0u);
    EXPECT_EQ(length, count * components * 4);
    return {binary.substr(offset, length)};
}

Floats read_floats(const Arrays& file, const std::string& binary, size_t index, size_t components) {
    const auto& accessor = file.json.at("accessors").at(index);
    EXPECT_EQ(accessor.at("componentType"), 5126);
    EXPECT_EQ(accessor.at("type"), "VEC" + std::to_string(components));
    ByteReader reader = accessor_bytes(file, binary, index, components, 34962);
    Floats values(reader.bytes.size() / 4);
    for (float& value : values) value = reader.f32();
    for (size_t k = 0; k < components; ++k) {
        float least = std::numeric_limits<float>::max(), largest = -least;
        for (size_t i = k; i < values.size(); i += components) {
            least = std::min(least, values[i]);
            largest = std::max(largest, values[i]);
        }
        EXPECT_EQ(accessor.at("min").at(k).get<double>(), least);
        EXPECT_EQ(accessor.at("max").at(k).get<double>(), largest);
    }
    return values;
}

Arrays read_by_hand(const std::string& bytes) {
    ByteReader reader{bytes};
    size_t binary_size = 0;
    Arrays file;
    file.json = read_chunks(reader, binary_size);
    const nlohmann::json& json = file.json;
    EXPECT_EQ(json.at("asset").at("version"), "2.0");
    EXPECT_EQ(json.at("asset").at("generator").get<std::string>().rfind("limn ", 0), 0u);
    EXPECT_EQ(json.at("scenes").at(json.at("scene").get<size_t>()).at("nodes"), nlohmann::json::array({0}));
    const auto& node = json.at("nodes").at(0);
    if (!node.contains("mesh")) {
        for (const char* key : {"meshes", "accessors", "bufferViews", "buffers"})
            EXPECT_FALSE(json.contains(key));
        EXPECT_EQ(binary_size, 0u);
        return file;
    }
    const std::string binary = bytes.substr(reader.at);
    EXPECT_EQ(json.at("buffers").size(), 1u);
    EXPECT_EQ(json.at("buffers").at(0).at("byteLength"), binary_size);

    EXPECT_EQ(node.at("mesh"), 0);
    const auto& primitive = json.at("meshes").at(0).at("primitives").at(0);
    EXPECT_EQ(primitive.value("mode", 4), 4);
    const auto& material = json.at("materials").at(primitive.at("material").get<size_t>());
    EXPECT_EQ(material.at("pbrMetallicRoughness").at("metallicFactor"), 0);
    EXPECT_EQ(material.at("pbrMetallicRoughness").at("roughnessFactor"), 0.6);
    EXPECT_FALSE(material.value("doubleSided", false));

    const auto& attributes = primitive.at("attributes");
    file.positions = read_floats(file, binary, attributes.at("POSITION"), 3);
    if (attributes.contains("NORMAL")) file.normals = read_floats(file, binary, attributes["NORMAL"], 3);
    if (attributes.contains("TEXCOORD_0"))
        file.texture = read_floats(file, binary, attributes["TEXCOORD_0"], 2);
    EXPECT_TRUE(file.normals.empty() || file.normals.size() == file.positions.size());
    EXPECT_TRUE(file.texture.empty() || file.texture.size() / 2 == file.positions.size() / 3);

    const size_t indices = primitive.at("indices");
    EXPECT_EQ(json.at("accessors").at(indices).at("componentType"), 5125);
    EXPECT_EQ(json.at("accessors").at(indices).at("type"), "SCALAR");
    reader = accessor_bytes(file, binary, indices, 1, 34963);
    while (reader.at < reader.bytes.size()) file.indices.push_back(reader.u32());
    EXPECT_EQ(file.indices.size() % 3, 0u);
    for (const uint32_t index : file.indices) EXPECT_LT(index, file.positions.size() / 3);
    return file;
}

template <class T>
std::vector<T> loaded_array(const tinygltf::Model& model, int index) {
    const tinygltf::Accessor& accessor = model.accessors.at(static_cast<size_t>(index));
    const tinygltf::BufferView& view = model.bufferViews.at(static_cast<size_t>(accessor.bufferView));
    std::vector<T> values(view.byteLength / sizeof(T));
    std::memcpy(values.data(), model.buffers.at(0).data.data() + view.byteOffset, view.byteLength);
    return values;
}

/// tinygltf finds no fault with the file and the same arrays in it.
void expect_tinygltf_agrees(const std::string& bytes, const Arrays& file) {
    tinygltf::TinyGLTF loader;
    tinygltf::Model model;
    std::string error, warning;
    ASSERT_TRUE(loader.LoadBinaryFromMemory(&model, &error, &warning,
                                            reinterpret_cast<const unsigned char*>(bytes.data()),
                                            static_cast<unsigned int>(bytes.size())))
        << error;
    EXPECT_EQ(error + warning, "");
    ASSERT_EQ(model.meshes.size(), file.positions.empty() ? 0u : 1u);
    if (model.meshes.empty()) return;
    ASSERT_EQ(model.meshes[0].primitives.size(), 1u);
    tinygltf::Primitive& primitive = model.meshes[0].primitives[0];
    EXPECT_EQ(primitive.attributes.size(), 1u + !file.normals.empty() + !file.texture.empty());
    EXPECT_EQ(loaded_array<uint32_t>(model, primitive.indices), file.indices);
    EXPECT_EQ(loaded_array<float>(model, primitive.attributes.at("POSITION")), file.positions);
    if (!file.normals.empty()) {
        EXPECT_EQ(loaded_array<float>(model, primitive.attributes.at("NORMAL")), file.normals);
    }
    if (!file.texture.empty()) {
        EXPECT_EQ(loaded_array<float>(model, primitive.attributes.at("TEXCOORD_0")), file.texture);
    }
}

Arrays read_glb(const std::string& path) {
    const std::string bytes = contents(path);
    Arrays file = read_by_hand(bytes);
    expect_tinygltf_agrees(bytes, file);
    return file;
}

Arrays written(const MeshOutput& mesh) {
    const TemporaryDirectory directory;
    const auto done = write_glb(directory.file("out.glb"), mesh);
    EXPECT_TRUE(done) << done.error().message;
    EXPECT_EQ(directory.entry_count(), 1u);
    return read_glb(directory.file("out.glb"));
}

/// Two quads and a triangle between them, left out, with a seam along the edge 1 2.
struct Sample {
    Floats positions = {0, -0.f, 1e-40f, 1, 0.1f, 3.4028235e38f, 1.f / 3, 1e20f, -1e-5f, 0, 1, 16777216, 5,
                        6, 7,    8,      9, 10};
    Floats normals = {0, 0, 1, 0, 1, 0, 1, 0, 0, -1, 0, 0, 0.6f, 0.8f, 0, 0, 0, -1};
    Floats texture = {0.25f, 0.5f, 1, 0, 0.1f, 0.2f, -3, 4};
    Indices sizes = {4, 3, 4};
    Indices vertices = {0, 1, 2, 3, 3, 2, 4, 4, 2, 1, 5};
    Indices face_texture = {3, 2, 1, 0, 1, 1, 1, 0, 1, 3, 0};
    std::vector<uint8_t> skip = {0, 1, 0};

    MeshOutput mesh() const { return {positions, normals, texture, face_texture, 0, sizes, vertices, skip}; }
};

TEST(GltfWrite, TrianglesStayAsTheyAre) {
    const Floats positions = {0, 0, 0, 1, 0, 0, 1, 1, 0.1f, 0, 1, 0, 7, 7, 7};
    const Floats normals = {0, 0, 1, 0, 1, 0, 1, 0, 0, 0, 0, -1, 0, 0, 1};
    const Floats texture = {0, 0, 1, 0, 1, 1, 0.25f, 0.75f, 3, -2};
    const Indices vertices = {0, 1, 2, 0, 2, 3};
    const Arrays all = written({positions, normals, texture, {}, 3, {}, vertices, {}});
    EXPECT_EQ(all.positions, positions);  // the last one is used by none
    EXPECT_EQ(all.normals, normals);
    EXPECT_EQ(all.texture, (Floats{0, 1, 1, 1, 1, 0, 0.25f, 0.25f, 3, 3}));
    EXPECT_EQ(all.indices, vertices);
    const Arrays bare = written({positions, {}, {}, {}, 3, {}, vertices, {}});
    EXPECT_EQ(bare.positions, positions);
    EXPECT_TRUE(bare.normals.empty() && bare.texture.empty());
    EXPECT_EQ(bare.indices, vertices);
}

TEST(GltfWrite, FacesBecomeFans) {
    const Floats positions(15, 0.5f);
    const Indices sizes = {5, 2, 4, 0, 3}, vertices = {4, 3, 2, 1, 0, 0, 1, 0, 1, 2, 3, 1, 2, 3};
    EXPECT_EQ(written({positions, {}, {}, {}, 0, sizes, vertices, {}}).indices,
              (Indices{4, 3, 2, 4, 2, 1, 4, 1, 0, 0, 1, 2, 0, 2, 3, 1, 2, 3}));
    const std::vector<uint8_t> skip = {1, 0, 0, 0, 1};
    EXPECT_EQ(written({positions, {}, {}, {}, 0, sizes, vertices, skip}).indices,
              (Indices{0, 1, 2, 0, 2, 3}));
}

TEST(GltfWrite, SeamsAreSplitInOrderOfFirstUse) {
    const Sample sample;
    const Arrays file = written(sample.mesh());
    // The last face shares vertex 2 with the first one. Vertex 1 has another texture coordinate there.
    EXPECT_EQ(file.indices, (Indices{0, 1, 2, 0, 2, 3, 4, 2, 5, 4, 5, 6}));
    const Indices vertices = {0, 1, 2, 3, 4, 1, 5}, values = {3, 2, 1, 0, 0, 3, 0};
    ASSERT_EQ(file.positions.size(), 3 * vertices.size());
    for (size_t i = 0; i < vertices.size(); ++i) {
        for (size_t k = 0; k < 3; ++k) {
            EXPECT_EQ(file.positions[3 * i + k], sample.positions[3 * vertices[i] + k]);
            EXPECT_EQ(file.normals[3 * i + k], sample.normals[3 * vertices[i] + k]);
        }
        EXPECT_EQ(file.texture[2 * i], sample.texture[2 * values[i]]);
        EXPECT_EQ(file.texture[2 * i + 1], 1 - sample.texture[2 * values[i] + 1]);
    }
}

TEST(GltfWrite, ManySeams) {
    std::mt19937 random(3);
    Floats positions(3 * 20000), texture(2 * 5000);
    for (float& value : positions) value = static_cast<float>(random()) * 1e-9f;
    for (float& value : texture) value = static_cast<float>(random()) * 1e-9f;
    Indices vertices(300000), values(300000);
    for (size_t i = 0; i < vertices.size(); ++i) {
        vertices[i] = i % 3 == 0 ? 7 : static_cast<uint32_t>(random() % 20000);  // many values at one vertex
        values[i] = static_cast<uint32_t>(random() % 5000);
    }
    const Arrays file = written({positions, {}, texture, values, 3, {}, vertices, {}});
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> pairs;
    ASSERT_EQ(file.indices.size(), vertices.size());
    for (size_t i = 0; i < vertices.size(); ++i) {
        const auto next = static_cast<uint32_t>(pairs.size());
        const uint32_t index = pairs.try_emplace({vertices[i], values[i]}, next).first->second;
        ASSERT_EQ(file.indices[i], index);
        ASSERT_EQ(std::memcmp(&file.positions[3 * index], &positions[3 * vertices[i]], 12), 0);
        ASSERT_EQ(file.texture[2 * index], texture[2 * values[i]]);
        ASSERT_EQ(file.texture[2 * index + 1], 1 - texture[2 * values[i] + 1]);
    }
    EXPECT_EQ(file.positions.size(), 3 * pairs.size());
}

TEST(GltfWrite, NothingIsAnEmptyScene) {
    EXPECT_TRUE(written({}).positions.empty());
    const Sample sample;
    const std::vector<uint8_t> skip = {1, 1, 1};
    MeshOutput mesh = sample.mesh();
    mesh.face_skip = skip;
    EXPECT_TRUE(written(mesh).positions.empty());
}

Error error_of(const std::string& path, const MeshOutput& mesh) {
    const auto done = write_glb(path, mesh);
    EXPECT_FALSE(done);
    if (done) return {};
    EXPECT_EQ(done.error().message.rfind(path + ": ", 0), 0u) << done.error().message;
    EXPECT_EQ(done.error().message.find('\n'), std::string::npos);
    return done.error();
}

TEST(GltfWrite, RefusesWhatIsNoMesh) {
    const TemporaryDirectory directory;
    const std::string path = directory.file("out.glb");
    const Sample sample;
    MeshOutput mesh = sample.mesh();
    mesh.face_sizes = mesh.face_sizes.first(2);
    EXPECT_EQ(error_of(path, mesh).code, ErrorCode::invalid_argument);
    mesh = sample.mesh();
    mesh.positions = mesh.positions.first(12);
    mesh.normals = {};
    EXPECT_EQ(error_of(path, mesh).code, ErrorCode::index_out_of_range);

    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    const auto expect_not_finite = [&](const Sample& broken, uint64_t element, const char* cause) {
        const Error error = error_of(path, broken.mesh());
        EXPECT_EQ(error.code, ErrorCode::not_finite);
        EXPECT_EQ(error.element, element);
        EXPECT_EQ(error.message, path + ": " + cause);
    };
    Sample broken;
    broken.texture[3] = -kInfinity;
    expect_not_finite(broken, 1, "texture coordinate 1 is not finite");
    broken.normals[16] = kInfinity;
    expect_not_finite(broken, 5, "normal 5 is not finite");
    broken.positions[11] = std::nanf("");
    expect_not_finite(broken, 3, "position 3 is not finite");
    EXPECT_EQ(directory.entry_count(), 0u);
}

TEST(GltfWrite, LeavesNothingWhereNothingCanBeWritten) {
    const TemporaryDirectory directory;
    const Sample sample;
    EXPECT_EQ(error_of(directory.file("none/out.glb"), sample.mesh()).code, ErrorCode::cannot_open);
    EXPECT_EQ(error_of(directory.path.string(), sample.mesh()).code, ErrorCode::cannot_open);
    EXPECT_EQ(directory.entry_count(), 0u);
    put_contents(directory.file("old.glb"), "precious");
    EXPECT_FALSE(
        write_glb(directory.file("old.glb"), {sample.positions, {}, {}, {}, 3, {}, sample.vertices, {}}));
    EXPECT_EQ(contents(directory.file("old.glb")), "precious");
    if (!fs::is_character_file("/dev/full")) GTEST_SKIP() << "no /dev/full here";
    EXPECT_EQ(error_of("/dev/full", sample.mesh()).message,
              "/dev/full: cannot write: No space left on device");
}

/// Zeros that take address space only, until they are written to.
struct Zeros {
    static constexpr size_t kBytes = size_t{5} << 30;
    void* memory = mmap(nullptr, kBytes, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    ~Zeros() { munmap(memory, kBytes); }
    template <class T>
    std::span<const T> first(size_t count) const {
        EXPECT_LE(count, kBytes / sizeof(T));
        return {static_cast<const T*>(memory), count};
    }
};

TEST(GltfWrite, RefusesMoreThanTheLengthFieldHolds) {
    const Zeros zeros;
    if (zeros.memory == MAP_FAILED) GTEST_SKIP() << "no address space";
    const TemporaryDirectory directory;
    const std::string path = directory.file("out.glb");
    const Indices triangle = {0, 1, 2};
    // More than 2^32 bytes of positions and normals, which nobody reads; a fan of 2^30 triangles.
    const auto floats = zeros.first<float>(size_t{3} << 28);
    EXPECT_EQ(error_of(path, {floats, floats, {}, {}, 3, {}, triangle, {}}).code, ErrorCode::too_large);
    const Floats positions(9);
    const auto corners = zeros.first<uint32_t>((size_t{1} << 30) + 2);
    const Indices sizes = {(1u << 30) + 2};
    EXPECT_EQ(error_of(path, {positions, {}, {}, {}, 0, sizes, corners, {}}).code, ErrorCode::too_large);
    EXPECT_EQ(directory.entry_count(), 0u);
}

TEST(GltfProgram, RefinesToTheLimit) {
    const TemporaryDirectory directory;
    put_contents(directory.file("shape.obj"),
                 "v -1 -1 1\nv 1 -1 1\nv -1 1 1\nv 1 1 1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 -1\nv 1 -1 -1\n"
                 "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
                 "f 1/1 2/2 4/3 3/4\nf 3/1 4/2 6/3 5/4\nf 5/1 6/2 8/3 7/4\nf 7/1 8/2 2/3 1/4\n"
                 "f 2/1 8/2 6/3 4/4\nf 7/1 1/2 3/3 5/4\nt hole 1/0/0 2\n");
    const auto refine = [&](const std::string& output) {
        const std::string command = "cd '" + directory.path.string() +
                                    "' && " LIMN_PROGRAM " refine shape.obj --level 2 --limit -o " + output;
        return std::system(command.c_str());
    };
    ASSERT_EQ(refine("out.obj"), 0);
    ASSERT_EQ(refine("out.ply"), 0);
    ASSERT_EQ(refine("out.glb"), 0);
    const auto model = read_obj(directory.file("out.obj"));
    ASSERT_TRUE(model);
    const Arrays file = read_glb(directory.file("out.glb"));
    ASSERT_EQ(model->face_count(), 5u * 16);
    ASSERT_EQ(file.indices.size(), 5u * 16 * 6);
    const size_t fan[] = {0, 1, 2, 0, 2, 3};
    for (size_t i = 0; i < file.indices.size(); ++i) {
        const size_t corner = i / 6 * 4 + fan[i % 6], index = file.indices[i];
        const float* position = &model->positions[3 * model->face_vertices[corner]];
        const float* texture = &model->texture_coordinates[2 * model->face_texture_coordinates[corner]];
        const float* normal = &file.normals[3 * index];
        for (size_t k = 0; k < 3; ++k) EXPECT_EQ(file.positions[3 * index + k], position[k]);
        EXPECT_EQ(file.texture[2 * index], texture[0]);
        EXPECT_EQ(file.texture[2 * index + 1], 1 - texture[1]);
        EXPECT_NEAR(std::hypot(normal[0], normal[1], normal[2]), 1, 1e-6);
        EXPECT_GT(normal[0] * position[0] + normal[1] * position[1] + normal[2] * position[2], 0);
    }
    // The other formats have all of it, too.
    const std::string ply = contents(directory.file("out.ply")), obj = contents(directory.file("out.obj"));
    EXPECT_NE(ply.find("property float nx\n"), std::string::npos);
    EXPECT_NE(ply.find("float texcoord\n"), std::string::npos);
    EXPECT_NE(obj.find("\nvn "), std::string::npos);
    EXPECT_NE(obj.find("\nvt "), std::string::npos);
}

}  // namespace
}  // namespace limn::cli
