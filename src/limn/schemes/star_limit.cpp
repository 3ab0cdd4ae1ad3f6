#include "limn/schemes/star_limit.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "limn/schemes/eigen_masks.h"
#include "limn/schemes/star_chain.h"
#include "limn/schemes/star_tangents.h"

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

/// The mask of a patch that `matrix` takes to itself.
FullMask stationary_mask(const StarPatch& patch, const MatrixXd& matrix) {
    FullMask mask;
    const std::vector<int> labels = closed_labels(matrix, ring_labels(patch));
    mask.position = scatter(position_mask(block_of(matrix, labels)), labels, patch.size());
    const std::vector<Sector> sectors = patch.element.is_face ? std::vector<Sector>{} : sectors_of(patch);
    auto tangents = sectors.empty() ? smooth_tangents(patch, matrix) : sector_tangents(patch, matrix, sectors[0]);
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
