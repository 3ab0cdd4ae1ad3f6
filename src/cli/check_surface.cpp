// limn check: the limit surface, at random places of some faces and at refined vertices.
//
// The truth are limits of refined vertices and OpenSubdiv's spline patches, which are exact. Its end caps are
// not: points within them are compared by the size of the cap, and rows say how far OpenSubdiv is off at the
// isolation levels that are in use.
#include <algorithm>
#include <limits>
#include <numbers>
#include <random>
#include <set>

#include "cli/check.h"
#include "limn/evaluate.h"
#include "limn/patch_table.h"

namespace limn::cli {
namespace {

constexpr uint32_t kIsolationLevel = 10, kUsualLevel = 6, kUsualSmoothLevel = 2;
constexpr uint32_t kFaces = 200, kPlacesPerPtexFace = 12;
constexpr double kCapTolerance = 0.3;  // of the size of an end cap
constexpr double kBfrTolerance = 5e-5, kNormalTolerance = 0.1;
// Derivatives are told at the scale of the patch, where its u and v go from 0 to 1.
constexpr double kDoubleTolerance = 1e-11, kSecondTolerance = 2e-5;
// Sharpness is float in OpenSubdiv, and so is the share of a rule that fades.
constexpr double kFadingTolerance = 1e-7;
// OpenSubdiv's limits of face-varying values have weights in float.
constexpr double kTextureTolerance = 1e-7;

using Samples = std::vector<PatchSample>;

/// Values at samples: P and derivatives, 3 numbers each.
struct SurfaceValues {
    uint32_t count = 0;
    std::vector<double> numbers;
    std::vector<SampleStatus> statuses;
    bool valid(size_t s) const { return statuses[s] == SampleStatus::valid; }
    Vector at(size_t s, size_t k) const { return vector_at(numbers, s * count + k); }
};

/// limn's surface in double.
SurfaceValues evaluate_surface(const PatchTableDouble& table, std::span<const float> control_points,
                               uint32_t width, const Samples& samples, Derivatives derivatives) {
    SurfaceValues values;
    values.count = value_count(derivatives);
    values.numbers.resize(samples.size() * values.count * width);
    values.statuses.resize(samples.size());
    std::vector<double> points(size_t{table.point_count()} * width);
    build_patch_points<double>(table, std::vector<double>(control_points.begin(), control_points.end()),
                               width, points);
    evaluate_patches<double>(table, samples, points, width, derivatives, values.numbers, values.statuses);
    return values;
}

/// The same from a table in float, on the device or the host in its place.
Result<SurfaceValues> evaluate_surface(const SurfaceRunner& runner, const RunSurface& surface,
                                       const Samples& samples, Derivatives derivatives) {
    std::vector<SurfaceSample> places;
    for (const PatchSample& s : samples)
        places.push_back({s.face, static_cast<float>(s.u), static_cast<float>(s.v)});
    auto run = runner.run(surface, places, derivatives);
    if (!run) return run.error();
    return SurfaceValues{
        value_count(derivatives), {run->numbers.begin(), run->numbers.end()}, std::move(run->statuses)};
}

double distance(const Vector& a, const std::array<double, 3>& b) {
    return Vector{{a.x[0] - b[0], a.x[1] - b[1], a.x[2] - b[2]}}.length();
}

void keep_worst(double& worst, double error) {
    if (!(error <= worst)) worst = error;  // takes NaN, too
}

std::string number(double value) {
    char text[32];
    std::snprintf(text, sizeof(text), "%.1e", value);
    return text;
}

/// The place next to (u, v) that is exact in float, as devices take it, and within the face.
PatchSample round_place(uint32_t ptex, double u, double v, bool triangles) {
    const float a = static_cast<float>(std::clamp(u, 0.0, 1.0));
    float b = static_cast<float>(std::clamp(v, 0.0, 1.0));
    while (triangles && static_cast<double>(a) + static_cast<double>(b) > 1) b = std::nextafter(b, 0.0f);
    return {ptex, static_cast<double>(a), static_cast<double>(b)};
}

/// Random places of up to kFaces faces, half of them close to corners.
struct Places {
    std::vector<uint32_t> faces;
    Samples samples;
};
Places choose_places(const ControlMesh& mesh) {
    std::mt19937_64 random(1);
    auto uniform = [&] { return std::ldexp(static_cast<double>(random() >> 11), -53); };
    const uint32_t face_count = mesh.face_count();
    std::set<uint32_t> chosen;
    while (chosen.size() < std::min(kFaces, face_count))
        chosen.insert(face_count <= kFaces ? static_cast<uint32_t>(chosen.size())
                                           : static_cast<uint32_t>(random() % face_count));
    const bool triangles = mesh.options.scheme == Scheme::loop;
    Places places;
    uint32_t ptex = 0;
    for (uint32_t f = 0; f < face_count; ++f) {
        const uint32_t size = mesh.face_offsets[f + 1] - mesh.face_offsets[f];
        const uint32_t count = size == (triangles ? 3u : 4u) ? 1 : size;
        if (chosen.count(f) != 0) places.faces.push_back(f);
        for (uint32_t i = 0; chosen.count(f) != 0 && i < count * kPlacesPerPtexFace; ++i) {
            double u = uniform(), v = uniform();
            if (triangles && u + v > 1) {
                u = 1 - u;
                v = 1 - v;
            }
            const double scale = i % 2 == 0 ? 1 : std::exp2(-std::floor(14 * uniform()));
            u *= scale;
            v *= scale;
            for (auto turn = random() % (triangles ? 3 : 4); turn > 0; --turn)
                v = std::exchange(u, triangles ? 1 - u - v : 1 - v);
            places.samples.push_back(round_place(ptex + i / kPlacesPerPtexFace, u, v, triangles));
        }
        ptex += count;
    }
    return places;
}

/// Angle between normals in degrees, or nothing where either has none to speak of.
std::optional<double> normal_angle(const Vector& a, const Vector& b, const Vector& p, const Vector& q) {
    constexpr double kDegenerate = 1e-2;  // sine of the angle between tangents
    const Vector m = cross(a, b), n = cross(p, q);
    if (!(m.length() > kDegenerate * a.length() * b.length())) return {};
    if (!(n.length() > kDegenerate * p.length() * q.length())) return {};
    const double cosine = m.x[0] * n.x[0] + m.x[1] * n.x[1] + m.x[2] * n.x[2];
    return std::atan2(cross(m, n).length(), cosine) * 180 / std::numbers::pi;
}

/// The worst errors of one side against spline patches, in the units of the rows.
struct Errors {
    double points = 0, first = 0, second = 0;
    double normals = 0, deep_normals = 0;  ///< to the usual isolation level, and in deeper patches
    double all_normals() const { return std::max(normals, deep_normals); }
};

Vector vector_of(const std::array<double, 3>& a) {
    return {{a[0], a[1], a[2]}};
}

void compare_place(const ReferencePlace& truth, const std::array<Vector, 6>& values, double size,
                   Errors& errors) {
    const double unit = size * std::exp2(truth.depth), unit2 = unit * std::exp2(truth.depth);
    keep_worst(errors.points, distance(values[0], truth.values[0]) / size);
    for (size_t k = 1; k < 3; ++k) keep_worst(errors.first, distance(values[k], truth.values[k]) / unit);
    for (size_t k = 3; k < 6; ++k) keep_worst(errors.second, distance(values[k], truth.values[k]) / unit2);
    const auto angle =
        normal_angle(values[1], values[2], vector_of(truth.values[1]), vector_of(truth.values[2]));
    if (angle) keep_worst(truth.depth > kUsualLevel ? errors.deep_normals : errors.normals, *angle);
}

/// At the places that lie in spline patches of `truth`.
Errors compare(const SurfaceValues& ours, const std::vector<ReferencePlace>& truth, double size) {
    Errors errors;
    for (size_t s = 0; s < truth.size(); ++s) {
        if (ours.valid(s) != truth[s].valid) errors.points = HUGE_VAL;
        if (!truth[s].valid || !truth[s].regular) continue;
        compare_place(
            truth[s],
            {ours.at(s, 0), ours.at(s, 1), ours.at(s, 2), ours.at(s, 3), ours.at(s, 4), ours.at(s, 5)}, size,
            errors);
    }
    return errors;
}
Errors compare(const std::vector<ReferencePlace>& theirs, const std::vector<ReferencePlace>& truth,
               double size) {
    Errors errors;
    for (size_t s = 0; s < truth.size(); ++s) {
        if (!truth[s].valid || !truth[s].regular) continue;
        std::array<Vector, 6> values;
        for (size_t k = 0; k < 6; ++k) values[k] = vector_of(theirs[s].values[k]);
        compare_place(truth[s], values, size, errors);
    }
    return errors;
}

struct SurfaceCheck {
    Check& check;
    Extent extent;
    double exact;  ///< tolerance of what both compute in double
    PatchTableDouble table;
    PatchTable float_table;
    RunSurface device_surface;  ///< of float_table, on the device or the host in its place
    Places places;
    SurfaceValues ours;

    const ControlMesh& mesh() const { return check.loaded.mesh; }
    void add(const std::string& what, double error, double tolerance, const char* unit,
             std::string remark = {}) {
        check.rows.push_back({what, error, tolerance, unit, std::move(remark)});
    }
    /// Rows of the float table are the device's: its own, or of the host in its place.
    std::string device_row(const char* what) const {
        return (check.runners.device.is_host() ? "float table, " : "device ") + std::string(what);
    }
    Result<void> check_patches();
    Result<void> check_patches_on_device(const std::vector<ReferencePlace>& far);
    void check_caps(const std::vector<ReferencePlace>& far);
    Result<void> check_same_caps(std::vector<ReferencePlace> far);
    void check_bfr(const OpenSubdivSurface& surface, const std::vector<ReferencePlace>& far);
    Result<void> check_refined_vertices();
    Result<void> check_texture_coordinates();
};

/// Chaikin creasing in Far's adaptive refinement sees only the edges that it refines, and Bfr has rules of
/// its own: neither can be compared with.
bool has_chaikin_creases(const ControlMesh& mesh) {
    return mesh.options.creasing == CreasingMethod::chaikin &&
           std::any_of(mesh.crease_sharpness.begin(), mesh.crease_sharpness.end(),
                       [](float s) { return s > 0 && !is_infinite(s); });
}

Result<void> SurfaceCheck::check_patches() {
    if (has_chaikin_creases(mesh())) {
        check.notes.push_back(
            "Chaikin creases: OpenSubdiv's patches and Bfr are no reference, refined vertices are");
        return {};
    }
    const auto surface = OpenSubdivSurface::create(mesh(), kIsolationLevel, places.faces);
    if (!surface) return surface.error();
    const auto usual = OpenSubdivSurface::create(mesh(), kUsualLevel, places.faces);
    if (!usual) return usual.error();
    const std::vector<ReferencePlace> far = surface->far_places(check.points(), places.samples);
    const Errors errors = compare(ours, far, extent.size);
    const std::vector<ReferencePlace> usual_far = usual->far_places(check.points(), places.samples);
    const Errors theirs = compare(usual_far, far, extent.size);
    const std::string peer = "OpenSubdiv, level " + std::to_string(kUsualLevel) + ": ";
    add("surface points", errors.points, exact, "of size", peer + number(theirs.points));
    add("surface derivatives", errors.first, exact, "of size", peer + number(theirs.first));
    add("surface 2nd derivatives", errors.second, exact, "of size", peer + number(theirs.second));
    add("surface normals", errors.all_normals(), kNormalTolerance, "degrees",
        peer + number(theirs.all_normals()));
    check_caps(far);
    if (auto done = check_same_caps(usual_far); !done) return done;
    check_bfr(*surface, far);

    return check_patches_on_device(far);
}

/// Like for like: a table with OpenSubdiv's end caps at the same level, where those are.
Result<void> SurfaceCheck::check_same_caps(std::vector<ReferencePlace> far) {
    const auto table = build_patch_table<double>(
        mesh(), {.end_cap = EndCap::gregory_opensubdiv, .isolation_level = kUsualLevel});
    if (!table) return table.error();
    for (ReferencePlace& place : far) place.regular = !place.regular;
    const Errors errors = compare(
        evaluate_surface(*table, check.points(), 3, places.samples, Derivatives::second), far, extent.size);
    const std::string level = "both at level " + std::to_string(kUsualLevel);
    add("same end caps, points", errors.points, exact, "of size", level);
    add("same end caps, derivs.", std::max(errors.first, errors.second), exact, "of size", level);
    return {};
}

Result<void> SurfaceCheck::check_patches_on_device(const std::vector<ReferencePlace>& far) {
    const auto values =
        evaluate_surface(check.runners.surfaces, device_surface, places.samples, Derivatives::second);
    if (!values) return values.error();
    const Errors errors = compare(*values, far, extent.size);
    add(device_row("points"), errors.points, extent.point_tolerance(), "of size");
    add(device_row("derivatives"), errors.first, extent.point_tolerance(), "of size");
    add(device_row(check.runners.device.is_host() ? "2nd deriv." : "2nd derivatives"), errors.second,
        kSecondTolerance, "of size");
    if (4 * extent.ulp > 2e-6 * extent.size)
        check.notes.push_back(
            "far from the origin for its size: already rounding of the coordinates turns "
            "normals, which moving the model there avoids");
    // Close to an irregular vertex, rounding of the weights weighs as much as what is left of the face.
    add(device_row("normals"), errors.normals, kNormalTolerance, "degrees",
        "in patches deeper than level " + std::to_string(kUsualLevel) + ": " + number(errors.deep_normals));
    return {};
}

void SurfaceCheck::check_caps(const std::vector<ReferencePlace>& far) {
    double worst = 0, absolute = 0, normals = 0;
    size_t count = 0;
    for (size_t s = 0; s < far.size(); ++s) {
        if (!far[s].valid || far[s].regular || !ours.valid(s)) continue;
        ++count;
        const double error = distance(ours.at(s, 0), far[s].values[0]);
        keep_worst(absolute, error / extent.size);
        keep_worst(worst, std::max(0.0, error - kDoubleTolerance * extent.size) / far[s].cap_size);
        const auto angle = normal_angle(ours.at(s, 1), ours.at(s, 2), vector_of(far[s].values[1]),
                                        vector_of(far[s].values[2]));
        if (angle) keep_worst(normals, *angle);
    }
    if (count == 0) return;
    add("points, irregular", worst, kCapTolerance, "of end cap", number(absolute) + " of size");
    check.notes.push_back("in the end caps of OpenSubdiv at level " + std::to_string(kIsolationLevel) +
                          " normals differ by up to " + number(normals) +
                          " degrees: by its cross tangents, and by where it stops");
}

void SurfaceCheck::check_bfr(const OpenSubdivSurface& surface, const std::vector<ReferencePlace>& far) {
    if (!check.reference.bfr_is_safe()) {
        check.notes.push_back("no comparison with Bfr: not manifold, or with interior vertices of two faces");
        return;
    }
    const std::vector<ReferencePlace> bfr =
        surface.bfr_places(check.points(), kIsolationLevel, places.samples);
    double worst = 0, normals = 0;
    for (size_t s = 0; s < bfr.size(); ++s) {
        if (ours.valid(s) != bfr[s].valid) worst = HUGE_VAL;
        if (!ours.valid(s) || !bfr[s].valid) continue;
        const double cap = kCapTolerance * far[s].cap_size;  // as inexact within as Far
        keep_worst(worst, std::max(0.0, distance(ours.at(s, 0), bfr[s].values[0]) - cap) / extent.size);
        if (!far[s].regular) continue;
        const auto angle = normal_angle(ours.at(s, 1), ours.at(s, 2), vector_of(bfr[s].values[1]),
                                        vector_of(bfr[s].values[2]));
        if (angle) keep_worst(normals, *angle);
    }
    add("surface points, Bfr", worst, kBfrTolerance, "of size");
    add("surface normals, Bfr", normals, kNormalTolerance, "degrees");
}

/// The place on the base faces of each face corner of a refinement, in order.
struct Walk {
    bool triangles;
    Samples corners = {};

    void visit(uint32_t ptex, double u, double v, double size, uint32_t levels) {
        if (levels == 0) {
            constexpr double us[2][4] = {{0, 1, 1, 0}, {0, 1, 0, 0}}, vs[2][4] = {{0, 0, 1, 1}, {0, 0, 1, 0}};
            for (size_t k = 0; k < (triangles ? 3u : 4u); ++k)
                corners.push_back({ptex, u + size * us[triangles][k], v + size * vs[triangles][k]});
            return;
        }
        const double h = size / 2;
        visit(ptex, u, v, h, levels - 1);
        visit(ptex, u + h, v, h, levels - 1);
        visit(ptex, triangles ? u : u + h, v + h, h, levels - 1);
        visit(ptex, triangles ? u + h : u, v + h, triangles ? -h : h, levels - 1);  // the centre is turned
    }
};

Samples corner_places(const ControlMesh& mesh, uint32_t level) {
    Walk walk{mesh.options.scheme == Scheme::loop};
    uint32_t ptex = 0;
    for (uint32_t f = 0; f < mesh.face_count(); ++f) {
        const uint32_t size = mesh.face_offsets[f + 1] - mesh.face_offsets[f];
        const bool whole = size == (walk.triangles ? 3u : 4u);
        for (uint32_t c = 0; c < (whole ? 1 : size); ++c)
            walk.visit(ptex++, 0, 0, 1, level - (whole ? 0 : 1));
    }
    return std::move(walk.corners);
}

Result<void> SurfaceCheck::check_refined_vertices() {
    const uint32_t level = check.options.level;
    const std::vector<double> limits = check.reference.limits(check.points()).positions;
    const std::vector<uint8_t> compared = check.reference.vertices_with_true_limits();
    const std::vector<uint32_t> vertices = check.reference.face_vertices();
    const Samples corners = corner_places(mesh(), level);
    Samples samples(compared.size(), PatchSample{kInvalidIndex, 0, 0});
    for (size_t i = 0; i < vertices.size(); ++i) samples[vertices[i]] = corners[i];
    const SurfaceValues values = evaluate_surface(table, check.points(), 3, samples, Derivatives::none);
    const auto rounded = evaluate_surface(check.runners.surfaces, device_surface, samples, Derivatives::none);
    if (!rounded) return rounded.error();
    const auto usual = OpenSubdivSurface::create(mesh(), kUsualSmoothLevel, places.faces);
    if (!usual) return usual.error();
    const std::vector<ReferencePlace> theirs = usual->far_places(check.points(), samples);
    double ours_worst = 0, rounded_worst = 0, theirs_worst = 0;
    size_t left_out = 0;
    for (size_t v = 0; v < samples.size(); ++v) {
        if (!values.valid(v)) continue;
        if (compared[v] == 0) {
            ++left_out;
            continue;
        }
        const std::array<double, 3> truth = {limits[3 * v], limits[3 * v + 1], limits[3 * v + 2]};
        keep_worst(ours_worst, distance(values.at(v, 0), truth) / extent.size);
        keep_worst(rounded_worst, distance(rounded->at(v, 0), truth) / extent.size);
        if (theirs[v].valid)
            keep_worst(theirs_worst, distance(vector_of(theirs[v].values[0]), truth) / extent.size);
    }
    add("surface, level-" + std::to_string(level) + " limits", ours_worst, exact, "of size",
        "OpenSubdiv, level " + std::to_string(kUsualSmoothLevel) + ": " + number(theirs_worst));
    add(device_row("limits"), rounded_worst, extent.point_tolerance(), "of size");
    if (left_out != 0)
        check.notes.push_back(
            "limits left out at " + std::to_string(left_out) + " of " + std::to_string(samples.size()) +
            " vertices, where OpenSubdiv's is not that of its refinement: at infinitely sharp darts (which "
            "the surface does not reproduce with --compat opensubdiv), where sharpness has yet to fade, "
            "and inside at vertices of two faces");
    return {};
}

/// The first face-varying channel at the face corners of the refinement.
Result<void> SurfaceCheck::check_texture_coordinates() {
    if (mesh().channels.empty()) return {};
    const auto exact_table = build_face_varying_patch_table<double>(mesh(), 0, {});
    const auto rounded_table = build_face_varying_patch_table<float>(mesh(), 0, {});
    if (!exact_table || !rounded_table) {
        const Error error = (exact_table ? rounded_table.error() : exact_table.error());
        if (error.code != ErrorCode::unsupported) return error;
        check.notes.push_back("texture coordinates on the surface: " + error.message);
        return {};
    }
    const std::span<const float> values = check.loaded.model.texture_coordinates;
    const Samples samples = corner_places(mesh(), check.options.level);
    const std::vector<double> limits = check.reference.face_varying_limits(values);
    const std::vector<uint8_t> compared = check.reference.vertices_with_true_limits();
    const std::vector<uint32_t> vertices = check.reference.face_vertices();
    const SurfaceValues ours = evaluate_surface(*exact_table, values, 2, samples, Derivatives::none);
    const auto surface = check.runners.surfaces.prepare(*rounded_table, values, 2);
    if (!surface) return surface.error();
    const auto rounded = evaluate_surface(check.runners.surfaces, *surface, samples, Derivatives::none);
    if (!rounded) return rounded.error();
    const Extent range = extent_of(values, 2);
    double ours_worst = 0, rounded_worst = 0;
    for (size_t i = 0; i < 2 * samples.size(); ++i) {
        if (!ours.valid(i / 2) || compared[vertices[i / 2]] == 0) continue;
        keep_worst(ours_worst, std::abs(ours.numbers[i] - limits[i]) / range.size);
        keep_worst(rounded_worst, std::abs(rounded->numbers[i] - limits[i]) / range.size);
    }
    add("surface, texture", ours_worst, kTextureTolerance, "of size");
    add(device_row("texture"), rounded_worst, range.point_tolerance(), "of size");
    return {};
}

}  // namespace

Result<void> check_surface(Check& check) {
    auto table = build_patch_table<double>(check.loaded.mesh, {});
    if (!table) return table.error();
    auto float_table = build_patch_table<float>(check.loaded.mesh, {});
    if (!float_table) return float_table.error();
    const ControlMesh& mesh = check.loaded.mesh;
    auto is_fading = [](float s) { return s > 0 && !is_infinite(s); };
    const bool fading = std::any_of(mesh.crease_sharpness.begin(), mesh.crease_sharpness.end(), is_fading) ||
                        std::any_of(mesh.corner_sharpness.begin(), mesh.corner_sharpness.end(), is_fading);
    SurfaceCheck surface{check,
                         extent_of(check.points(), 3),
                         fading ? kFadingTolerance : kDoubleTolerance,
                         std::move(table).value(),
                         std::move(float_table).value(),
                         {},
                         choose_places(mesh),
                         {}};
    auto device_surface = check.runners.surfaces.prepare(surface.float_table, check.points(), 3);
    if (!device_surface) return device_surface.error();
    surface.device_surface = std::move(device_surface).value();
    surface.ours =
        evaluate_surface(surface.table, check.points(), 3, surface.places.samples, Derivatives::second);
    if (auto done = surface.check_patches(); !done) return done.error();
    if (auto done = surface.check_refined_vertices(); !done) return done.error();
    return surface.check_texture_coordinates();
}

}  // namespace limn::cli
