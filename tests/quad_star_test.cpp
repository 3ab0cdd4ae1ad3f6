// Quads of level 1 told by stars of the base level, against level 1 itself.
#include "limn/quad_star.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "limn/plan.h"
#include "limn/topology_build.h"
#include "shapes/shapes.h"

namespace limn::test {
namespace {

using Vertices = std::multiset<uint32_t>;
Vertices vertices_of(const std::vector<uint32_t>& ring) {
    return {ring.begin(), ring.end()};
}

/// A mesh, its level 1, and how many quads of that were told by stars and as patches.
struct Levels {
    Topology base, child;
    uint32_t stars = 0, patches = 0;

    explicit Levels(const TestMesh& mesh) {
        const auto control = ControlMesh::create(mesh.description());
        EXPECT_TRUE(control);
        base = build_topology(*control);
        child = refine_once(base, true);
    }
    uint32_t slot(uint32_t corner) const {
        const uint32_t face = base.face_of_corner(corner);
        return base.size_of_face(face) == 4 ? corner - base.face_begin(face) : 0;
    }
    void expect_star(const BaseQuad& quad, uint32_t face, uint32_t corner) {
        ++stars;
        const QuadStar& star = quad.star;
        const StarRing at(star);
        ASSERT_EQ(quad.ring.size(), at.size);
        PatchPoints patch;
        EXPECT_FALSE(find_patch_points(child, face, false, patch));
        // The quad's own vertices.
        const uint32_t places[4] = {StarRing::corner(), at.edge(star.own), at.face(star.own),
                                    at.edge(star.edge_after(star.own, 1))};
        for (uint32_t k = 0; k < 4; ++k)
            EXPECT_EQ(quad.ring[places[k]], child.face_vertices[4 * face + (corner + k) % 4]);
        for (uint32_t i = 0; i < star.edge_count(); ++i) {
            const uint32_t edge = find_edge(child, quad.ring[0], quad.ring[at.edge(i)]);
            ASSERT_NE(edge, kInvalidIndex);
            EXPECT_EQ(child.edge_sharpness[edge], star.sharpness[i]);
        }
        Neighborhood walk;
        walk_around({child}, face, {corner, false}, walk);
        const Vertices ours = vertices_of(quad.ring), all = vertices_of(walk.ring);
        if (star.is_closed()) {
            EXPECT_EQ(ours, all);
        } else {
            EXPECT_TRUE(std::includes(all.begin(), all.end(), ours.begin(), ours.end()));
        }
    }
    void expect_patch(const BaseQuad& quad, uint32_t face, uint32_t corner) {
        ++patches;
        PatchPoints patch;
        ASSERT_TRUE(find_patch_points(child, face, false, patch));
        LocalPatch ours, theirs;
        make_local(quad.net, *quad.pattern, ours);
        make_local(patch, theirs);
        EXPECT_EQ(ours.signature, theirs.signature);
        EXPECT_EQ(vertices_of(ours.ring), vertices_of(theirs.ring));
        if (quad.pattern->is_regular()) return;  // told from another corner
        EXPECT_EQ(ours.ring, theirs.ring);
        EXPECT_EQ((corner + ours.rotation) % 4, theirs.rotation);
    }
    void compare() {
        for (uint32_t c = 0; c < base.corner_count(); ++c) {
            BaseQuad quad;
            if (!find_base_quad(base, c, quad)) continue;
            const uint32_t corner = (slot(c) + quad.corner) % 4;
            if (quad.pattern)
                expect_patch(quad, c, corner);
            else
                expect_star(quad, c, corner);
        }
    }
};

TEST(QuadStar, TellsQuadsOfLevel1) {
    uint32_t stars = 0, patches = 0;
    for (const TestMesh& mesh : all_shapes()) {
        Levels levels(mesh);
        if (!has_quad_stars(levels.base)) continue;
        SCOPED_TRACE(mesh.name);
        levels.compare();
        stars += levels.stars;
        patches += levels.patches;
    }
    EXPECT_GT(stars, 10000u);
    EXPECT_GT(patches, 10000u);
}

TEST(QuadStar, IsLeftToWalksWhereAVertexWouldBeInTheRingTwice) {
    // Around either vertex of two faces, edges of level 1 are met from both sides.
    TestMesh pillow;
    for (uint32_t i = 0; i < 4; ++i) pillow.add_vertex(i & 1, i >> 1, 0);
    pillow.add_face({0, 1, 3, 2});
    pillow.add_face({0, 2, 3, 1});
    const Levels levels(pillow);
    BaseQuad quad;
    for (uint32_t c = 0; c < 8; ++c) EXPECT_FALSE(find_base_quad(levels.base, c, quad));
}

TEST(QuadStar, EndsWhereItsSectorDoes) {
    // An infinitely sharp crease straight through the middle: each side of it is as a boundary.
    TestMesh grid = make_grid(4, 4);
    for (uint32_t i = 0; i < 4; ++i) grid.add_crease(10 + i, 11 + i, 10);
    grid.add_crease(12, 17, 10);  // and one that ends there: the sectors are of one face and of two
    const Levels levels(grid);
    BaseQuad quad;
    std::multiset<uint32_t> face_counts;
    for (const uint32_t c : levels.base.corners_of_vertex(12)) {
        ASSERT_TRUE(find_base_quad(levels.base, c, quad));
        ASSERT_EQ(quad.pattern.has_value(), quad.star.face_count == 1);
        face_counts.insert(quad.star.face_count);
    }
    EXPECT_EQ(face_counts, (std::multiset<uint32_t>{1, 1, 2, 2}));
}

}  // namespace
}  // namespace limn::test
