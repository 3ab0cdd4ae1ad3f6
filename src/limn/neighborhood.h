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

/// The vertices of all faces that touch a face, numbered in order of a walk that starts at its corner
/// `rotation`: first the face's own, then, corner by corner, those of the faces around. Filled by
/// read_neighborhood, reused to save allocations.
struct Neighborhood {
    uint32_t rotation = 0;
    std::vector<uint32_t> ring;       ///< base vertices in walk order
    std::vector<uint32_t> faces;      ///< the face, then the others around its vertices
    std::vector<uint32_t> signature;  ///< sizes, local vertices and sharpness met on the walk
    IndexMap map, face_map;

    uint32_t local(uint32_t vertex) {
        const uint32_t i = map.find_or_insert(vertex, static_cast<uint32_t>(ring.size()));
        if (i == ring.size()) ring.push_back(vertex);
        return i;
    }
};

/// Walks around face f of a base level. `uncut` is the mesh that a face-varying base with Chaikin creasing
/// was cut from: then the walk takes in what lies beyond seams; else null. `with_starts` tells apart where
/// the stars of closed vertices start, which decides the sides that tangents are taken on. Two faces of one
/// mesh whose signatures are equal have equal stencils, ring position by ring position, at every level.
void read_neighborhood(const Topology& base, const Topology* uncut, uint32_t f, bool with_starts,
                       Neighborhood& out);

/// 128 bits of the signature.
std::array<uint64_t, 2> hash_signature(const std::vector<uint32_t>& signature);

}  // namespace limn
