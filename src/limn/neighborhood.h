// What the refined surface over one face depends on: the faces around it, in a canonical order. Faces with
// equal neighbourhoods have equal stencils up to the control points that they refer to. Not part of the
// public interface.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "limn/index_map.h"
#include "limn/topology.h"

namespace limn {

/// Where a walk around a face starts, and which way it goes: its i-th corner is (rotation + i) mod n, or with
/// `mirrored` (rotation - i) mod n.
struct Orientation {
    uint32_t rotation = 0;
    bool mirrored = false;

    uint32_t corner(uint32_t i, uint32_t n) const { return (mirrored ? rotation + n - i : rotation + i) % n; }
};

/// What a walk around a face meets: first the face's own vertices, then, corner by corner, those of the faces
/// around. Reused to save allocations.
struct Neighborhood {
    std::vector<uint32_t> ring;       ///< base vertices, numbered in the order of the walk
    std::vector<uint32_t> faces;      ///< the face, then the others around its vertices
    std::vector<uint32_t> signature;  ///< sizes, local vertices and sharpness met on the walk
    IndexMap map, face_map;

    uint32_t local(uint32_t vertex) {
        const uint32_t i = map.find_or_insert(vertex, static_cast<uint32_t>(ring.size()));
        if (i == ring.size()) ring.push_back(vertex);
        return i;
    }
};

/// The base level to walk on. `uncut` is the mesh that a face-varying base with Chaikin creasing was cut
/// from: then walks take in what lies beyond seams; else null. `with_tangents` tells apart what only tangents
/// depend on: where stars start, which decides the sides that they are taken on, and handedness.
struct WalkOptions {
    const Topology& base;
    const Topology* uncut = nullptr;
    bool with_tangents = false;
    bool list_faces = true;  ///< fill in Neighborhood::faces, but for the face itself
};

/// Two faces of one mesh whose signatures are equal have equal stencils, ring position by ring position, at
/// every level.
void walk_around(const WalkOptions& options, uint32_t f, Orientation orientation, Neighborhood& out);

/// The same ring, and 128 bits that two faces of one topology have in common where their signatures are
/// equal, more quickly and without signature and faces. False, with nothing done, where it is no plain
/// matter: where faces differ in size, stars are no fans, sharpness is Chaikin's or values depend on others.
/// `regular[v]` as find_regular_vertices makes it.
bool walk_around_fans(const Topology& t, uint32_t f, uint32_t rotation, const std::vector<uint8_t>& regular,
                      Neighborhood& out, std::array<uint64_t, 2>& hash);

/// The orientation that alike faces, and mirror images, share: of the walks from a distinguished corner, one
/// each way, the one whose signature has the smaller hash. `hash` receives it; `scratch` is scratch.
Orientation choose_orientation(const WalkOptions& options, uint32_t f, Neighborhood& scratch,
                               std::array<uint64_t, 2>& hash);

/// 128 bits of the signature.
std::array<uint64_t, 2> hash_signature(const std::vector<uint32_t>& signature);

}  // namespace limn
