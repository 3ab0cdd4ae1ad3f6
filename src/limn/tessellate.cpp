#include "limn/tessellate.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "limn/parallel.h"
#include "limn/shared/tess_steps.h"
#include "limn/topology.h"

namespace limn {
namespace {

using shared::TessPattern;
using shared::TessVertex;

shared::RateCamera rate_camera(const Camera& camera) {
    shared::RateCamera out = {};
    for (int j = 0; j < 4; ++j) {
        out.row_x[j] = camera.matrix[4 * j];
        out.row_y[j] = camera.matrix[4 * j + 1];
        out.row_w[j] = camera.matrix[4 * j + 3];
    }
    out.width = camera.width;
    out.height = camera.height;
    return out;
}

/// Where sample i of a rate edge is.
PatchSample rate_sample(const TessellationTable& table, const uint32_t* edge, uint32_t i) {
    double t = 0;
    const size_t row = shared::row_of_rate_sample(edge[0], i, t);
    const uint32_t* words = table.rows.data() + row * shared::kTessRowWords;
    PatchSample sample = {words[1], 0, 0};
    shared::locate_on_row(words[2], t, sample.u, sample.v);
    return sample;
}

/// The pattern of a face, all of whose rates are positive.
struct Face {
    const uint32_t* sides;
    TessPattern pattern;
    bool drawn;
};
Face face_of(const TessellationTable& table, std::span<const uint32_t> rates, TessellationSpacing spacing, uint32_t f) {
    const uint32_t* sides = table.faces.data() + size_t{f} * shared::kTessFaceWords;
    const bool triangle = table.options.scheme == Scheme::loop;
    if (sides[0] == shared::kNoSide) return {sides, {}, false};
    uint32_t r[4] = {};
    for (uint32_t k = 0; k < (triangle ? 3u : 4u); ++k) {
        r[k] = rates[table.rows[size_t{shared::side_row(sides[k])} * shared::kTessRowWords]];
        if (r[k] == 0) return {sides, {}, false};
    }
    return {sides,
            shared::make_face_pattern(triangle, static_cast<uint32_t>(spacing), sides[0], sides[1], sides[2], sides[3], r[0],
                                      r[1], r[2], r[3]),
            true};
}

/// Where the vertices of rows and of faces begin.
struct Offsets {
    std::vector<uint32_t> rows, faces, triangles;
    std::vector<uint8_t> drawn;
};

struct Tessellator {
    const TessellationTable& table;
    std::span<const uint32_t> rates;
    TessellationSpacing spacing;
    Offsets offsets = {};

    bool fractional() const { return spacing == TessellationSpacing::fractional; }
    uint32_t row_rate(uint32_t row) const { return rates[table.rows[size_t{row} * shared::kTessRowWords]]; }
    /// Beside a face that is drawn.
    bool is_live(uint32_t row) const {
        const uint32_t edge = table.rows[size_t{row} * shared::kTessRowWords];
        const uint32_t* words = table.rate_edges.data() + size_t{edge} * shared::kRateEdgeWords;
        if (rates[edge] == 0) return false;
        return words[1] == shared::kManyFaces || (words[1] != shared::kNoFace && offsets.drawn[words[1]] != 0) ||
               (words[2] != shared::kNoFace && offsets.drawn[words[2]] != 0);
    }
    uint32_t row_size(uint32_t row) const {
        return is_live(row) ? shared::segment_count(row_rate(row), fractional()) - 1 : 0;
    }

    TessellationCounts count();
    void place(Tessellation& out) const;
    void connect(uint32_t f, Tessellation& out) const;
    uint32_t index_of(const Face& face, uint32_t f, TessVertex v) const;
};

/// Offsets are right where the counts fit 32 bits.
TessellationCounts Tessellator::count() {
    TessellationCounts counts{table.corner_count, 0};
    offsets.drawn.resize(table.face_count);
    std::vector<uint32_t> inside(table.face_count, 0);
    for (uint32_t f = 0; f < table.face_count; ++f) {
        offsets.triangles.push_back(static_cast<uint32_t>(counts.triangles));
        const Face face = face_of(table, rates, spacing, f);
        if (!face.drawn) continue;
        offsets.drawn[f] = 1;
        inside[f] = shared::inner_vertex_count(face.pattern);
        counts.triangles += shared::triangle_count(face.pattern);
    }
    const auto place = [&](std::vector<uint32_t>& begins, uint32_t size) {
        begins.push_back(static_cast<uint32_t>(counts.vertices));
        counts.vertices += size;
    };
    for (uint32_t row = 0; row < table.row_count; ++row) place(offsets.rows, row_size(row));
    for (const uint32_t size : inside) place(offsets.faces, size);
    return counts;
}

void Tessellator::place(Tessellation& out) const {
    for (uint32_t i = 0; i < out.vertex_count(); ++i) out.position_sources[i] = i;
    for (uint32_t c = 0; c < table.corner_count; ++c) {
        const uint32_t* words = table.corners.data() + size_t{c} * shared::kTessCornerWords;
        out.places[c] = {words[0], (words[1] & 3) / 2.0, (words[1] >> 2) / 2.0};
    }
    for (uint32_t row = 0; row < table.row_count; ++row) {
        const uint32_t* words = table.rows.data() + size_t{row} * shared::kTessRowWords;
        for (uint32_t i = 0; i < row_size(row); ++i) {
            PatchSample& place = out.places[offsets.rows[row] + i];
            place.face = words[1];
            shared::locate_on_row(words[2], shared::point_on_side(row_rate(row), fractional(), i + 1), place.u,
                                  place.v);
        }
    }
    for (size_t i = 0; i < table.corner_copies.size(); i += 2)
        out.position_sources[table.corner_copies[i]] = table.corner_copies[i + 1];
    for (size_t i = 0; i < table.row_copies.size(); i += 2) {
        const uint32_t row = table.row_copies[i], source = table.row_copies[i + 1];
        for (uint32_t k = 0; k < row_size(row); ++k)
            out.position_sources[offsets.rows[row] + k] = offsets.rows[source] + k;
    }
}

uint32_t Tessellator::index_of(const Face& face, uint32_t f, TessVertex v) const {
    if (v.side == shared::kInside) return offsets.faces[f] + v.i;
    const uint32_t n = face.pattern.segments[v.side], sides = shared::side_count(face.pattern);
    if (v.i == 0 || v.i == n) return face.sides[4 + (v.i == 0 ? v.side : (v.side + 1) % sides)];
    uint32_t row = 0;
    const uint32_t i = shared::point_of_row(face.sides[v.side], n, v.i, row);
    if (face.pattern.halves[v.side] && 2 * v.i == n) return table.rows[size_t{row} * shared::kTessRowWords + 3];
    return offsets.rows[row] + i - 1;
}

void Tessellator::connect(uint32_t f, Tessellation& out) const {
    const Face face = face_of(table, rates, spacing, f);
    if (!face.drawn) return;
    const TessPattern& pattern = face.pattern;
    size_t triangle = offsets.triangles[f];
    TessVertex a = {}, b = {}, c = {};
    const auto add = [&] {
        uint32_t* indices = out.indices.data() + 3 * triangle;
        indices[0] = index_of(face, f, a);
        indices[1] = index_of(face, f, b);
        indices[2] = index_of(face, f, c);
        out.triangle_faces[triangle++] = f;
    };
    for (uint32_t i = 0; i < shared::inner_triangle_count(pattern); ++i) {
        shared::inner_triangle(pattern, i, a, b, c);
        add();
    }
    for (uint32_t k = 0; k < shared::side_count(pattern); ++k) {
        for (uint32_t i = 0; i < shared::strip_triangle_count(pattern, k); ++i) {
            shared::strip_triangle(pattern, k, i, a, b, c);
            add();
        }
    }
    for (uint32_t i = 0; i < shared::inner_vertex_count(pattern); ++i) {
        PatchSample& place = out.places[offsets.faces[f] + i];
        place.face = f;
        shared::locate_inner_vertex(pattern, i, place.u, place.v);
    }
}

void copy_positions(const Tessellation& tessellation, std::span<double> positions) {
    for (uint32_t i = 0; i < tessellation.vertex_count(); ++i) {
        const uint32_t source = tessellation.position_sources[i];
        if (source != i) std::copy_n(positions.data() + 3 * size_t{source}, 3, positions.data() + 3 * size_t{i});
    }
}

void unit_normal(const double* u, const double* v, double* normal) {
    const double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    const double length = std::hypot(n[0], n[1], n[2]);
    for (int k = 0; k < 3; ++k) normal[k] = length > 0 ? n[k] / length : (k == 2 ? 1.0 : 0.0);
}

/// The displaced surface at vertex i's place, and at two more along each of two directions.
struct DisplacedPlaces {
    shared::TessStep steps[2];
    PatchSample samples[5];
    double times[5];

    DisplacedPlaces(const PatchSample& place, bool triangle, double size) {
        for (uint32_t which = 0; which < 2; ++which) steps[which] = shared::make_step(triangle, which, place.u, place.v, size);
        for (uint32_t j = 0; j < 5; ++j) {
            const shared::TessStep& s = step(j);
            times[j] = j == 0 ? 0 : j % 2 == 1 ? s.t1 : s.t2;
            samples[j] = {place.face, std::clamp(place.u + times[j] * s.u, 0.0, 1.0),
                          std::clamp(place.v + times[j] * s.v, 0.0, 1.0)};
        }
    }
    const shared::TessStep& step(uint32_t j) const { return steps[j < 3 ? 0 : 1]; }
};

}  // namespace

Result<void> check_rate_settings(const RateSettings& settings) {
    const auto bad = [](const char* message) { return Error{ErrorCode::invalid_argument, message}; };
    if (settings.max_rate < 2 || settings.max_rate > shared::kMaxSideRate)
        return bad("the largest rate is not within 2 and 128");
    if (settings.mode != RateMode::per_edge && !(std::isfinite(settings.value) && settings.value > 0))
        return bad("a tessellation's rate, error or distance is not a positive number");
    if (!(settings.bound >= 0) || !std::isfinite(settings.bound)) return bad("the bound of displacement is no length");
    const bool looks = settings.cull_outside || settings.cull_backfaces ||
                       !(settings.mode == RateMode::uniform || settings.mode == RateMode::per_edge ||
                         settings.mode == RateMode::chord_error);
    if (!looks) return {};
    for (const float m : settings.camera.matrix)
        if (!std::isfinite(m)) return Error{ErrorCode::not_finite, "the camera's matrix holds what is no number"};
    const auto is_size = [](float x) { return std::isfinite(x) && x > 0; };
    if (!is_size(settings.camera.width) || !is_size(settings.camera.height))
        return bad("the camera's viewport has no size");
    const float* m = settings.camera.matrix;
    if (m[3] == 0 && m[7] == 0 && m[11] == 0 && m[15] == 0) return bad("the camera's matrix has no w");
    return {};
}

Result<std::vector<uint32_t>> compute_rates(const PatchTable& patches, const TessellationTable& table,
                                            const RateSettings& settings, std::span<const double> points,
                                            std::span<const float> edge_rates, double scale) {
    if (auto checked = check_rate_settings(settings); !checked) return checked.error();
    if (settings.mode == RateMode::per_edge && edge_rates.size() < table.rate_edge_count)
        return Error{ErrorCode::invalid_argument, "there are fewer rates than edges"};
    std::vector<PatchSample> samples(size_t{table.rate_edge_count} * shared::kRateSamples);
    for (uint32_t e = 0; e < table.rate_edge_count; ++e) {
        const uint32_t* edge = table.rate_edges.data() + size_t{e} * shared::kRateEdgeWords;
        for (uint32_t i = 0; i < shared::kRateSamples; ++i)
            samples[size_t{e} * shared::kRateSamples + i] =
                edge[0] == shared::kNoRateEdge ? PatchSample{kInvalidIndex, 0, 0} : rate_sample(table, edge, i);
    }
    std::vector<double> values(samples.size() * 3);
    std::vector<SampleStatus> statuses(samples.size());
    evaluate_patches(patches, samples, points, 3, Derivatives::none, values, statuses);
    const shared::RateCamera camera = rate_camera(settings.camera);
    std::vector<uint32_t> rates(table.rate_edge_count, 0);
    for (uint32_t e = 0; e < table.rate_edge_count; ++e) {
        const uint32_t* edge = table.rate_edges.data() + size_t{e} * shared::kRateEdgeWords;
        if (edge[0] == shared::kNoRateEdge) continue;
        shared::TessPoint p[shared::kRateSamples];
        for (uint32_t i = 0; i < shared::kRateSamples; ++i) {
            const double* value = values.data() + (size_t{e} * shared::kRateSamples + i) * 3;
            p[i] = {value[0], value[1], value[2]};
        }
        const double target =
            shared::edge_target(static_cast<uint32_t>(settings.mode), settings.value,
                                settings.mode == RateMode::per_edge ? edge_rates[e] : 0, settings.max_rate, camera, p[0],
                                p[1], p[2], p[3], p[4]);
        rates[e] = shared::round_rate(target, scale, static_cast<uint32_t>(settings.spacing), settings.max_rate,
                                      edge[0], shared::measures_edges(static_cast<uint32_t>(settings.mode)), scale < 1 ? shared::rate_dither(e) : -1);
    }
    return rates;
}

TessellationCounts count_tessellation(const TessellationTable& table, std::span<const uint32_t> rates,
                                      TessellationSpacing spacing) {
    assert(rates.size() >= table.rate_edge_count);
    return Tessellator{table, rates, spacing}.count();
}

Result<Tessellation> tessellate(const TessellationTable& table, std::span<const uint32_t> rates,
                                TessellationSpacing spacing) {
    if (rates.size() < table.rate_edge_count)
        return Error{ErrorCode::invalid_argument, "there are fewer rates than edges"};
    Tessellator tessellator{table, rates, spacing};
    const TessellationCounts counts = tessellator.count();
    if (counts.vertices > kInvalidIndex || 3 * counts.triangles > kInvalidIndex)
        return Error{ErrorCode::too_large, "a tessellation of 2^32 vertices or indices"};
    Tessellation out;
    out.places.resize(counts.vertices);
    out.position_sources.resize(counts.vertices);
    out.indices.resize(3 * counts.triangles);
    out.triangle_faces.resize(counts.triangles);
    tessellator.place(out);
    for_each_index(table.face_count, [&](uint32_t f) { tessellator.connect(f, out); }, 64);
    return out;
}

void evaluate_tessellation(const PatchTable& patches, const Tessellation& tessellation,
                           std::span<const double> points, std::span<double> positions, std::span<double> normals) {
    const size_t count = tessellation.vertex_count(), values_each = normals.empty() ? 1 : 3;
    assert(positions.size() >= 3 * count && (normals.empty() || normals.size() >= 3 * count));
    std::vector<double> values(count * values_each * 3);
    std::vector<SampleStatus> statuses(count);
    evaluate_patches(patches, tessellation.places, points, 3,
                     normals.empty() ? Derivatives::none : Derivatives::first, values, statuses);
    for (size_t i = 0; i < count; ++i) {
        const double* value = values.data() + i * values_each * 3;
        std::copy_n(value, 3, positions.data() + 3 * i);
        if (normals.empty()) continue;
        unit_normal(value + 3, value + 6, normals.data() + 3 * i);
    }
    copy_positions(tessellation, positions);
}

void displace_tessellation(const PatchTable& patches, const Tessellation& tessellation, std::span<const double> points,
                           std::span<const double> heights, double step, std::span<double> positions,
                           std::span<double> normals) {
    const bool triangle = patches.options.scheme == Scheme::loop;
    for_each_index(
        tessellation.vertex_count(),
        [&](uint32_t i) {
            const DisplacedPlaces places(tessellation.places[i], triangle, step);
            double values[5 * 9], moved[5][3], along[2][3] = {};
            SampleStatus statuses[5];
            evaluate_patches(patches, places.samples, points, 3, Derivatives::first, values, statuses);
            for (uint32_t j = 0; j < 5; ++j) {
                const double* value = values + 9 * j;
                const shared::TessStep& s = places.step(j);
                const double* h = heights.data() + 3 * size_t{i};
                const double height = h[0] + places.times[j] * (s.u * h[1] + s.v * h[2]);
                double normal[3];
                unit_normal(value + 3, value + 6, normal);
                for (int k = 0; k < 3; ++k) {
                    moved[j][k] = value[k] + height * normal[k];
                    if (j != 0) along[j < 3 ? 0 : 1][k] += (j % 2 == 1 ? s.w1 : s.w2) * (moved[j][k] - moved[0][k]);
                }
            }
            std::copy_n(moved[0], 3, positions.data() + 3 * size_t{i});
            if (!normals.empty()) unit_normal(along[0], along[1], normals.data() + 3 * size_t{i});
        },
        64);
    copy_positions(tessellation, positions);
}

void evaluate_tessellation_channel(const PatchTable& channel, const Tessellation& tessellation,
                                   std::span<const double> points, uint32_t width, std::span<double> values) {
    std::vector<SampleStatus> statuses(tessellation.vertex_count());
    evaluate_patches(channel, tessellation.places, points, width, Derivatives::none, values, statuses);
}

}  // namespace limn
