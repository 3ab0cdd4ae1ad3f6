// The layout of baked files (.limn). Not part of the public interface.
//
// A file is a header, the directory (numbers, then an entry for each array), and the arrays, each from a multiple of
// 64 bytes, zeros between. What the numbers and arrays are, and their order, is what visit_mesh goes through: it is
// the format, and writes, reads and compares. Whoever changes it, or an element that it names, changes kBakedVersion.
#pragma once

#include <limits>

#include "limn/baked_mesh.h"

namespace limn {

inline constexpr uint32_t kBakedVersion = 2;
inline constexpr uint32_t kBakedByteOrder = 0x01020304;
inline constexpr size_t kBakedAlignment = 64;
/// As in PNG: not text, and told from what a transfer as text makes of it.
inline constexpr char kBakedMagic[8] = {'\x89', 'L', 'I', 'M', 'N', '\r', '\n', '\x1a'};

struct BakedHeader {
    char magic[8];
    uint32_t byte_order;
    uint32_t version;
    uint64_t checksum[2];  ///< XXH3, 128 bits, of all that follows it
    uint64_t file_bytes;
    uint64_t key[2];
    uint32_t value_count;  ///< of 8 bytes each
    uint32_t array_count;
};
static_assert(sizeof(BakedHeader) == 64);
inline constexpr size_t kChecksumEnd = 32;

struct BakedArray {
    uint64_t offset;  ///< from the beginning of the file
    uint64_t count;
    uint64_t element_bytes;
};
static_assert(sizeof(BakedArray) == 24);

// `visit` has value(number, largest), array(array) and list(vector, body). Tables may be const or not.

template <class T>
uint64_t largest_of(const T&) {
    return std::numeric_limits<T>::max();
}

void visit_options(auto& visit, auto& o) {
    visit.value(o.scheme, 3);
    visit.value(o.boundary, 2);
    visit.value(o.creasing, 1);
    visit.value(o.triangles, 1);
    visit.value(o.opensubdiv_compatible, 1);
}

void visit_indices(auto& visit, auto& list) {
    visit.value(list.narrow, 1);
    visit.array(list.words);
}

void visit_patches(auto& visit, auto& t) {
    visit_options(visit, t.options);
    visit.value(t.end_cap, 2);
    for (auto* count : {&t.control_count, &t.first_refined, &t.refined_count}) visit.value(*count, largest_of(*count));
    visit.array(t.point_runs);
    visit_indices(visit, t.point_indices);
    visit.array(t.point_weights);
    visit.array(t.surfaces);
    visit_indices(visit, t.ring_points);
    visit.array(t.plans);
    visit.array(t.plan_identities);
    visit.array(t.plan_nodes);
    visit.array(t.plan_points);
    visit.array(t.plan_weights);
    visit.array(t.ptex_surfaces);
}

void visit_tessellation(auto& visit, auto& t) {
    visit_options(visit, t.options);
    for (auto* count : {&t.face_count, &t.rate_edge_count, &t.mesh_edge_count, &t.row_count, &t.corner_count})
        visit.value(*count, largest_of(*count));
    for (auto* array : {&t.faces, &t.rows, &t.corners, &t.rate_edges, &t.corner_copies, &t.row_copies, &t.instance_faces})
        visit.array(*array);
}

void visit_grid(auto& visit, auto& t) {
    for (auto* count : {&t.rate, &t.value_count, &t.ptex_count, &t.samples_per_face, &t.faces_per_pass})
        visit.value(*count, largest_of(*count));
    visit.value(t.relative, 1);
    visit.value(t.total_sample_count, 0xffffffffu);
    visit.array(t.classes);
    visit.array(t.placements);
    visit.array(t.placement_samples);
    visit.array(t.lattices);
    visit.array(t.surfaces);
    visit.array(t.slots);
    visit.array(t.weights);
}

void visit_trees(auto& visit, auto& t) {
    visit_options(visit, t.options);
    visit.value(t.max_rate, 128);
    visit.value(t.relative, 1);
    visit.value(t.tree_count, largest_of(t.tree_count));
    visit.array(t.nodes);
    visit.array(t.leaf_points);
    visit.array(t.surfaces);
    visit.array(t.ptex_surfaces);
    visit_grid(visit, t.local_points);
}

void visit_stencils(auto& visit, auto& t) {
    visit.value(t.source_count, largest_of(t.source_count));
    visit.array(t.offsets);
    visit.array(t.indices);
    visit.array(t.weights);
    visit.array(t.tangent1_weights);
    visit.array(t.tangent2_weights);
}

void visit_mesh(auto& visit, auto& mesh) {
    visit.value(mesh.face_count, largest_of(mesh.face_count));
    visit_patches(visit, mesh.patches);
    visit_tessellation(visit, mesh.tessellation);
    visit_trees(visit, mesh.trees);
    visit.array(mesh.positions);
    visit.array(mesh.edges);
    visit.list(mesh.channels, [&](auto& channel) {
        visit.value(channel.width, 4);
        visit.array(channel.values);
        visit_patches(visit, channel.patches);
        visit_trees(visit, channel.trees);
    });
    visit.list(mesh.grids, [&](auto& grid) { visit_grid(visit, grid); });
    visit.list(mesh.refined, [&](auto& refined) {
        visit.value(refined.level, 7);
        visit.value(refined.source_count, largest_of(refined.source_count));
        visit.array(refined.ring_points);
        visit_grid(visit, refined.grid);
    });
    visit.list(mesh.stencils, [&](auto& stencils) {
        visit.value(stencils.level, 10);
        visit.value(stencils.limit, 1);
        visit_stencils(visit, stencils.table);
    });
}

}  // namespace limn
