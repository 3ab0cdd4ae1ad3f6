#include "patch_samples.h"

#include "limn/topology.h"

namespace limn::bench {
namespace {

template <class Real>
bool of_triangles(const BasicPatchTable<Real>& table) {
    return table.options.scheme == Scheme::loop;
}

/// Visits the corners of refined faces in the order of those faces.
struct Walk {
    const Topology& last;
    bool triangles;
    uint32_t next_face = 0;
    std::vector<PatchSample> samples = {};
    std::vector<uint32_t> vertices = {};

    /// The faces that a part of a ptex face becomes: from (u, v), of this size, turned by 180 degrees where
    /// negative.
    void visit(uint32_t ptex, double u, double v, double size, uint32_t levels, bool present) {
        if (levels == 0) return add_face(ptex, u, v, size, present);
        const double h = size / 2;
        const auto child = [&](double du, double dv, double part) {
            visit(ptex, u + du * h, v + dv * h, part, levels - 1, present);
        };
        child(0, 0, h);
        child(1, 0, h);
        if (triangles) {
            child(0, 1, h);
            child(1, 1, -h);
        } else {
            child(1, 1, h);
            child(0, 1, h);
        }
    }

    void add_face(uint32_t ptex, double u, double v, double size, bool present) {
        constexpr double us[2][4] = {{0, 1, 1, 0}, {0, 1, 0, 0}}, vs[2][4] = {{0, 0, 1, 1}, {0, 0, 1, 0}};
        const auto corners = last.vertices_of_face(next_face++);
        for (size_t k = 0; present && k < corners.size(); ++k) {
            samples.push_back({ptex, u + size * us[triangles][k], v + size * vs[triangles][k]});
            vertices.push_back(corners[k]);
        }
    }
};

}  // namespace

std::vector<uint32_t> present_faces(std::span<const uint32_t> ptex_surfaces) {
    std::vector<uint32_t> faces;
    for (uint32_t f = 0; f < ptex_surfaces.size(); ++f)
        if (ptex_surfaces[f] != shared::kPtexHole) faces.push_back(f);
    return faces;
}

template <class Real>
std::vector<PatchSample> random_samples(const BasicPatchTable<Real>& table, uint32_t count) {
    const std::vector<uint32_t> faces = present_faces(table.ptex_surfaces);
    std::vector<PatchSample> samples;
    if (faces.empty()) return samples;
    samples.reserve(count);
    for (uint64_t i = 0; i < count; ++i) {
        const auto face = static_cast<size_t>(noise(3 * i) * static_cast<double>(faces.size()));
        PatchSample s{faces[face], noise(3 * i + 1), noise(3 * i + 2)};
        if (of_triangles(table) && s.u + s.v > 1) s = {s.face, 1 - s.u, 1 - s.v};
        samples.push_back(s);
    }
    return samples;
}

std::vector<PatchSample> grid_samples(const PatchTableDouble& table, uint32_t rate) {
    const double size = rate;
    std::vector<PatchSample> samples;
    for (const uint32_t face : present_faces(table.ptex_surfaces))
        for (uint32_t j = 0; j <= rate; ++j)
            for (uint32_t i = 0; i <= (of_triangles(table) ? rate - j : rate); ++i)
                samples.push_back({face, i / size, j / size});
    return samples;
}

template <class Real>
std::vector<double> evaluate_samples(const BasicPatchTable<Real>& table, std::span<const PatchSample> samples,
                                     const std::vector<float>& positions, Derivatives derivatives) {
    const std::vector<double> control(positions.begin(), positions.end());
    std::vector<double> points(size_t{3} * table.point_count());
    build_patch_points(table, control, 3, points);
    std::vector<double> values(size_t{3} * value_count(derivatives) * samples.size());
    std::vector<SampleStatus> statuses(samples.size());
    evaluate_patches(table, samples, points, 3, derivatives, values, statuses);
    return values;
}

template std::vector<PatchSample> random_samples(const PatchTable&, uint32_t);
template std::vector<PatchSample> random_samples(const PatchTableDouble&, uint32_t);
template std::vector<double> evaluate_samples(const PatchTable&, std::span<const PatchSample>,
                                              const std::vector<float>&, Derivatives);
template std::vector<double> evaluate_samples(const PatchTableDouble&, std::span<const PatchSample>,
                                              const std::vector<float>&, Derivatives);

RefinedCorners refined_corners(const Options& options, const BenchModel& model, uint32_t level) {
    const auto refinement =
        value_or_fail(options, build_refinement(model.mesh, {.level = level, .full_last_level = false}));
    const auto table = value_or_fail(options, build_limit_table<double>(refinement, level));
    const std::vector<double> control(model.positions.begin(), model.positions.end());
    std::vector<double> limits(size_t{3} * table.row_count());
    apply_stencil_table<double>(table, control, limits, 3);

    const Topology& base = refinement.levels[0];
    Walk walk{refinement.last(), base.options.scheme == Scheme::loop};
    uint32_t ptex = 0;
    for (uint32_t f = 0; f < base.face_count; ++f) {
        const uint32_t size = base.size_of_face(f);
        const bool whole = size == (walk.triangles ? 3u : 4u);
        for (uint32_t i = 0; i < (whole ? 1 : size); ++i)
            walk.visit(ptex++, 0, 0, 1, level - (whole ? 0 : 1), base.face_holes[f] == 0);
    }
    RefinedCorners corners{std::move(walk.samples), {}};
    for (const uint32_t v : walk.vertices)
        corners.limits.insert(corners.limits.end(), limits.begin() + 3 * v, limits.begin() + 3 * v + 3);
    return corners;
}

}  // namespace limn::bench
