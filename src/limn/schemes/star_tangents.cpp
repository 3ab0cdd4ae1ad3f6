#include "limn/schemes/star_tangents.h"

#include <algorithm>
#include <cmath>

#include "limn/schemes/eigen_masks.h"
#include "limn/schemes/star.h"

namespace limn {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The ends of a sector's two edges after vertex 0, and the vertices of its faces around it.
struct SectorLabels {
    std::vector<int> ends, between;
};
SectorLabels labels_of(const StarPatch& patch, const Sector& sector) {
    const Topology& t = patch.stage.topology;
    const auto corners = t.corners_of_vertex(0);
    SectorLabels labels;
    labels.ends.push_back(0);
    for (const uint32_t edge : {sector.edge, sector.edge + sector.faces})
        labels.ends.push_back(static_cast<int>(neighbor(t, 0, edge % edge_valence(t, 0))));
    for (uint32_t i = 0; i < sector.faces; ++i)
        for (const uint32_t v : t.vertices_of_face(t.face_of_corner(corners[(sector.edge + i) % corners.size()])))
            labels.between.push_back(static_cast<int>(v));
    return labels;
}

/// What `vectors` have beside `direction`, a unit vector; empty unless it is one vector.
std::optional<VectorXd> one_beside(const MatrixXd& vectors, const VectorXd& direction) {
    const MatrixXd rest = vectors - direction * (direction.transpose() * vectors);
    std::optional<VectorXd> found;
    double largest = 0;
    for (int c = 0; c < rest.cols(); ++c)
        if (rest.col(c).norm() > std::max(1e-6, largest)) {
            largest = rest.col(c).norm();
            found = rest.col(c).normalized();
        }
    if (found && (rest - *found * (found->transpose() * rest)).norm() > 1e-6) return {};
    return found;
}

}  // namespace

VectorXd scatter(const VectorXd& values, const std::vector<int>& labels, uint32_t size) {
    VectorXd out = VectorXd::Zero(size);
    out(labels) = values;
    return out;
}

Tangents edge_tangents(const StarPatch& patch) {
    const auto size = static_cast<int>(patch.size());
    Tangents out{VectorXd::Zero(size), VectorXd::Zero(size)};
    if (patch.stage.topology.face_count == 0) return out;
    const auto last = static_cast<int>(patch.stage.topology.size_of_face(0)) - 1;
    out.first[1] = out.second[last] = 1;
    out.first[0] = out.second[0] = -1;
    return out;
}

std::vector<int> ring_labels(const StarPatch& patch) {
    std::vector<int> labels;
    for (uint32_t i = 0; i < patch.ring_size; ++i) labels.push_back(static_cast<int>(i));
    return labels;
}

std::optional<Tangents> smooth_tangents(const StarPatch& patch, const MatrixXd& matrix) {
    const std::vector<int> labels = closed_labels(matrix, ring_labels(patch));
    LeftVectors vectors(block_of(matrix, labels));
    MatrixXd plane = vectors.next();
    if (plane.cols() == 1) {
        const MatrixXd second = vectors.next();
        if (second.cols() != 1) return {};
        plane.conservativeResize(plane.rows(), 2);
        plane.col(1) = second;
    }
    if (plane.cols() != 2) return {};
    // Turned until the second has nothing of the first neighbour: cosines and sines where the star is symmetric.
    const auto first = std::find(labels.begin(), labels.end(), patch.element.is_face ? 0 : 1) - labels.begin();
    const double p = plane(first, 0), q = plane(first, 1), length = std::hypot(p, q);
    const double c = length > 1e-12 ? p / length : 1, s = length > 1e-12 ? q / length : 0;
    return Tangents{scatter(c * plane.col(0) + s * plane.col(1), labels, patch.size()),
                    scatter(c * plane.col(1) - s * plane.col(0), labels, patch.size())};
}

std::vector<Sector> sectors_of(const StarPatch& patch) {
    const Topology& t = patch.stage.topology;
    const auto edges = t.edges_of_vertex(0);
    std::vector<Sector> sectors;
    for (uint32_t i = 0; i < edges.size(); ++i) {
        if (!is_infinite(t.edge_sharpness[edges[i]])) continue;
        if (!sectors.empty()) sectors.back().faces = i - sectors.back().edge;
        sectors.push_back({i, 0});
    }
    if (sectors.size() < 2) return {};
    if (is_boundary_vertex(t, 0))
        sectors.pop_back();
    else
        sectors.back().faces = sectors.front().edge + face_valence(t, 0) - sectors.back().edge;
    return sectors;
}

std::optional<Tangents> sector_tangents(const StarPatch& patch, const MatrixXd& matrix, const Sector& sector) {
    const auto [ends, between] = labels_of(patch, sector);
    const std::vector<int> along = closed_labels(matrix, ends);
    LeftVectors of_curve(block_of(matrix, along));
    const MatrixXd curve = of_curve.next();
    if (curve.cols() == 2)
        return Tangents{scatter(curve.col(0), along, patch.size()), scatter(curve.col(1), along, patch.size())};
    if (curve.cols() != 1) return {};
    VectorXd first = scatter(curve.col(0), along, patch.size());
    if (first[ends[1]] < 0) first = -first;
    const std::vector<int> labels = closed_labels(matrix, between);
    const VectorXd direction = first(labels);
    LeftVectors across(block_of(matrix, labels));
    for (MatrixXd group = across.next(); group.cols() != 0; group = across.next()) {
        const auto second = one_beside(group, direction.normalized());
        if (second) return Tangents{first, scatter(*second, labels, patch.size())};
        if (group.cols() > 1) return {};
    }
    return {};
}

void orient(const StarPatch& patch, Tangents& tangents) {
    const std::vector<double> at = planar_layout(patch.stage.topology);
    double x1 = 0, y1 = 0, x2 = 0, y2 = 0;
    for (uint32_t v = 0; v < patch.size(); ++v) {
        const double x = at[2 * size_t{v}], y = at[2 * size_t{v} + 1];
        x1 += tangents.first[v] * x;
        y1 += tangents.first[v] * y;
        x2 += tangents.second[v] * x;
        y2 += tangents.second[v] * y;
    }
    if (x1 * y2 - x2 * y1 < 0) tangents.second = -tangents.second;
}

}  // namespace limn
