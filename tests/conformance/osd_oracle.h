// OpenSubdiv in double precision, as an oracle. No OpenSubdiv type appears here.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "shapes/shapes.h"

namespace limn::test {

// One row of a stencil table: (control point, weight), ascending and unique; exact zeros are left out.
using SparseRow = std::vector<std::pair<uint32_t, double>>;

class OsdOracle {
  public:
    // Refines uniformly to `level`, the last level with full topology. Null when OpenSubdiv refuses the mesh;
    // `error` then holds what it reported. Warnings count as refusals: a crease along a missing edge is one.
    static std::unique_ptr<OsdOracle> create(const TestMesh& mesh, uint32_t level, std::string* error);
    // What create() would do to the vertices of the last level, without doing it.
    static uint64_t estimate_vertex_count(const TestMesh& mesh, uint32_t level);
    ~OsdOracle();

    uint32_t level_count() const;
    uint32_t vertex_count(uint32_t level) const;
    uint32_t edge_count(uint32_t level) const;
    uint32_t face_count(uint32_t level) const;
    std::vector<uint32_t> face_sizes(uint32_t level) const;
    std::vector<uint32_t> face_vertices(uint32_t level) const;
    std::vector<uint8_t> face_holes(uint32_t level) const;
    std::vector<uint32_t> base_faces(uint32_t level) const;
    std::vector<uint32_t> edge_vertices(uint32_t level) const;  // 2 per edge
    std::vector<float> edge_sharpness(uint32_t level) const;    // 1 per edge
    std::vector<float> vertex_sharpness(uint32_t level) const;
    std::vector<VertexRule> vertex_rules(uint32_t level) const;
    std::vector<uint8_t> vertex_manifold(uint32_t level) const;  // 1 where the faces form one fan
    std::vector<uint32_t> vertex_face_counts(uint32_t level) const;
    std::vector<uint8_t> vertex_boundaries(uint32_t level) const;  // 1 on the boundary

    // Data of every level, level 0 being the input: `width` numbers a vertex.
    using Levels = std::vector<std::vector<double>>;
    Levels refine(std::span<const double> control_values, uint32_t width) const;
    Levels refine_varying(std::span<const double> control_values, uint32_t width) const;
    // Two numbers for each face corner of each level, from two for each value of the channel.
    Levels refine_face_varying(uint32_t channel, std::span<const double> values) const;

    struct Limits {
        std::vector<double> positions;  // 3 per vertex of the last level
        // The same, or empty: OpenSubdiv cannot compute any where a non-manifold vertex is a crease.
        std::vector<double> tangents1, tangents2;
    };
    Limits limits(std::span<const double> control_points) const;
    // Two numbers for each face corner of the last level.
    std::vector<double> face_varying_limits(uint32_t channel, std::span<const double> values) const;

    // Factorised stencils of the vertices of the last level, from the control points.
    std::vector<SparseRow> stencils(bool varying = false) const;
    // The same for all levels from 1, one after the other.
    std::vector<SparseRow> stencils_of_all_levels() const;

  private:
    struct Data;
    explicit OsdOracle(std::unique_ptr<Data> data);
    std::unique_ptr<Data> data_;
};

}  // namespace limn::test
