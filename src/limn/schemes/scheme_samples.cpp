#include "limn/schemes/scheme_samples.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "limn/compose.h"
#include "limn/parallel.h"
#include "limn/schemes/star_limit.h"

namespace limn {
namespace {

/// A place on a corner of a polygon, or on a face of the scheme's own size.
struct Place {
    uint32_t face, corner;
    double u, v;
    bool polygon;
};

/// The faces that ptex faces belong to.
std::vector<Place> list_ptex_faces(const Topology& t, uint32_t size) {
    std::vector<Place> places;
    for (uint32_t f = 0; f < t.face_count; ++f) {
        const uint32_t n = t.size_of_face(f);
        for (uint32_t c = 0; c < (n == size ? 1 : n); ++c) places.push_back({f, c, 0, 0, n != size});
    }
    return places;
}

/// The child of face 0 that a place lies on, and where on it. Children of a face keep its orientation; the one in the
/// middle of a triangle is turned by 180 degrees.
uint32_t descend(bool triangles, Place& place) {
    if (place.polygon) {
        place.polygon = false;
        return place.corner;
    }
    const double u = 2 * place.u, v = 2 * place.v;
    const bool right = u >= 1, upper = v >= 1 && !(triangles && right);
    place.u = u - right;
    place.v = v - upper;
    if (!triangles) return upper ? (right ? 2 : 3) : (right ? 1 : 0);
    if (right || upper) return right ? 1 : 2;
    if (u + v <= 1) return 0;
    place.u = 1 - u;
    place.v = 1 - v;
    return 3;
}

/// The corner of face 0 that a place is at the end of its way.
uint32_t corner_at(bool triangles, const Place& place) {
    if (triangles) return place.u >= 0.5 ? 1 : place.v >= 0.5 ? 2 : 0;
    return place.v >= 0.5 ? (place.u >= 0.5 ? 2 : 3) : (place.u >= 0.5 ? 1 : 0);
}

uint32_t depth_of(double u, double v) {
    uint32_t depth = 0;
    while (depth < kMaxSampleDepth && (u != std::floor(u) || v != std::floor(v))) {
        u *= 2;
        v *= 2;
        ++depth;
    }
    return depth;
}

double rounded(double x) {
    return std::ldexp(std::round(std::ldexp(x, kMaxSampleDepth)), -static_cast<int>(kMaxSampleDepth));
}

struct Weights {
    double position = 0, tangent1 = 0, tangent2 = 0;
};
using SampleRow = std::map<uint32_t, Weights>;  // ascending: the same sums whatever the walk

/// The row before a step, whose rows are given for the vertices in `labels`.
SampleRow pull_back(const SampleRow& row, const std::vector<Row>& rows, const std::vector<uint32_t>& labels) {
    SampleRow out;
    for (const auto& [label, weights] : row)
        for (const RowEntry& entry : rows[labels[label]]) {
            Weights& to = out[entry.index];
            to.position += entry.weight * weights.position;
            to.tangent1 += entry.weight * weights.tangent1;
            to.tangent2 += entry.weight * weights.tangent2;
        }
    return out;
}

/// A face with what lies around it, and which vertices of the mesh that it was cut from those are.
struct FacePatch {
    StarPatch patch;
    std::vector<uint32_t> vertices;
};

class Sampler {
  public:
    Sampler(const Stage& stage, const SubdivisionScheme& scheme)
        : stage_(stage), scheme_(scheme), limits_(scheme, patch_rings(scheme)), triangles_(scheme.faces == FaceKind::triangles) {}

    /// Rows over control points. Errors: unsupported.
    Result<SampleRow> row_of(Place place) {
        const uint32_t steps = depth_of(place.u, place.v) + place.polygon;
        FacePatch first = cut(stage_, place.face);
        StarPatch* patch = &first.patch;
        std::vector<std::vector<Row>> rows(steps);
        std::vector<FacePatch> patches(steps);
        for (uint32_t i = 0; i < steps; ++i) {
            const uint32_t begin = triangles_ ? 0 : patch->stage.topology.face_begin(0);
            const uint32_t child = begin + descend(triangles_, place);
            StageStep step = refine_stage(std::move(patch->stage), scheme_, {true, 0});
            rows[i] = std::move(step.rows);
            patches[i] = cut(step.child, child);
            patch = &patches[i].patch;
        }
        auto row = limit_at(patch->stage, patch->stage.topology.vertices_of_face(0)[corner_at(triangles_, place)]);
        for (uint32_t i = steps; row && i-- != 0;) row = pull_back(*row, rows[i], patches[i].vertices);
        if (!row) return row.error();
        SampleRow out;
        for (const auto& [label, weights] : *row) out[first.vertices[label]] = weights;
        return out;
    }

  private:
    FacePatch cut(const Stage& stage, uint32_t face) const {
        const uint32_t rings = patch_rings(scheme_) + 1;
        StarWalk walk;
        walk.walk_manifold(stage.topology, {{true, face}, 0}, rings);
        FacePatch out{make_patch(stage, {true, face}, scheme_.period, rings, walk), {}};
        out.vertices = walk.vertices;
        return out;
    }

    Result<SampleRow> limit_at(const Stage& stage, uint32_t v) {
        StarWalk walk;
        const StarStart start = canonical_start(stage, {false, v}, scheme_.period, patch_rings(scheme_), walk);
        const auto key = patch_key(stage, {false, v}, scheme_.period, patch_rings(scheme_), walk);
        const StarMask* mask = limits_.find(key);
        if (mask == nullptr) {
            auto made = limits_.make(make_patch(stage, start.element, scheme_.period, patch_rings(scheme_), walk));
            if (!made) return made.error();
            mask = *made;
        }
        walk.walk(stage.topology, start, mask->rings);
        SampleRow row;
        for (size_t i = 0; i < mask->labels.size(); ++i)
            row[walk.vertices[mask->labels[i]]] = {mask->position[i], mask->tangent1[i], mask->tangent2[i]};
        return row;
    }

    const Stage& stage_;
    const SubdivisionScheme& scheme_;
    StarLimits limits_;
    bool triangles_;
};

bool is_on(bool triangles, const PatchSample& s) {
    return s.u >= 0 && s.v >= 0 && (triangles ? s.u + s.v <= 1 : s.u <= 1 && s.v <= 1);
}

template <class Real>
SchemeSampleTable<Real> write_table(const std::vector<SampleRow>& rows, std::vector<SampleStatus> statuses, uint32_t control_count,
                              Array<uint32_t> offsets) {
    SchemeSampleTable<Real> out;
    out.statuses = std::move(statuses);
    BasicStencilTable<Real>& table = out.table;
    table.source_count = control_count;
    table.offsets = std::move(offsets);
    const size_t entries = table.offsets.back();
    table.indices.allocate(entries);
    for (auto* weights : {&table.weights, &table.tangent1_weights, &table.tangent2_weights}) weights->allocate(entries);
    size_t at = 0;
    for (const SampleRow& row : rows)
        for (const auto& [index, weights] : row) {
            table.indices[at] = index;
            table.weights[at] = static_cast<Real>(weights.position);
            table.tangent1_weights[at] = static_cast<Real>(weights.tangent1);
            table.tangent2_weights[at++] = static_cast<Real>(weights.tangent2);
        }
    return out;
}

}  // namespace

bool has_coordinates(const SubdivisionScheme& scheme) {
    return !scheme.dual && std::all_of(scheme.passes.begin(), scheme.passes.end(), [](const Pass& pass) {
        return pass.split == SplitKind::quads || pass.split == SplitKind::triangles || pass.split == SplitKind::none;
    });
}

template <class Real>
Result<SchemeSampleTable<Real>> build_scheme_sample_table(const ControlMesh& mesh, const SubdivisionScheme& scheme,
                                                    std::span<const PatchSample> samples,
                                                    std::span<const double> intervals, const BuildPart& control) {
    if (!has_coordinates(scheme))
        return Error{ErrorCode::unsupported,
                     std::string(scheme.title) + " does not split faces in four: places on them have no coordinates"};
    if (auto ok = control.start(); !ok) return ok.error();
    const auto stage = build_first_stage(mesh, scheme, intervals);
    if (!stage) return stage.error();
    const bool triangles = scheme.faces == FaceKind::triangles;
    const std::vector<Place> ptex = list_ptex_faces(stage->topology, triangles ? 3 : 4);
    Sampler sampler(*stage, scheme);
    const auto count = static_cast<uint32_t>(samples.size());
    std::vector<SampleRow> rows(count);
    std::vector<SampleStatus> statuses(count, SampleStatus::out_of_range);
    std::vector<Error> errors(count);
    std::vector<uint8_t> failed(count, 0);
    for_each_index(count, control, [&](uint32_t i) {
        const PatchSample& sample = samples[i];
        if (sample.face >= ptex.size() || !is_on(triangles, sample)) return;
        Place place = ptex[sample.face];
        statuses[i] = stage->topology.face_holes[place.face] != 0 ? SampleStatus::hole : SampleStatus::valid;
        if (statuses[i] != SampleStatus::valid) return;
        place.u = rounded(sample.u);
        place.v = rounded(sample.v);
        auto row = sampler.row_of(place);
        if (row) {
            rows[i] = std::move(*row);
        } else {
            errors[i] = row.error();
            failed[i] = 1;
        }
    }, 16);
    if (auto ok = control.check(); !ok) return ok.error();
    for (uint32_t i = 0; i < count; ++i)
        if (failed[i] != 0) return Error{errors[i].code, "sample " + std::to_string(i) + " " + errors[i].message, i};
    Array<uint32_t> offsets;
    offsets.allocate(size_t{count} + 1);
    offsets.back() = 0;
    for (uint32_t i = 0; i < count; ++i) offsets[i] = static_cast<uint32_t>(rows[i].size());
    if (auto ok = offsets_from_sizes(offsets); !ok) return ok.error();
    if (auto ok = control.reach(1); !ok) return ok.error();
    return write_table<Real>(rows, std::move(statuses), mesh.vertex_count, std::move(offsets));
}

template Result<SchemeSampleTable<float>> build_scheme_sample_table(const ControlMesh&, const SubdivisionScheme&,
                                                                    std::span<const PatchSample>,
                                                                    std::span<const double>, const BuildPart&);
template Result<SchemeSampleTable<double>> build_scheme_sample_table(const ControlMesh&, const SubdivisionScheme&,
                                                                     std::span<const PatchSample>,
                                                                     std::span<const double>, const BuildPart&);

}  // namespace limn
