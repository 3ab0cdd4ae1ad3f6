#include "limn/schemes/t_mesh_split.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace limn {
namespace {

constexpr double kTolerance = 1e-9;       ///< of a side's length: positions that are the same
constexpr size_t kMostCutsOfEdge = 1024;  ///< edges carried on meet long before, unless they never do

/// Where a vertex of a side lies: its distance from the side's beginning.
struct SidePoint {
    double position;
    uint32_t vertex;
};

class TMeshSplitter {
  public:
    TMeshSplitter(const Topology& t, std::span<const uint8_t> straight, std::span<const double> lengths)
        : t_(t), straight_(straight), lengths_(lengths), cuts_(t.edge_count), corners_(t.face_count) {}

    Result<TMeshSplit> split() {
        for (uint32_t f = 0; f < t_.face_count; ++f)
            if (auto ok = check_rectangle(f); !ok) return ok.error();
        for (bool changed = true; changed;) {
            changed = false;
            for (uint32_t f = 0; f < t_.face_count; ++f)
                for (uint32_t side = 0; side < 4; ++side) changed |= copy_cuts(f, side);
            for (const auto& cuts : cuts_)
                if (cuts.size() > kMostCutsOfEdge)
                    return Error{ErrorCode::too_large, "edges carried on from T-junctions do not end"};
        }
        first_cut_.push_back(t_.vertex_count);
        for (const auto& cuts : cuts_) first_cut_.push_back(first_cut_.back() + static_cast<uint32_t>(cuts.size()));
        vertex_count_ = first_cut_.back();
        for (uint32_t f = 0; f < t_.face_count; ++f) add_grid(f);
        ControlMeshDescription description;
        description.options = t_.options;
        description.vertex_count = vertex_count_;
        const std::vector<uint32_t> sizes(face_vertices_.size() / 4, 4);
        description.face_sizes = sizes;
        description.face_vertices = face_vertices_;
        auto mesh = ControlMesh::create(description);
        if (!mesh) return mesh.error();
        out_.mesh = std::move(*mesh);
        return std::move(out_);
    }

  private:
    uint32_t side_end(uint32_t f, uint32_t side) const { return corners_[f][(side + 1) % 4]; }

    double side_length(uint32_t f, uint32_t side) const {
        double length = 0;
        uint32_t c = corners_[f][side];
        do length += lengths_[t_.face_edges[c]];
        while ((c = t_.next_corner(c)) != side_end(f, side));
        return length;
    }

    Result<void> check_rectangle(uint32_t f) {
        uint32_t count = 0;
        for (uint32_t c = t_.face_begin(f); c < t_.face_begin(f) + t_.size_of_face(f); ++c) {
            if (straight_[c] != 0) continue;
            if (count < 4) corners_[f][count] = c;
            ++count;
        }
        auto refuse = [&](const char* cause) {
            return Error{ErrorCode::invalid_argument, "face " + std::to_string(f) + " of the T-mesh " + cause, f};
        };
        if (count != 4) return refuse("has not four corners of its own");
        for (uint32_t side = 0; side < 2; ++side) {
            const double a = side_length(f, side), b = side_length(f, side + 2);
            if (std::abs(a - b) > kTolerance * a) return refuse("has opposite sides of unlike length");
        }
        return {};
    }

    /// Positions of the cut vertices of the edge at corner c, in the direction of its face; and their numbers.
    std::vector<SidePoint> cuts_at(uint32_t c, double from) const {
        const uint32_t e = t_.face_edges[c];
        const auto n = static_cast<uint32_t>(cuts_[e].size());
        std::vector<SidePoint> points;
        for (uint32_t i = 0; i < n; ++i) {
            const bool forward = t_.end_at_corner(c) == 0;
            const uint32_t k = forward ? i : n - 1 - i;
            points.push_back({from + (forward ? cuts_[e][k] : lengths_[e] - cuts_[e][k]),
                              first_cut_.empty() ? kInvalidIndex : first_cut_[e] + k});
        }
        return points;
    }

    /// All vertices of a side, both ends included.
    std::vector<SidePoint> side_points(uint32_t f, uint32_t side) const {
        std::vector<SidePoint> points;
        double at = 0;
        uint32_t c = corners_[f][side];
        do {
            points.push_back({at, t_.face_vertices[c]});
            for (const SidePoint& cut : cuts_at(c, at)) points.push_back(cut);
            at += lengths_[t_.face_edges[c]];
        } while ((c = t_.next_corner(c)) != side_end(f, side));
        points.push_back({at, t_.face_vertices[c]});
        return points;
    }

    /// Cuts a side where a vertex lies opposite. Whether it did.
    bool copy_cuts(uint32_t f, uint32_t side) {
        const double length = side_length(f, side), tolerance = kTolerance * length;
        const auto own = side_points(f, side);  // ascending; new ones lie apart from each other as they do opposite
        bool changed = false;
        for (const SidePoint& opposite : side_points(f, (side + 2) % 4)) {
            const double position = length - opposite.position;
            const auto near = std::lower_bound(own.begin(), own.end(), position - tolerance,
                                               [](const SidePoint& p, double x) { return p.position < x; });
            if (near != own.end() && near->position <= position + tolerance) continue;
            cut_side(f, side, position);
            changed = true;
        }
        return changed;
    }

    void cut_side(uint32_t f, uint32_t side, double position) {
        uint32_t c = corners_[f][side];
        while (position > lengths_[t_.face_edges[c]]) {
            position -= lengths_[t_.face_edges[c]];
            c = t_.next_corner(c);
        }
        const uint32_t e = t_.face_edges[c];
        const double offset = t_.end_at_corner(c) == 0 ? position : lengths_[e] - position;
        cuts_[e].insert(std::upper_bound(cuts_[e].begin(), cuts_[e].end(), offset), offset);
    }

    /// A face becomes a grid, as many quads each way as its sides have parts.
    void add_grid(uint32_t f) {
        const auto bottom = side_points(f, 0), right = side_points(f, 1);
        auto top = side_points(f, 2), left = side_points(f, 3);
        std::reverse(top.begin(), top.end());
        std::reverse(left.begin(), left.end());
        const auto columns = static_cast<uint32_t>(bottom.size()) - 1, rows = static_cast<uint32_t>(left.size()) - 1;
        auto vertex = [&](uint32_t i, uint32_t j) {
            if (j == 0) return bottom[i].vertex;
            if (j == rows) return top[i].vertex;
            if (i == 0) return left[j].vertex;
            return i == columns ? right[j].vertex : vertex_count_ + (j - 1) * (columns - 1) + i - 1;
        };
        for (uint32_t j = 0; j < rows; ++j)
            for (uint32_t i = 0; i < columns; ++i) {
                const double u = bottom[i + 1].position - bottom[i].position;
                const double v = right[j + 1].position - right[j].position;
                face_vertices_.insert(face_vertices_.end(),
                                      {vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
                out_.intervals.insert(out_.intervals.end(), {u, v, u, v});
                for (const bool inside : {j > 0, i + 1 < columns, j + 1 < rows, i > 0})
                    out_.is_inside.push_back(inside);
            }
        vertex_count_ += (columns - 1) * (rows - 1);
    }

    const Topology& t_;
    std::span<const uint8_t> straight_;
    std::span<const double> lengths_;
    std::vector<std::vector<double>> cuts_;         // of each edge, from its first vertex
    std::vector<std::array<uint32_t, 4>> corners_;  // of each face, its own
    std::vector<uint32_t> first_cut_;               // number of the first cut's vertex; once all are there
    uint32_t vertex_count_ = 0;
    std::vector<uint32_t> face_vertices_;
    TMeshSplit out_;
};

}  // namespace

Result<TMeshSplit> split_t_mesh(const Topology& t, std::span<const uint8_t> straight, std::span<const double> lengths) {
    return TMeshSplitter(t, straight, lengths).split();
}

}  // namespace limn
