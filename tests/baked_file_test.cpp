// Baked files: what is read is what was written, array by array; and no file, whatever is in it, does harm.
#include "limn/baked_file.h"

#include <gtest/gtest.h>

#include <cstring>

#include "files.h"
#include "limn/baked_format.h"
#include "limn/batch.h"
#include "shapes/bake_shape.h"
#include "shapes/follow_baked.h"

namespace limn::test {
namespace {

using Bytes = std::span<const std::byte>;

/// All numbers and arrays of a mesh, in the order of the format.
struct Collector {
    std::vector<uint64_t> values;
    std::vector<Bytes> arrays;
    std::vector<bool> borrowed;
    void value(const auto& number, uint64_t) { values.push_back(static_cast<uint64_t>(number)); }
    template <class T>
    void array(const Array<T>& array) {
        arrays.push_back(std::as_bytes(std::span(array.data(), array.size())));
        borrowed.push_back(array.empty() || array.is_borrowed());
    }
    void list(const auto& items, const auto& body) {
        values.push_back(items.size());
        for (const auto& item : items) body(item);
    }
};
Collector collect(const BakedMesh& mesh) {
    Collector out;
    visit_mesh(out, mesh);
    return out;
}
bool same(Bytes a, Bytes b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size()) == 0);
}
void expect_same(const BakedMesh& a, const BakedMesh& b, const std::string& name) {
    const Collector left = collect(a), right = collect(b);
    EXPECT_EQ(left.values, right.values) << name;
    ASSERT_EQ(left.arrays.size(), right.arrays.size()) << name;
    for (size_t i = 0; i < left.arrays.size(); ++i) EXPECT_TRUE(same(left.arrays[i], right.arrays[i])) << name << ": " << i;
}

BakedMesh bake(const TestMesh& shape, bool extras = false) {
    auto baked = bake_shape(shape, extras);
    EXPECT_TRUE(baked.has_value()) << shape.name << ": " << (baked ? "" : baked.error().message);
    return baked ? std::move(*baked) : BakedMesh{};
}
TestMesh small_shape() {
    TestMesh mesh = make_pyramid(5);
    mesh.add_crease(0, 1, 2.5);
    add_channel_by_region(mesh, FaceVaryingInterpolation::corners_only, {0, 0, 1, 1, 1, 0});
    return mesh;
}
Array<std::byte> small_file() {
    return write_baked_bytes(bake(small_shape(), true));
}
std::string message_of(Bytes bytes, const BakedLoadOptions& options = {}) {
    const auto loaded = load_baked_bytes(bytes, options);
    return loaded ? "" : loaded.error().message;
}
Bytes bytes_of(const Array<std::byte>& file) {
    return {file.data(), file.size()};
}

TEST(BakedFile, HoldsEveryArrayOfEveryShape) {
    const TemporaryDirectory directory;
    for (const TestMesh& shape : all_shapes()) {
        const BakedMesh mesh = bake(shape, true);
        const std::string path = directory.file(shape.name + ".limn");
        ASSERT_TRUE(write_baked_file(path, mesh).has_value());
        const auto file = BakedFile::open(path);
        ASSERT_TRUE(file.has_value()) << file.error().message;
        expect_same(mesh, file->mesh(), shape.name);
        for (const bool borrowed : collect(file->mesh()).borrowed) EXPECT_TRUE(borrowed);
        follow_baked(file->mesh());
    }
}

TEST(BakedFile, HoldsNoTreesWhereNoneAreAskedFor) {
    const TestMesh shape = small_shape();
    const auto mesh = bake_mesh(shape.description(), {.max_rate = 0});
    ASSERT_TRUE(mesh.has_value()) << mesh.error().message;
    EXPECT_EQ(mesh->trees.bytes(), 0u);
    const Array<std::byte> file = write_baked_bytes(*mesh);
    const auto loaded = load_baked_bytes(bytes_of(file));
    ASSERT_TRUE(loaded.has_value()) << loaded.error().message;
    expect_same(*mesh, *loaded, "without trees");
    EXPECT_LT(file.size(), write_baked_bytes(bake(shape)).size());
    // Half of them is none.
    BakedMesh torn = bake(shape);
    torn.trees.max_rate = 0;
    EXPECT_NE(message_of(bytes_of(write_baked_bytes(torn))).find("rate is too small"), std::string::npos);
}

/// Strips that each refer to the plan that they are of: one file of a few kilobytes, 256^7 nodes.
BakedMesh bake_explosion() {
    BakedMesh mesh = bake(small_shape());
    PatchTable& t = mesh.patches;
    Plan& plan = t.plans[t.plans.size() - 1];
    plan.has_corner_rows = 1;  // where evaluation ends
    constexpr uint32_t kStripLevels = 6, kStrips = 1u << kStripLevels;
    std::vector<PlanNode> nodes(t.plan_nodes.begin(), t.plan_nodes.begin() + plan.first_node);
    const auto add = [&](PlanNodeKind kind, uint32_t first, uint32_t of = 0) {
        nodes.push_back({shared::pack_node(static_cast<uint32_t>(kind), of, 0), first});
    };
    for (uint32_t n = 0; n < kStrips - 1; ++n) add(PlanNodeKind::split_u, 2 * n + 1);
    for (uint32_t n = 0; n < kStrips; ++n) add(PlanNodeKind::split, 2 * kStrips - 1 + 4 * n);
    for (uint32_t n = 0; n < 4 * kStrips; ++n) add(PlanNodeKind::plan, 0, static_cast<uint32_t>(t.plans.size() - 1));
    t.plan_nodes.allocate(nodes.size());
    std::copy(nodes.begin(), nodes.end(), t.plan_nodes.begin());
    const std::vector<uint32_t> points(t.plan_points.begin(), t.plan_points.begin() + plan.first_point);
    t.plan_points.assign(points.size() + plan.ring_size, 0);
    std::copy(points.begin(), points.end(), t.plan_points.begin());
    return mesh;
}

TEST(BakedFile, PlansThatExplodeHaveNoTrees) {
    const BakedMesh made = bake_explosion();
    const Array<std::byte> file = write_baked_bytes(made);
    EXPECT_LT(file.size(), size_t{1} << 20);
    const auto mesh = load_baked_bytes(bytes_of(file));
    ASSERT_TRUE(mesh.has_value()) << mesh.error().message;
    const auto trees = build_patch_trees(mesh->patches, {});
    ASSERT_FALSE(trees.has_value());
    EXPECT_EQ(trees.error().code, ErrorCode::too_large);
    EXPECT_NE(trees.error().message.find("plans refer to too many plans"), std::string::npos) << trees.error().message;
    // Places are still evaluated, as all tables that load.
    follow_patches(mesh->patches, {mesh->positions.data(), mesh->positions.size()}, 3);
}

/// A crowd in one file.
TEST(BakedFile, HoldsMergedTables) {
    const BakedMesh parts[] = {bake(small_shape()), bake(make_torus(6, 5))};
    const PatchTable* patches[] = {&parts[0].patches, &parts[1].patches, &parts[0].patches};
    const TessellationTable* topologies[] = {&parts[0].tessellation, &parts[1].tessellation, &parts[0].tessellation};
    auto merged = merge_patch_tables<float>(patches);
    auto topology = merge_tessellation_tables(topologies);
    ASSERT_TRUE(merged && topology);
    auto trees = build_patch_trees(merged->table, {.max_rate = 16});
    ASSERT_TRUE(trees.has_value());
    BakedMesh mesh;
    mesh.patches = std::move(merged->table);
    mesh.tessellation = std::move(topology->table);
    mesh.trees = std::move(*trees);
    const Array<std::byte> file = write_baked_bytes(mesh);
    const auto loaded = load_baked_bytes(bytes_of(file));
    ASSERT_TRUE(loaded.has_value()) << loaded.error().message;
    expect_same(mesh, *loaded, "merged");
    EXPECT_EQ(loaded->tessellation.instance_count(), 3u);
    follow_baked(*loaded);
}

TEST(BakedFile, ComparisonSeesOneBit) {
    const BakedMesh mesh = bake(small_shape());
    BakedMesh other = bake(small_shape());
    expect_same(mesh, other, "as it is");
    other.patches.plan_weights[3] = std::nextafter(other.patches.plan_weights[3], 2.0f);
    const Collector left = collect(mesh), right = collect(other);
    size_t different = 0;
    for (size_t i = 0; i < left.arrays.size(); ++i) different += !same(left.arrays[i], right.arrays[i]);
    EXPECT_EQ(different, 1u);
}

TEST(BakedFile, OutlivesMovesAndCopiesOwn) {
    const TemporaryDirectory directory;
    const std::string path = directory.file("a.limn");
    const BakedMesh mesh = bake(small_shape(), true);
    ASSERT_TRUE(write_baked_file(path, mesh).has_value());
    BakedMesh copy;
    {
        auto opened = BakedFile::open(path);
        ASSERT_TRUE(opened.has_value());
        const BakedFile moved = std::move(*opened);
        expect_same(mesh, moved.mesh(), "moved");
        copy = moved.mesh();
    }
    expect_same(mesh, copy, "copied");
    EXPECT_FALSE(copy.patches.plan_weights.is_borrowed());
    const auto read = BakedFile::open(path, {.map = false});
    ASSERT_TRUE(read.has_value());
    expect_same(mesh, read->mesh(), "read");
}

TEST(BakedFile, IsTheSameInMemoryAndWhenBakedAgain) {
    const TemporaryDirectory directory;
    const std::string path = directory.file("a.limn");
    ASSERT_TRUE(write_baked_file(path, bake(small_shape(), true)).has_value());
    const Array<std::byte> bytes = small_file();
    const std::string file = contents(path);
    EXPECT_TRUE(same(bytes_of(bytes), std::as_bytes(std::span(file.data(), file.size()))));
    EXPECT_EQ(directory.entry_count(), 1u);
    EXPECT_TRUE(is_baked_file(path));
}

TEST(BakedFile, RefusesEveryLengthButItsOwn) {
    const Array<std::byte> file = small_file();
    for (size_t size = 0; size < file.size(); ++size) {
        Array<std::byte> part;
        part.allocate(size);
        if (size != 0) std::memcpy(part.data(), file.data(), size);
        ASSERT_NE(message_of({part.data(), size}), "") << size;
        ASSERT_NE(message_of({part.data(), size}, {.check_sums = false}), "") << size;
    }
    EXPECT_EQ(message_of(bytes_of(file)), "");
}

/// One bit of every byte, and all of the header's and of the beginning of the directory.
TEST(BakedFile, RefusesEveryFlippedBit) {
    Array<std::byte> file = write_baked_bytes(bake(make_tetrahedron(), true));
    size_t accepted = 0, refused = 0;
    for (size_t i = 0; i < file.size(); ++i) {
        for (uint32_t bit = 0; bit < 8; ++bit) {
            if (i >= 512 && bit != i % 8) continue;
            file[i] ^= std::byte{1} << bit;
            ASSERT_NE(message_of(bytes_of(file)), "") << "byte " << i << ", bit " << bit;
            // Without the sum what is let in must still be safe.
            const auto loaded = load_baked_bytes(bytes_of(file), {.check_sums = false});
            ++(loaded ? accepted : refused);
            if (loaded && loaded->patches.control_count < 1u << 16 && i % 64 == bit) follow_baked(*loaded);
            file[i] ^= std::byte{1} << bit;
        }
    }
    EXPECT_GT(accepted, 0u);  // a weight or a coordinate
    EXPECT_GT(refused, 0u);
}

TEST(BakedFile, SaysWhatIsWrongWithAHeader) {
    Array<std::byte> file = small_file();
    BakedHeader good;
    std::memcpy(&good, file.data(), sizeof good);
    const auto with = [&](const auto& change) {
        BakedHeader header = good;
        change(header);
        std::memcpy(file.data(), &header, sizeof header);
        return message_of(bytes_of(file));
    };
    EXPECT_EQ(with([](BakedHeader&) {}), "");
    EXPECT_EQ(with([](BakedHeader& h) { h.version = 7; }),
              "has format version 7, and this library reads version 2; bake it again");
    EXPECT_NE(with([](BakedHeader& h) { h.byte_order = 0x04030201; }).find("other byte order"), std::string::npos);
    EXPECT_NE(with([](BakedHeader& h) { h.magic[5] = '\n'; }).find("no baked file"), std::string::npos);
    EXPECT_NE(with([](BakedHeader& h) { h.file_bytes += 64; }).find("cut short"), std::string::npos);
    EXPECT_NE(with([](BakedHeader& h) { h.array_count = 0x7fffffff; }).find("directory"), std::string::npos);
    EXPECT_NE(with([](BakedHeader& h) { h.checksum[1] ^= 1; }).find("checksum"), std::string::npos);
    EXPECT_NE(message_of(bytes_of(file).subspan(1)).find("multiple of 16"), std::string::npos);
}

/// Tables that were changed after they were built, with a right checksum: each is refused for what is wrong.
TEST(BakedFile, RefusesWhatDoesNotFitTogether) {
    const auto refused = [](const char* cause, const auto& change) {
        BakedMesh mesh = bake(small_shape(), true);
        change(mesh);
        const Array<std::byte> file = write_baked_bytes(mesh);
        EXPECT_NE(message_of(bytes_of(file)).find(cause), std::string::npos)
            << cause << ": '" << message_of(bytes_of(file)) << "'";
        EXPECT_EQ(message_of(bytes_of(file), {.check_contents = false}), "");
    };
    refused("has no such plan", [](BakedMesh& m) { m.patches.surfaces[0].word = 0x3fffffff; });
    refused("has no such plan", [](BakedMesh& m) { m.patches.surfaces.back().first_ring += 1; });
    refused("a ring refers", [](BakedMesh& m) { m.patches.ring_points.words[0] = 0xffffffff; });
    refused("no control point", [](BakedMesh& m) { m.patches.point_indices.words[0] = 0xffffffff; });
    refused("no number", [](BakedMesh& m) { m.patches.plan_weights[0] = HUGE_VALF; });
    refused("no number", [](BakedMesh& m) { m.positions[1] = NAN; });
    refused("not behind it", [](BakedMesh& m) { m.patches.plan_nodes[m.patches.plans[0].first_node].first = 0; });
    refused("has no row", [](BakedMesh& m) { m.patches.plan_points[0] = 0xffff; });
    refused("refers to no plan", [](BakedMesh& m) {  // a plan that is itself, at no depth
        m.patches.plan_nodes[0] = {shared::pack_node(shared::kNodePlan, 0, 0), 0};
    });
    refused("without end", [](BakedMesh& m) {
        for (Plan& plan : m.patches.plans) plan.has_corner_rows = 0;
    });
    refused("no such surface", [](BakedMesh& m) { m.patches.ptex_surfaces[0] = 0x7fffffff; });
    refused("one mesh", [](BakedMesh& m) { m.patches.ptex_surfaces[0] = shared::kPtexHole; });
    refused("one mesh", [](BakedMesh& m) { m.patches.surfaces = {}, m.patches.ptex_surfaces.assign(m.patches.ptex_surfaces.size(), shared::kPtexHole); });
    refused("sides or corners", [](BakedMesh& m) { m.tessellation.faces[4] = m.tessellation.corner_count; });
    refused("sides or corners", [](BakedMesh& m) { m.tessellation.faces[0] |= shared::kSideRowMask; });
    refused("no edge or place", [](BakedMesh& m) { m.tessellation.rows[2] = 3; });
    refused("at no place", [](BakedMesh& m) { m.tessellation.corners[0] = m.tessellation.face_count; });
    refused("no rows or faces", [](BakedMesh& m) { m.tessellation.rate_edges[0] = shared::kSideRowMask; });
    const auto instances = [](BakedMesh& m, std::initializer_list<uint32_t> first) {
        m.tessellation.instance_faces.allocate(first.size());
        std::copy(first.begin(), first.end(), m.tessellation.instance_faces.begin());
    };
    refused("its instances", [&](BakedMesh& m) { instances(m, {0}); });
    refused("its instances", [&](BakedMesh& m) { instances(m, {0, m.tessellation.face_count + 1}); });
    refused("its instances", [&](BakedMesh& m) { instances(m, {1, m.tessellation.face_count}); });
    refused("its instances", [&](BakedMesh& m) { instances(m, {0, 5, 3, m.tessellation.face_count}); });
    refused("tree or local points", [](BakedMesh& m) { m.trees.surfaces[0].first_local = 0xfffffff0; });
    refused("not behind it", [](BakedMesh& m) {
        for (uint32_t& node : m.trees.nodes) node = shared::pack_tree_node(shared::kNodeSplit, 0, 0);
    });
    refused("a leaf has no points", [](BakedMesh& m) {
        m.trees.nodes[m.trees.nodes.size() - 1] = shared::pack_tree_node(shared::kNodeBicubic, 0, 1 << 20);
    });
    refused("class, ring or samples", [](BakedMesh& m) { m.trees.local_points.surfaces[0].ptex_face += 1 << 22; });
    refused("class's weights", [](BakedMesh& m) { m.grids[0].classes[0].first_weight = 1 << 28; });
    refused("class, ring or samples", [](BakedMesh& m) { m.refined[0].grid.slots[0] = 1 << 20; });
    refused("not in order", [](BakedMesh& m) { m.stencils[0].table.offsets[1] = 0x7fffffff; });
    refused("a row refers", [](BakedMesh& m) { m.stencils[1].table.indices[0] = 1 << 20; });
}

TEST(BakedFile, RefusesOtherFiles) {
    const TemporaryDirectory directory;
    const auto message = [&](const std::string& path) {
        const auto file = BakedFile::open(path);
        EXPECT_FALSE(is_baked_file(path)) << path;
        return file ? std::string() : file.error().message;
    };
    const std::string path = directory.file("x.limn");
    EXPECT_EQ(message(path).rfind(path + ": cannot open", 0), 0u);
    EXPECT_EQ(message(directory.path.string()).rfind(directory.path.string() + ": cannot read: Is a directory", 0), 0u);
    put_contents(path, "");
    EXPECT_EQ(message(path), path + ": is empty");
    uint64_t random = 1;
    for (size_t size = 1; size < 3000; size += 1 + size / 3) {
        std::string text(size, '\0');
        for (char& c : text) c = static_cast<char>((random = random * 6364136223846793005u + 1) >> 40);
        put_contents(path, text);
        EXPECT_EQ(message(path), path + ": is no baked file of limn");
    }
}

TEST(BakedFile, LeavesNoHalfOfAFile) {
    const TemporaryDirectory directory;
    const BakedMesh mesh = bake(small_shape());
    EXPECT_FALSE(write_baked_file(directory.path.string(), mesh).has_value());
    EXPECT_FALSE(write_baked_file(directory.file("no/such/a.limn"), mesh).has_value());
    EXPECT_EQ(directory.entry_count(), 0u);
}

TEST(ContentHash, TellsWhatIsDifferent) {
    const TestMesh shape = small_shape();
    ControlMeshDescription description = shape.description();
    description.positions = shape.positions;
    BakeOptions options;
    const ContentHash key = content_hash(description, options);
    EXPECT_EQ(key, content_hash(description, options));
    EXPECT_EQ(key.hex().size(), 32u);
    std::vector<ContentHash> keys = {key};
    const auto add = [&](const auto& change) {
        ControlMeshDescription d = description;
        BakeOptions o = options;
        change(d, o);
        keys.push_back(content_hash(d, o));
    };
    add([](auto& d, auto&) { d.left_handed = true; });
    add([](auto& d, auto&) { d.options.creasing = CreasingMethod::chaikin; });
    add([](auto& d, auto&) { d.channels = {}; });
    add([](auto& d, auto&) { d.positions = {}; });
    add([](auto& d, auto&) { d.face_vertices = d.face_vertices.first(d.face_vertices.size() - 1); });
    add([](auto&, auto& o) { o.max_rate = 32; });
    add([](auto&, auto& o) { o.grid_rates = {3}; });
    add([](auto&, auto& o) { o.refined_levels = {3}; });
    add([](auto&, auto& o) { o.patches.plan_depth = 2; });
    for (size_t i = 0; i < keys.size(); ++i)
        for (size_t j = 0; j < i; ++j) EXPECT_NE(keys[i], keys[j]) << i << " " << j;
}

/// What this version makes of a fixed description, whatever the machine: little-endian words, lists behind lengths.
TEST(ContentHash, IsTheSameEverywhere) {
    const uint32_t sizes[] = {4}, vertices[] = {0, 1, 2, 3};
    ControlMeshDescription description;
    description.vertex_count = 4;
    description.face_sizes = sizes;
    description.face_vertices = vertices;
    EXPECT_EQ(content_hash(description, {}).hex(), "c4ab2ee1652957c4cf8e6e7fe4cc3779");
}

TEST(BakedCache, BakesOnceAndAgainWhereDamaged) {
    const TemporaryDirectory directory;
    const TestMesh shape = small_shape();
    ControlMeshDescription description = shape.description();
    description.positions = shape.positions;
    const std::string path = directory.file(content_hash(description, {}).hex() + ".limn");
    ASSERT_TRUE(load_or_bake(directory.path.string(), description, {}).has_value());
    const auto time = std::filesystem::last_write_time(path);
    const auto again = load_or_bake(directory.path.string(), description, {});
    ASSERT_TRUE(again.has_value());
    EXPECT_EQ(std::filesystem::last_write_time(path), time);
    const std::string good = contents(path);
    put_contents(path, good.substr(0, good.size() / 2));
    const auto repaired = load_or_bake(directory.path.string(), description, {});
    ASSERT_TRUE(repaired.has_value());
    EXPECT_EQ(contents(path), good);
    EXPECT_EQ(directory.entry_count(), 1u);
    EXPECT_FALSE(load_or_bake(directory.file("missing"), description, {}).has_value());
}

}  // namespace
}  // namespace limn::test
