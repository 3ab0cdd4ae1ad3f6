// What refinement must do whatever the mesh: counts, provenance, and indifference to numbering.
#include "limn/refinement.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "limn/stencil_table.h"
#include "shapes/random_mesh.h"
#include "shapes/shapes.h"

namespace limn::test {
namespace {

Refinement refine(const TestMesh& mesh, uint32_t level, bool full = true) {
    const auto control = ControlMesh::create(mesh.description());
    EXPECT_TRUE(control) << mesh.name;
    auto refinement = build_refinement(*control, {level, full});
    EXPECT_TRUE(refinement) << mesh.name;
    return std::move(refinement).value();
}

// Every n-th shape, to keep this quick; the conformance tests take them all.
std::vector<TestMesh> some_shapes(size_t step) {
    std::vector<TestMesh> all = all_shapes(), result;
    for (size_t i = 0; i < all.size(); i += step) result.push_back(std::move(all[i]));
    return result;
}

TEST(Refinement, counts_are_those_of_its_scheme) {
    for (const TestMesh& mesh : some_shapes(3)) {
        SCOPED_TRACE(mesh.name);
        const Refinement refinement = refine(mesh, 3);
        ASSERT_EQ(refinement.level_count(), 4u);
        EXPECT_EQ(refinement.control_count, mesh.vertex_count);
        EXPECT_TRUE(refinement.control_indices.empty());
        for (uint32_t l = 1; l <= 3; ++l) {
            const Topology &parent = refinement.levels[l - 1], &child = refinement.levels[l];
            const uint32_t corners = parent.corner_count();
            if (mesh.options.scheme == Scheme::loop) {
                EXPECT_EQ(child.vertex_count, parent.vertex_count + parent.edge_count);
                EXPECT_EQ(child.face_count, 4 * parent.face_count);
                EXPECT_EQ(child.edge_count, 2 * parent.edge_count + 3 * parent.face_count);
                EXPECT_EQ(child.face_size, 3u);
            } else {
                EXPECT_EQ(child.vertex_count, parent.vertex_count + parent.face_count + parent.edge_count);
                EXPECT_EQ(child.face_count, corners);
                EXPECT_EQ(child.edge_count, 2 * parent.edge_count + corners);
                EXPECT_EQ(child.face_size, 4u);
            }
        }
    }
}

TEST(Refinement, keeps_the_euler_characteristic_of_closed_meshes) {
    for (const TestMesh& mesh : {make_cube(), make_torus(5, 4), make_globe(7, 2), make_prism(6)}) {
        const Refinement refinement = refine(mesh, 3);
        auto characteristic = [](const Topology& t) {
            return int64_t{t.vertex_count} - int64_t{t.edge_count} + int64_t{t.face_count};
        };
        for (const Topology& level : refinement.levels) {
            EXPECT_EQ(characteristic(level), characteristic(refinement.levels[0]));
        }
    }
}

TEST(Refinement, incidence_is_consistent) {
    for (const TestMesh& mesh : some_shapes(5)) {
        SCOPED_TRACE(mesh.name);
        const Refinement refinement = refine(mesh, 2);
        for (const Topology& t : refinement.levels) {
            std::vector<uint32_t> corners_of_edges(t.edge_count), corners_of_vertices(t.vertex_count);
            for (uint32_t c = 0; c < t.corner_count(); ++c) {
                const uint32_t e = t.face_edges[c], a = t.face_vertices[c],
                               b = t.face_vertices[t.next_corner(c)];
                ASSERT_LT(e, t.edge_count);
                EXPECT_EQ(std::minmax(a, b), std::minmax(t.edge_vertices[2 * e], t.edge_vertices[2 * e + 1]));
                ++corners_of_edges[e];
                ++corners_of_vertices[a];
                EXPECT_EQ(t.previous_corner(t.next_corner(c)), c);
            }
            for (uint32_t e = 0; e < t.edge_count; ++e) {
                const auto corners = t.corners_of_edge(e);
                ASSERT_EQ(corners.size(), corners_of_edges[e]);
                for (uint32_t c : corners) EXPECT_EQ(t.face_edges[c], e);
            }
            for (uint32_t v = 0; v < t.vertex_count; ++v) {
                const auto corners = t.corners_of_vertex(v), edges = t.edges_of_vertex(v);
                ASSERT_EQ(corners.size(), corners_of_vertices[v]);
                for (uint32_t c : corners) EXPECT_EQ(t.face_vertices[c], v);
                for (uint32_t e : edges) {
                    EXPECT_TRUE(t.edge_vertices[2 * e] == v || t.edge_vertices[2 * e + 1] == v);
                }
                if (!t.vertex_manifold[v] || corners.empty()) continue;
                // Corner i lies between edges i and i + 1.
                EXPECT_TRUE(edges.size() == corners.size() || edges.size() == corners.size() + 1);
                for (size_t i = 0; i < corners.size(); ++i) {
                    EXPECT_EQ(t.face_edges[corners[i]], edges[i]);
                    EXPECT_EQ(t.face_edges[t.previous_corner(corners[i])], edges[(i + 1) % edges.size()]);
                }
            }
        }
    }
}

TEST(Refinement, corners_of_base_edges_ascend) {
    for (const TestMesh& mesh :
         {make_cube(), make_grid(3, 3), make_book(4, false), make_triangle_torus(4, 4)}) {
        const Refinement refinement = refine(mesh, 0);
        for (uint32_t l = 0; l < 1; ++l) {
            uint32_t wrong = 0;
            for (uint32_t e = 0; e < refinement.levels[l].edge_count; ++e) {
                const auto corners = refinement.levels[l].corners_of_edge(e);
                wrong += !std::is_sorted(corners.begin(), corners.end());
            }
            EXPECT_EQ(wrong, 0u) << "of " << refinement.levels[l].edge_count << " edges of level " << l;
        }
    }
}

TEST(Refinement, children_are_where_the_header_says) {
    const TestMesh shapes[] = {make_prism(5), [] {
                                   TestMesh mesh = make_icosahedron();
                                   mesh.options.scheme = Scheme::loop;
                                   return mesh;
                               }()};
    for (const TestMesh& mesh : shapes) {
        const Refinement refinement = refine(mesh, 1);
        const Topology &parent = refinement.levels[0], &child = refinement.levels[1];
        const bool loop = mesh.options.scheme == Scheme::loop;
        uint32_t child_face = 0;
        for (uint32_t f = 0; f < parent.face_count; ++f) {
            const auto vertices = parent.vertices_of_face(f), edges = parent.edges_of_face(f);
            for (size_t c = 0; c < vertices.size(); ++c, ++child_face) {
                const auto corners = child.vertices_of_face(child_face);
                const std::set<uint32_t> found(corners.begin(), corners.end());
                std::set<uint32_t> expected = {
                    child_of_vertex(vertices[c]), child_of_edge(parent, edges[c]),
                    child_of_edge(parent, edges[(c + vertices.size() - 1) % vertices.size()])};
                if (!loop) expected.insert(child_of_face(parent, f));
                EXPECT_EQ(found, expected);
            }
            if (loop) {
                const auto corners = child.vertices_of_face(child_face++);
                for (uint32_t e : edges)
                    EXPECT_EQ(std::count(corners.begin(), corners.end(), child_of_edge(parent, e)), 1);
            }
        }
    }
}

TEST(Refinement, level_zero_is_the_control_mesh) {
    const TestMesh mesh = make_prism(6);
    const Refinement refinement = refine(mesh, 0);
    ASSERT_EQ(refinement.level_count(), 1u);
    EXPECT_TRUE(std::equal(mesh.face_vertices.begin(), mesh.face_vertices.end(),
                           refinement.last().face_vertices.begin(), refinement.last().face_vertices.end()));
}

TEST(Refinement, the_last_level_is_partial_unless_asked_for) {
    const Topology last = refine(make_cube(), 2, false).last();
    EXPECT_FALSE(last.face_vertices.empty());
    EXPECT_FALSE(last.vertex_rules.empty());
    EXPECT_TRUE(last.face_edges.empty());
    EXPECT_TRUE(last.vertex_edges.empty());
}

TEST(Refinement, refuses_levels_past_the_largest) {
    const auto control = ControlMesh::create(make_cube().description());
    ASSERT_TRUE(control);
    const auto result = build_refinement(*control, {kMaxRefinementLevel + 1, false});
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, ErrorCode::invalid_argument);
}

// The same surface with vertices renumbered, faces in another order and every face begun at another corner.
TestMesh relabel(const TestMesh& mesh, uint64_t seed, std::vector<uint32_t>& new_vertex) {
    RandomNumbers random(seed);
    auto shuffled = [&](uint32_t count) {
        std::vector<uint32_t> order(count);
        for (uint32_t i = 0; i < count; ++i) order[i] = i;
        for (uint32_t i = count; i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
        return order;
    };
    new_vertex = shuffled(mesh.vertex_count);
    std::vector<size_t> begins = {0};
    for (uint32_t size : mesh.face_sizes) begins.push_back(begins.back() + size);
    TestMesh result;
    result.options = mesh.options;
    result.vertex_count = mesh.vertex_count;
    result.positions.resize(mesh.positions.size());
    for (size_t v = 0; v < mesh.vertex_count; ++v) {
        for (size_t axis = 0; axis < 3; ++axis)
            result.positions[3 * new_vertex[v] + axis] = mesh.positions[3 * v + axis];
    }
    for (uint32_t f : shuffled(mesh.face_count())) {
        const uint32_t size = mesh.face_sizes[f], turn = random.below(size);
        std::vector<uint32_t> face;
        for (uint32_t c = 0; c < size; ++c)
            face.push_back(new_vertex[mesh.face_vertices[begins[f] + (c + turn) % size]]);
        result.add_face(face);
    }
    for (uint32_t i : shuffled(static_cast<uint32_t>(mesh.crease_sharpness.size()))) {
        const double sharpness = static_cast<double>(mesh.crease_sharpness[i]);
        result.add_crease(new_vertex[mesh.creases[2 * i + 1]], new_vertex[mesh.creases[2 * i]], sharpness);
    }
    for (size_t i = 0; i < mesh.corners.size(); ++i) {
        result.add_corner(new_vertex[mesh.corners[i]], static_cast<double>(mesh.corner_sharpness[i]));
    }
    return result;
}

std::vector<double> refined_points(const TestMesh& mesh, uint32_t level) {
    const Refinement refinement = refine(mesh, level);
    const auto table = build_stencil_table<double>(refinement, level);
    EXPECT_TRUE(table);
    std::vector<double> result(size_t{3} * table->row_count());
    apply_stencil_table<double>(*table, mesh.positions_double(), result, 3);
    return result;
}

// True when the points are the same set: each has a partner within the tolerance.
bool same_point_sets(const std::vector<double>& a, const std::vector<double>& b, double tolerance) {
    if (a.size() != b.size()) return false;
    // Buckets of a width far above the tolerance; a point is looked for in its own and the neighbouring ones.
    const double width = 1e-3;
    std::multimap<int64_t, size_t> buckets;
    for (size_t i = 0; i < b.size(); i += 3)
        buckets.insert({static_cast<int64_t>(std::floor(b[i] / width)), i});
    std::vector<uint8_t> taken(b.size(), 0);
    for (size_t i = 0; i < a.size(); i += 3) {
        const auto bucket = static_cast<int64_t>(std::floor(a[i] / width));
        bool found = false;
        for (auto it = buckets.lower_bound(bucket - 1);
             it != buckets.end() && it->first <= bucket + 1 && !found; ++it) {
            const size_t j = it->second;
            found = !taken[j];
            for (size_t axis = 0; axis < 3; ++axis)
                found = found && std::abs(a[i + axis] - b[j + axis]) <= tolerance;
            if (found) taken[j] = 1;
        }
        if (!found) return false;
    }
    return true;
}

TEST(Refinement, does_not_depend_on_numbering) {
    for (const TestMesh& mesh : some_shapes(11)) {
        // A repeated crease depends on the order, and left-handed faces keep their first corner.
        if (mesh.left_handed || !mesh.holes.empty()) continue;
        SCOPED_TRACE(mesh.name);
        std::vector<uint32_t> map;
        const TestMesh other = relabel(mesh, 5, map);
        const std::vector<double> a = refined_points(mesh, 2), b = refined_points(other, 2);
        for (size_t v = 0; v < mesh.vertex_count; ++v) {  // children of vertices keep their indices
            for (size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(a[3 * v + axis], b[3 * map[v] + axis], 1e-12);
        }
        EXPECT_TRUE(same_point_sets(a, b, 1e-12));
    }
}

TEST(Refinement, point_set_comparison_can_fail) {
    std::vector<double> a = refined_points(make_cube(), 2), b = a;
    std::rotate(b.begin(), b.begin() + 30, b.end());
    EXPECT_TRUE(same_point_sets(a, b, 1e-12));
    b[17] += 1e-11;
    EXPECT_FALSE(same_point_sets(a, b, 1e-12));
}

TEST(Refinement, does_not_depend_on_orientation) {
    for (const TestMesh& mesh : {make_cube(), make_grid(3, 2), make_prism(5), make_quad_star(5, 2)}) {
        TestMesh reversed = mesh;
        reversed.left_handed = true;  // reverses every face
        EXPECT_TRUE(same_point_sets(refined_points(mesh, 2), refined_points(reversed, 2), 1e-12));
    }
}

TEST(Refinement, does_not_depend_on_the_number_of_threads) {
    for (const TestMesh& mesh : {make_torus(12, 10), random_mesh(3), random_mesh(8)}) {
        std::vector<Refinement> results;
        for (size_t threads : {1u, 2u, 16u}) {
            const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
            results.push_back(refine(mesh, 4));
        }
        for (size_t i = 1; i < results.size(); ++i) {
            const Topology &a = results[0].last(), &b = results[i].last();
            EXPECT_TRUE(std::equal(a.face_vertices.begin(), a.face_vertices.end(), b.face_vertices.begin(),
                                   b.face_vertices.end()));
            EXPECT_TRUE(std::equal(a.face_edges.begin(), a.face_edges.end(), b.face_edges.begin(),
                                   b.face_edges.end()));
            EXPECT_TRUE(std::equal(a.vertex_edges.begin(), a.vertex_edges.end(), b.vertex_edges.begin(),
                                   b.vertex_edges.end()));
            EXPECT_TRUE(std::equal(a.edge_sharpness.begin(), a.edge_sharpness.end(), b.edge_sharpness.begin(),
                                   b.edge_sharpness.end()));
        }
    }
}

TEST(Refinement, sharpness_decays_as_told) {
    TestMesh mesh = make_torus(6, 4);
    for (uint32_t i = 0; i < 6; ++i) mesh.add_crease(4 * i, 4 * ((i + 1) % 6), 2.5);
    mesh.add_crease_path({5, 6}, 10);
    mesh.add_corner(3, 1.25);
    const Refinement refinement = refine(mesh, 4);
    const float expected[] = {2.5f, 1.5f, 0.5f, 0.0f, 0.0f};
    for (uint32_t l = 0; l <= 4; ++l) {
        uint32_t finite = 0, infinite = 0;
        for (float s : refinement.levels[l].edge_sharpness) {
            finite += s > 0 && s == expected[l];
            infinite += is_infinite(s);
        }
        EXPECT_EQ(finite, expected[l] > 0 ? 6u << l : 0u);
        EXPECT_EQ(infinite, 1u << l);
        EXPECT_EQ(refinement.levels[l].vertex_sharpness[3], l == 0 ? 1.25f : l == 1 ? 0.25f : 0.0f);
    }
    EXPECT_EQ(refinement.levels[0].vertex_rules[0], VertexRule::crease);
    EXPECT_EQ(refinement.levels[0].vertex_rules[3], VertexRule::corner);
    EXPECT_EQ(refinement.levels[0].vertex_rules[5], VertexRule::dart);
    EXPECT_EQ(refinement.levels[4].vertex_rules[0], VertexRule::smooth);
}

TEST(Refinement, face_varying_levels_have_the_faces_of_the_mesh) {
    TestMesh mesh = make_grid(4, 4);
    std::vector<uint32_t> regions(16);
    for (uint32_t f = 0; f < 16; ++f) regions[f] = (f / 2) % 2;
    add_channel_by_region(mesh, FaceVaryingInterpolation::none, regions);
    const auto control = ControlMesh::create(mesh.description());
    ASSERT_TRUE(control);
    const auto base = build_refinement(*control, {3, false});
    const auto channel = build_face_varying_refinement(*control, 0, {3, false});
    ASSERT_TRUE(base && channel);
    EXPECT_EQ(channel->control_count, mesh.channels[0].value_count);
    for (uint32_t l = 0; l <= 3; ++l) {
        EXPECT_EQ(channel->levels[l].face_count, base->levels[l].face_count);
        EXPECT_GT(channel->levels[l].vertex_count, base->levels[l].vertex_count);
    }
}

}  // namespace
}  // namespace limn::test
