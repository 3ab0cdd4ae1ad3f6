// Rows of weights while a plan is built. Not part of the public interface.
#pragma once

#include <algorithm>
#include <span>

#include "limn/patch_points.h"
#include "limn/plan.h"

namespace limn {

/// Dense rows over the plan's ring for the vertices of a topology.
struct VertexRows {
    size_t width = 0;
    std::vector<double> values;

    double* row(uint32_t v) { return values.data() + v * width; }
    const double* row(uint32_t v) const { return values.data() + v * width; }
    /// The rows of some vertices of `from`, in this order.
    template <class From>
    void copy(From& from, const std::vector<uint32_t>& vertices) {
        width = from.rows.width;
        values.resize(vertices.size() * width);
        for (uint32_t i = 0; i < vertices.size(); ++i) std::copy_n(from.row(vertices[i]), width, row(i));
    }
};

/// The rows of a plan, each value once.
class PlanRows {
  public:
    /// Starts to write the rows of `plan`, whose ring_size is known.
    void begin(BuiltPlan& plan);
    /// The plan receives its rows.
    void end() { plan_->weights.assign(weights_.begin(), weights_.end()); }
    /// A row of its own, also where there is an equal one.
    uint32_t append(const double* row);
    /// The number of a row; negative zeros in it become zeros.
    uint32_t write(double* row);
    size_t width() const { return plan_->ring_size; }

  private:
    struct Slot {
        uint64_t hash;
        uint32_t row;
    };
    void grow();

    BuiltPlan* plan_ = nullptr;
    std::vector<double> weights_;
    std::vector<Slot> slots_;  ///< a power of two of them, half of them free
    uint32_t used_ = 0;
};

/// Refinement rows of the level after a topology, kept from one plan to the next.
class RowCache {
  public:
    void clear(uint32_t count) {
        places_.assign(count, {});
        entries_.clear();
    }
    std::span<const RowEntry> row(const Topology& parent, uint32_t child);

  private:
    struct Place {
        uint32_t first = 0, count = 0;  ///< none: not yet made
    };
    std::vector<Place> places_;
    Row entries_;
};

/// The rows of a topology's vertices; those of a refined level are made where they are asked for.
class LazyRows {
  public:
    /// Of the level after `parent`, which has `count` vertices.
    void begin(const Topology& parent, const VertexRows& parent_rows, uint32_t count);
    /// Of `count` vertices, whose rows are known.
    void begin(const VertexRows& known, uint32_t count);
    /// Of the level after that of a star (plan_scratch.h): its vertices are the points of the ring of `width` points
    /// or, of a deeper level, these ones of `above`. No two rows are equal but those of the star's corner.
    void begin_star(const Topology& parent, RowCache& cache, size_t width, uint32_t count);
    void begin_star(const Topology& parent, RowCache& cache, LazyRows& above, const std::vector<uint32_t>& vertices,
                    uint32_t count);
    const double* row(uint32_t v) {
        if (made_[v] == 0) make(v);
        return rows.row(v);
    }
    /// The number of v's row in the plan.
    uint32_t write(uint32_t v, PlanRows& plan) {
        if (numbers_[v] == kInvalidIndex) {
            row(v);
            numbers_[v] = star_ != nullptr && v != 0 ? plan.append(rows.row(v)) : plan.write(rows.row(v));
        }
        return numbers_[v];
    }

    VertexRows rows;

  private:
    void begin(const Topology& parent, size_t width, uint32_t count, RowCache* star);
    const double* parent_row(uint32_t v) {
        return parent_rows_ != nullptr ? parent_rows_->row(v) : above_->row((*above_vertices_)[v]);
    }
    void make(uint32_t v);

    const Topology* parent_ = nullptr;
    const VertexRows* parent_rows_ = nullptr;
    LazyRows* above_ = nullptr;
    const std::vector<uint32_t>* above_vertices_ = nullptr;
    RowCache* star_ = nullptr;
    std::vector<uint8_t> made_;
    std::vector<uint32_t> numbers_;  ///< kInvalidIndex where not yet written
    Row scratch_;
};

}  // namespace limn
