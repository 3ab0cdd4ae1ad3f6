#include "limn/schemes/star_chain.h"

#include <numeric>

#include "limn/schemes/eigen_masks.h"

namespace limn {

const StarLink& StarChain::in_cycle(size_t i) const {
    size_t least = entry;
    for (size_t k = entry; k < links.size(); ++k)
        if (links[k].patch.key < links[least].patch.key) least = k;
    return links[entry + (least - entry + i) % cycle_size()];
}

Eigen::VectorXcd StarChain::step(Eigen::VectorXcd points) const {
    for (size_t i = 0; i < cycle_size(); ++i) {
        const std::vector<Row>& rows = in_cycle(i).rows;
        Eigen::VectorXcd next = Eigen::VectorXcd::Zero(static_cast<Eigen::Index>(rows.size()));
        for (size_t r = 0; r < rows.size(); ++r)
            for (const RowEntry& entry : rows[r])
                next[static_cast<Eigen::Index>(r)] += entry.weight * points[entry.index];
        points = std::move(next);
    }
    return points;
}

Eigen::MatrixXd StarChain::matrix_of_cycle(uint32_t count) const {
    Eigen::MatrixXd matrix = matrix_of_rows(in_cycle(0).rows, in_cycle(0).patch.size());
    for (size_t i = 1; i < cycle_size(); ++i)
        matrix = (matrix_of_rows(in_cycle(i).rows, in_cycle(i).patch.size()) * matrix).eval();
    std::vector<int> labels(count);
    std::iota(labels.begin(), labels.end(), 0);
    labels = closed_labels(matrix, labels);
    for (const uint32_t end : in_cycle(0).patch.ring_ends)
        if (count <= static_cast<uint32_t>(labels.back())) count = end;
    return matrix.topLeftCorner(count, count);
}

Result<StarChain> follow_steps(const StarPatch& patch, const SubdivisionScheme& scheme, uint32_t rings,
                               const std::function<bool(const std::vector<uint32_t>& key)>& is_known) {
    constexpr uint32_t kMaxRing = 640;  // vertices next to an element: matrices are dense
    constexpr size_t kMaxSteps = 64;    // sharpness fades in ten, other irregular vertices go out of reach in a few
    StarChain chain;
    StarPatch current = patch;
    for (;; chain.entry = 0) {
        chain.last_key = current.key;
        while (chain.entry < chain.links.size() && chain.links[chain.entry].patch.key != current.key) ++chain.entry;
        if (chain.entry < chain.links.size() || is_known(current.key)) return chain;
        if (current.ring_size > kMaxRing) return Error{ErrorCode::unsupported, "has too many faces for a limit"};
        if (chain.links.size() == kMaxSteps)
            return Error{ErrorCode::unsupported, "has no limit by eigenvectors: no two steps are alike"};
        PatchStep step = refine_patch(current, scheme, rings);
        chain.exists = step.exists;
        if (!step.exists) return chain;
        chain.links.push_back({std::move(current), std::move(step.rows)});
        current = std::move(step.child);
    }
}

}  // namespace limn
