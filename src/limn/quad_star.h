// Quads of refined Catmull-Clark meshes, told by the star of one corner. Not part of the public interface.
//
// With uniform creasing a quad of level 1 or deeper that lies among fans of faces is irregular at one corner, and where
// its face was no quad at the opposite one. So a few numbers say what a walk around it finds (neighborhood.h), and its
// ring is read from the base level: level 1 is not made.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "limn/patch_points.h"
#include "limn/topology.h"

namespace limn {

/// The star of corner 0 of a quad, counter-clockwise. Edge own leads to corner 1, edge own + 1 to corner 3.
struct QuadStar {
    std::vector<float> sharpness;  ///< of the edges: as many as faces, or one more where the star is open
    float corner_sharpness = 0;
    uint32_t face_count = 0;
    uint32_t own = 0;       ///< the quad's own face, between edges own and own + 1; 0 where the star is closed
    uint32_t opposite = 4;  ///< faces around corner 2, which is smooth

    uint32_t edge_count() const { return static_cast<uint32_t>(sharpness.size()); }
    bool is_closed() const { return sharpness.size() == face_count; }
    uint32_t edge_after(uint32_t i, uint32_t steps) const { return (i + steps) % edge_count(); }
    uint32_t face_after(uint32_t i, uint32_t steps) const { return (i + steps) % face_count; }
    bool has_finite_sharpness() const;
    bool operator==(const QuadStar&) const = default;
    /// All that the surface depends on, in numbers.
    void append_to(std::vector<uint32_t>& key) const;
};

/// Where the points of a star's quad stand in its ring: the corner, the ends of the edges, the vertices across the
/// faces; then what lies beyond the ends of edges own ("next") and own + 1 ("previous"), and around corner 2.
struct StarRing {
    uint32_t edge_count;
    /// Beyond the end, the other neighbour of corner 2 there (one for both where `opposite` is 3), and across the edge.
    uint32_t beyond_next, side_next, beyond_previous, side_previous, far_next, far_previous;
    uint32_t rest;  ///< of the fan around corner 2, in turn: across a face, at the end of an edge, ..., across a face
    uint32_t size;
    bool has_far_next, has_far_previous;  ///< unless the star ends there

    explicit StarRing(const QuadStar& star);
    static constexpr uint32_t corner() { return 0; }
    uint32_t edge(uint32_t i) const { return 1 + i; }
    uint32_t face(uint32_t i) const { return 1 + edge_count + i; }
};

/// Leaves out what lies beyond infinitely sharp edges on both sides of the quad, if nothing changes from level to
/// level: the surface does not depend on it. `ring` keeps what stays.
void cut_to_sector(QuadStar& star, std::vector<uint32_t>& ring);

/// The star of the quad's child at corner 0.
QuadStar child_star(const QuadStar& star);

/// Of a quad that is one patch. Once cut to its sector.
std::optional<QuadPattern> find_pattern(const QuadStar& star);
QuadNet star_net(const QuadStar& star, const QuadPattern& pattern, const std::vector<uint32_t>& ring);

/// Whether the quads of level 1 may be told like this.
bool has_quad_stars(const Topology& base);

/// A quad of level 1: at the corner that it is a child of.
struct BaseQuad {
    QuadStar star;
    std::vector<uint32_t> ring;          ///< vertices of level 1
    uint32_t corner = 0;                 ///< of the quad, counted from where the base corner is, that is the star's
    std::optional<QuadPattern> pattern;  ///< where it is one patch,
    QuadNet net;                         ///< and of what; a regular one has no star
};
/// False where the faces around are no fans, or a vertex would be in the ring of a star twice.
bool find_base_quad(const Topology& base, uint32_t corner, BaseQuad& out);

}  // namespace limn
