// Topology of control meshes: the fast way for manifolds gives what the general way gives.
#include "limn/topology.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "shapes/random_mesh.h"
#include "shapes/shapes.h"

namespace limn::test {
namespace {

Topology topology_of(const TestMesh& shape) {
    const auto mesh = ControlMesh::create(shape.description());
    EXPECT_TRUE(mesh) << shape.name;
    return build_topology(*mesh);
}

/// Whether `longer` begins with `array`.
template <class T>
bool begins_with(const Array<T>& longer, const Array<T>& array, size_t count) {
    return longer.size() >= count && array.size() >= count &&
           std::equal(array.begin(), array.begin() + count, longer.begin());
}

/// The mesh alone, and with a book of three pages behind it, which only the general way takes: what belongs
/// to the mesh is the same.
void expect_same(const TestMesh& shape) {
    TestMesh more = shape;
    append(more, make_book(3, shape.options.scheme == Scheme::loop));
    const Topology a = topology_of(shape), b = topology_of(more);
    EXPECT_TRUE(begins_with(b.face_edges, a.face_edges, a.corner_count()));
    EXPECT_TRUE(begins_with(b.edge_vertices, a.edge_vertices, 2 * size_t{a.edge_count}));
    EXPECT_TRUE(begins_with(b.edge_corner_offsets, a.edge_corner_offsets, a.edge_count + size_t{1}));
    EXPECT_TRUE(begins_with(b.edge_corners, a.edge_corners, a.corner_count()));
    EXPECT_TRUE(begins_with(b.vertex_corner_offsets, a.vertex_corner_offsets, a.vertex_count + size_t{1}));
    EXPECT_TRUE(begins_with(b.vertex_corners, a.vertex_corners, a.corner_count()));
    EXPECT_TRUE(begins_with(b.vertex_edge_offsets, a.vertex_edge_offsets, a.vertex_count + size_t{1}));
    EXPECT_TRUE(begins_with(b.vertex_edges, a.vertex_edges, 2 * size_t{a.edge_count}));
    EXPECT_TRUE(begins_with(b.edge_sharpness, a.edge_sharpness, a.edge_count));
    EXPECT_TRUE(begins_with(b.vertex_sharpness, a.vertex_sharpness, a.vertex_count));
    EXPECT_TRUE(begins_with(b.vertex_manifold, a.vertex_manifold, a.vertex_count));
    EXPECT_TRUE(begins_with(b.vertex_rules, a.vertex_rules, a.vertex_count));
}

TEST(Topology, ManifoldsAreBuiltAsAllMeshesAre) {
    for (TestMesh shape : all_shapes()) {
        SCOPED_TRACE(shape.name);
        shape.channels.clear();
        expect_same(shape);
    }
    for (uint64_t seed = 1; seed <= 300; ++seed) {
        TestMesh shape = random_mesh(seed);
        SCOPED_TRACE(shape.name);
        shape.channels.clear();
        expect_same(shape);
    }
}

/// Faces that each fit, but no manifold: more than one edge from a vertex to another, a face at itself, two
/// fans.
TEST(Topology, WhatOnlyLooksLikeAFanIsNoManifold) {
    TestMesh bowtie;
    for (uint32_t i = 0; i < 5; ++i) bowtie.add_vertex(i, i * i, 0);
    bowtie.add_face({0, 1, 2});
    bowtie.add_face({0, 3, 4});
    EXPECT_EQ(topology_of(bowtie).vertex_manifold[0], 0);
    EXPECT_EQ(topology_of(bowtie).vertex_manifold[1], 1);

    TestMesh twice;  // the same face twice: each edge the same way round
    for (uint32_t i = 0; i < 3; ++i) twice.add_vertex(i, i * i, 0);
    twice.add_face({0, 1, 2});
    twice.add_face({0, 1, 2});
    EXPECT_TRUE(std::ranges::all_of(topology_of(twice).vertex_manifold, [](uint8_t m) { return m == 0; }));

    TestMesh pillow = twice;  // closed: manifold, though both faces have all vertices
    std::swap(pillow.face_vertices[4], pillow.face_vertices[5]);
    EXPECT_TRUE(std::ranges::all_of(topology_of(pillow).vertex_manifold, [](uint8_t m) { return m == 1; }));
}

}  // namespace
}  // namespace limn::test
