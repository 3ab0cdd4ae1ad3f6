#include "cli/face_cuts.h"

#include <algorithm>
#include <map>
#include <span>
#include <utility>

namespace limn::cli {
namespace {

double squared_distance(const Model& model, uint32_t a, uint32_t b) {
    double sum = 0;
    for (size_t k = 0; k < 3; ++k) {
        const double d = double{model.positions[3 * size_t{a} + k]} - double{model.positions[3 * size_t{b} + k]};
        sum += d * d;
    }
    return sum;
}

/// Points of one kind (positions, texture coordinates) between those of edges and faces.
class Midpoints {
  public:
    Midpoints(std::vector<float>& values, size_t width) : values_(values), width_(width) {}
    uint32_t of_edge(uint32_t a, uint32_t b) {
        const auto [at, added] = edges_.try_emplace(std::minmax(a, b), 0u);
        if (added) at->second = of_points({a, b});
        return at->second;
    }
    template <class Points>
    uint32_t of_points(const Points& points) {
        const auto number = static_cast<uint32_t>(values_.size() / width_);
        for (size_t k = 0; k < width_; ++k) {
            double sum = 0;
            for (const uint32_t p : points) sum += double{values_[width_ * p + k]};
            values_.push_back(static_cast<float>(sum / static_cast<double>(std::size(points))));
        }
        return number;
    }
    uint32_t of_points(std::initializer_list<uint32_t> points) { return of_points<std::initializer_list<uint32_t>>(points); }

  private:
    std::vector<float>& values_;
    size_t width_;
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> edges_;
};

/// The quads of one face's corners.
void append_quads(Midpoints& midpoints, std::span<const uint32_t> corners, std::vector<uint32_t>& out) {
    const size_t n = corners.size();
    std::vector<uint32_t> between(n);
    for (size_t i = 0; i < n; ++i) between[i] = midpoints.of_edge(corners[i], corners[(i + 1) % n]);
    const uint32_t centre = midpoints.of_points(std::vector<uint32_t>(corners.begin(), corners.end()));
    for (size_t i = 0; i < n; ++i) out.insert(out.end(), {corners[i], between[i], centre, between[(i + n - 1) % n]});
}

/// Chains of creases through the midpoints of their edges.
void split_creases(Model& model, Midpoints& midpoints) {
    std::vector<uint32_t> vertices;
    size_t begin = 0;
    for (uint32_t& size : model.crease_sizes) {
        for (size_t i = 0; i < size; ++i) {
            const uint32_t v = model.crease_vertices[begin + i];
            vertices.push_back(v);
            if (i + 1 < size) vertices.push_back(midpoints.of_edge(v, model.crease_vertices[begin + i + 1]));
        }
        begin += size;
        size = 2 * size - 1;
    }
    model.crease_vertices = std::move(vertices);
}

/// Both halves of an edge have half of its knot interval.
void split_intervals(Model& model, Midpoints& midpoints) {
    std::vector<uint32_t> edges;
    std::vector<float> intervals;
    for (size_t i = 0; i < model.intervals.size(); ++i) {
        const uint32_t a = model.interval_edges[2 * i], b = model.interval_edges[2 * i + 1];
        const uint32_t middle = midpoints.of_edge(a, b);
        edges.insert(edges.end(), {a, middle, b, middle});
        intervals.insert(intervals.end(), 2, 0.5f * model.intervals[i]);
    }
    model.interval_edges = std::move(edges);
    model.intervals = std::move(intervals);
}

/// Holes again, where face f has become parts[f] faces.
void renumber_holes(Model& model, const std::vector<uint32_t>& parts) {
    std::vector<uint32_t> first(parts.size() + 1, 0), holes;
    for (size_t f = 0; f < parts.size(); ++f) first[f + 1] = first[f] + parts[f];
    for (const uint32_t hole : model.holes)
        for (uint32_t f = first[hole]; f < first[hole + 1]; ++f) holes.push_back(f);
    model.holes = std::move(holes);
}

}  // namespace

void triangulate(Model& model) {
    const bool textured = !model.face_texture_coordinates.empty();
    std::vector<uint32_t> vertices, values, parts;
    size_t begin = 0;
    for (const uint32_t n : model.face_sizes) {
        const uint32_t* face = model.face_vertices.data() + begin;
        const bool turn = n == 4 && squared_distance(model, face[1], face[3]) < squared_distance(model, face[0], face[2]);
        const size_t apex = turn ? 1 : 0;
        for (size_t i = 1; i + 1 < n; ++i)
            for (const size_t corner : {apex, (apex + i) % n, (apex + i + 1) % n}) {
                vertices.push_back(face[corner]);
                if (textured) values.push_back(model.face_texture_coordinates[begin + corner]);
            }
        parts.push_back(n - 2);
        begin += n;
    }
    renumber_holes(model, parts);
    model.face_vertices = std::move(vertices);
    model.face_texture_coordinates = std::move(values);
    model.face_sizes.assign(model.face_vertices.size() / 3, 3);
}

void split_into_quads(Model& model) {
    const bool textured = !model.face_texture_coordinates.empty();
    Midpoints points(model.positions, 3), texture(model.texture_coordinates, 2);
    std::vector<uint32_t> vertices, values;
    size_t begin = 0;
    for (const uint32_t n : model.face_sizes) {
        append_quads(points, {model.face_vertices.data() + begin, n}, vertices);
        if (textured) append_quads(texture, {model.face_texture_coordinates.data() + begin, n}, values);
        begin += n;
    }
    split_creases(model, points);
    split_intervals(model, points);
    renumber_holes(model, model.face_sizes);
    model.face_vertices = std::move(vertices);
    model.face_texture_coordinates = std::move(values);
    model.face_sizes.assign(model.face_vertices.size() / 4, 4);
}

}  // namespace limn::cli
