// Points and faces of a child in the making. Not part of the public interface.
#pragma once

#include <algorithm>
#include <initializer_list>
#include <utility>
#include <vector>

#include "limn/parallel.h"
#include "limn/schemes/split.h"
#include "limn/schemes/star.h"

namespace limn {

/// Counts faces, or writes them behind those that others write.
class FaceWriter {
  public:
    FaceWriter() = default;
    FaceWriter(uint32_t* offsets, uint32_t* vertices, uint32_t faces, uint32_t corners)
        : offsets_(offsets), vertices_(vertices), faces_(faces), corners_(corners) {}

    /// The number of the next face.
    uint32_t begin_face() const { return faces_; }
    void add_corner(uint32_t vertex) {
        if (vertices_ != nullptr) vertices_[corners_] = vertex;
        ++corners_;
    }
    void end_face() {
        ++faces_;
        if (offsets_ != nullptr) offsets_[faces_] = corners_;
    }
    void add_face(std::initializer_list<uint32_t> vertices) {
        for (const uint32_t v : vertices) add_corner(v);
        end_face();
    }
    uint32_t faces() const { return faces_; }
    uint32_t corners() const { return corners_; }

  private:
    uint32_t *offsets_ = nullptr, *vertices_ = nullptr;
    uint32_t faces_ = 0, corners_ = 0;
};

class ChildFaces {
  public:
    explicit ChildFaces(SplitMesh& split) : split_(split) {}

    /// `parents` empty: one point for each of `count` elements. The number of the first point.
    uint32_t add_points(Origin origin, uint32_t count, const std::vector<uint32_t>& parents = {}) {
        PointBlock block{origin, points_, count, {}};
        block.parents.allocate(parents.size());
        std::copy(parents.begin(), parents.end(), block.parents.begin());
        split_.blocks.push_back(std::move(block));
        points_ += count;
        return points_ - count;
    }

    /// The faces that body(i, writer) makes for each i < count, in this order, on all cores. Bodies are called twice: to
    /// count, and to write.
    template <class Body>
    void build(const Topology& parent, uint32_t count, bool full, const BuildPart& part, const Body& body) {
        constexpr uint32_t kBlock = 4096;
        std::vector<FaceWriter> totals(count / kBlock + 2);  // before each block
        for_each_block(count, part.part(0, 0.1f), kBlock, [&](uint32_t begin, uint32_t end) {
            FaceWriter& total = totals[begin / kBlock + 1];
            for (uint32_t i = begin; i != end; ++i) body(i, total);
        });
        for (size_t i = 1; i < totals.size(); ++i)
            totals[i] = {nullptr, nullptr, totals[i - 1].faces() + totals[i].faces(),
                         totals[i - 1].corners() + totals[i].corners()};
        Array<uint32_t> offsets, vertices;
        offsets.allocate(size_t{totals.back().faces()} + 1);
        vertices.allocate(totals.back().corners());
        offsets[0] = 0;
        for_each_block(count, part.part(0.1f, 0.3f), kBlock, [&](uint32_t begin, uint32_t end) {
            const FaceWriter& before = totals[begin / kBlock];
            FaceWriter writer(offsets.data(), vertices.data(), before.faces(), before.corners());
            for (uint32_t i = begin; i != end; ++i) body(i, writer);
        });
        if (part.is_cancelled()) return;
        split_.child = topology_of_faces(parent.options, points_, std::move(offsets), std::move(vertices), full,
                                         part.part(0.3f, 1));
        if (full && !part.is_cancelled()) keep_fixed_corners(parent);
    }

  private:
    /// Corners are vertices with one face in the control mesh, whatever meets there later.
    void keep_fixed_corners(const Topology& parent) {
        for (const PointBlock& block : split_.blocks)
            for (uint32_t i = 0; block.origin == Origin::vertex && i < block.count; ++i)
                if (is_fixed_corner(parent, block.parent(i)))
                    split_.child.vertex_rules[block.first + i] = VertexRule::corner;
    }

    SplitMesh& split_;
    uint32_t points_ = 0;
};

}  // namespace limn
