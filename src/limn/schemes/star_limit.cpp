#include "limn/schemes/star_limit.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>

#include "limn/schemes/eigen_masks.h"
#include "limn/schemes/star.h"
#include "limn/schemes/star_chain.h"

namespace limn {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Masks over all vertices of a patch.
struct FullMask {
    VectorXd position, tangent1, tangent2;
    bool smooth = false;

    FullMask before(const std::vector<Row>& rows, uint32_t source_count) const {
        FullMask out{VectorXd::Zero(source_count), VectorXd::Zero(source_count), VectorXd::Zero(source_count), smooth};
        for (size_t r = 0; r < rows.size(); ++r)
            for (const RowEntry& entry : rows[r]) {
                const auto from = static_cast<int>(r), to = static_cast<int>(entry.index);
                out.position[to] += entry.weight * position[from];
                out.tangent1[to] += entry.weight * tangent1[from];
                out.tangent2[to] += entry.weight * tangent2[from];
            }
        return out;
    }
};

VectorXd scatter(const VectorXd& values, const std::vector<int>& labels, uint32_t size) {
    VectorXd out = VectorXd::Zero(size);
    out(labels) = values;
    return out;
}

struct Tangents {
    VectorXd first, second;
};

/// Two edges of the first face.
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

/// The plane of the subdominant eigenvalues, where there are exactly two.
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

/// Labels around vertex 0 as its crease sees them: the ends of the two sharp edges, and all vertices between.
struct Sector {
    std::vector<int> ends, between;
};
Sector first_sector(const StarPatch& patch, const SharpEdges& sharp) {
    const Topology& t = patch.stage.topology;
    Sector sector;
    sector.ends.push_back(0);
    for (const uint32_t position : sharp.positions) sector.ends.push_back(static_cast<int>(neighbor(t, 0, position)));
    for (uint32_t i = sharp.positions[0]; i < sharp.positions[1] && i < face_valence(t, 0); ++i)
        for (const uint32_t v : t.vertices_of_face(t.face_of_corner(t.corners_of_vertex(0)[i])))
            sector.between.push_back(static_cast<int>(v));
    return sector;
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

/// Along a boundary or crease, whose points depend on each other alone, and across it.
std::optional<Tangents> crease_tangents(const StarPatch& patch, const MatrixXd& matrix, const SharpEdges& sharp) {
    const Sector sector = first_sector(patch, sharp);
    const std::vector<int> along = closed_labels(matrix, sector.ends);
    LeftVectors of_curve(block_of(matrix, along));
    const MatrixXd curve = of_curve.next();
    if (curve.cols() == 2)
        return Tangents{scatter(curve.col(0), along, patch.size()), scatter(curve.col(1), along, patch.size())};
    if (curve.cols() != 1) return {};
    VectorXd first = scatter(curve.col(0), along, patch.size());
    if (first[sector.ends[1]] < 0) first = -first;
    const std::vector<int> labels = closed_labels(matrix, sector.between);
    const VectorXd direction = first(labels);
    LeftVectors across(block_of(matrix, labels));
    for (MatrixXd group = across.next(); group.cols() != 0; group = across.next()) {
        const auto second = one_beside(group, direction.normalized());
        if (second) return Tangents{first, scatter(*second, labels, patch.size())};
        if (group.cols() > 1) return {};
    }
    return {};
}

/// tangent1 x tangent2 along the normal.
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

/// The mask of a patch that `matrix` takes to itself.
FullMask stationary_mask(const StarPatch& patch, const MatrixXd& matrix) {
    FullMask mask;
    const std::vector<int> labels = closed_labels(matrix, ring_labels(patch));
    mask.position = scatter(position_mask(block_of(matrix, labels)), labels, patch.size());
    const SharpEdges sharp = patch.element.is_face ? SharpEdges{} : infinitely_sharp_edges(patch.stage.topology, 0);
    auto tangents = sharp.count >= 2 ? crease_tangents(patch, matrix, sharp) : smooth_tangents(patch, matrix);
    mask.smooth = tangents.has_value();
    if (tangents)
        orient(patch, *tangents);
    else
        tangents = edge_tangents(patch);
    mask.tangent1 = std::move(tangents->first);
    mask.tangent2 = std::move(tangents->second);
    return mask;
}

/// Drops what is rounding, and scales tangents to weights of one at most.
StarMask compress(const FullMask& full, const StarPatch& patch) {
    constexpr double kZero = 1e-14;
    StarMask mask;
    mask.smooth = full.smooth;
    const double scale1 = full.tangent1.cwiseAbs().maxCoeff(), scale2 = full.tangent2.cwiseAbs().maxCoeff();
    for (uint32_t v = 0; v < patch.size(); ++v) {
        const double p = full.position[v], t1 = scale1 > 0 ? full.tangent1[v] / scale1 : 0,
                     t2 = scale2 > 0 ? full.tangent2[v] / scale2 : 0;
        if (std::abs(p) < kZero && std::abs(t1) < kZero && std::abs(t2) < kZero) continue;
        mask.labels.push_back(v);
        mask.position.push_back(p);
        mask.tangent1.push_back(t1);
        mask.tangent2.push_back(t2);
    }
    while (mask.rings + 1 < patch.ring_ends.size() && mask.labels.back() >= patch.ring_ends[mask.rings]) ++mask.rings;
    return mask;
}

FullMask expand(const StarMask& mask, uint32_t size) {
    FullMask full{VectorXd::Zero(size), VectorXd::Zero(size), VectorXd::Zero(size), mask.smooth};
    for (size_t i = 0; i < mask.labels.size(); ++i) {
        full.position[mask.labels[i]] = mask.position[i];
        full.tangent1[mask.labels[i]] = mask.tangent1[i];
        full.tangent2[mask.labels[i]] = mask.tangent2[i];
    }
    return full;
}

}  // namespace

const StarMask* StarLimits::find(const std::vector<uint32_t>& key) const {
    const std::shared_lock lock(mutex_);
    const auto found = masks_.find(key);
    return found == masks_.end() ? nullptr : &found->second;
}

const StarMask* StarLimits::insert(const std::vector<uint32_t>& key, StarMask mask) {
    const std::unique_lock lock(mutex_);
    return &masks_.emplace(key, std::move(mask)).first->second;
}

Result<const StarMask*> StarLimits::make(const StarPatch& patch) {
    auto chain =
        follow_steps(patch, scheme_, rings_, [&](const std::vector<uint32_t>& key) { return find(key) != nullptr; });
    if (!chain) return chain.error();
    if (!chain->exists) {
        StarMask none;
        none.exists = false;
        return insert(patch.key, std::move(none));
    }
    const StarMask* mask = find(chain->last_key);
    uint32_t size = 0;
    auto step_back = [&](const StarLink& link) {
        if (size == 0) size = static_cast<uint32_t>(link.rows.size());
        const FullMask before = expand(*mask, size).before(link.rows, link.patch.size());
        mask = insert(link.patch.key, compress(before, link.patch));
        size = link.patch.size();
    };
    if (mask == nullptr) {
        const StarPatch& first = chain->in_cycle(0).patch;
        mask = insert(first.key, compress(stationary_mask(first, chain->matrix_of_cycle(first.size())), first));
        for (size_t i = chain->cycle_size(); i-- > 1;) step_back(chain->in_cycle(i));
        size = 0;
        mask = find(chain->links[chain->entry].patch.key);
    }
    for (size_t i = chain->entry; i-- != 0;) step_back(chain->links[i]);
    return mask;
}

}  // namespace limn
