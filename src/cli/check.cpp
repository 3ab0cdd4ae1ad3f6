// limn check: models, refined by limn on a device and by OpenSubdiv in double, side by side.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "cli/check.h"
#include "limn/refinement.h"

namespace limn::cli {

#ifdef LIMN_HAVE_OPENSUBDIV

Extent extent_of(std::span<const float> points, size_t width) {
    Extent extent;
    double largest = 0;
    for (size_t k = 0; k < width; ++k) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (size_t i = k; i < points.size(); i += width) {
            low = std::min(low, static_cast<double>(points[i]));
            high = std::max(high, static_cast<double>(points[i]));
        }
        extent.size = std::max(extent.size, high - low);
        largest = std::max({largest, std::abs(low), std::abs(high)});
    }
    if (!(extent.size > 0)) extent.size = 1;
    extent.ulp = largest * std::ldexp(1.0, -23);
    return extent;
}

#endif

namespace {

#ifdef LIMN_HAVE_OPENSUBDIV

double worst_difference(std::span<const float> ours, std::span<const double> theirs) {
    if (ours.size() != theirs.size()) return HUGE_VAL;
    double worst = 0;
    for (size_t i = 0; i < ours.size(); ++i) {
        const double difference = std::abs(static_cast<double>(ours[i]) - theirs[i]);
        if (!(difference <= worst)) worst = difference;  // takes NaN, too
    }
    return worst;
}

/// Largest angle between normals, in degrees, where OpenSubdiv's tangents span a plane.
double worst_normal_angle(const LimitPoints& ours, const ReferenceLimits& theirs, double size) {
    double worst = 0;
    for (size_t i = 0; i < theirs.positions.size() / 3; ++i) {
        const Vector a = vector_at(theirs.tangents1, i), b = vector_at(theirs.tangents2, i);
        const Vector p = vector_at(ours.tangents1, i), q = vector_at(ours.tangents2, i);
        const Vector reference = cross(a, b), normal = cross(p, q);
        constexpr double kDegenerate =
            1e-3;  // sine of the angle between tangents, and their length against the model
        if (reference.length() < kDegenerate * a.length() * b.length()) continue;
        if (std::min(a.length(), b.length()) < 1e-4 * size) continue;
        const double sine = cross(reference, normal).length() / (reference.length() * normal.length());
        const double angle = std::asin(std::min(1.0, sine)) * 180 / std::numbers::pi;
        if (!(angle <= worst)) worst = angle;
    }
    return worst;
}

Result<void> check_points(Check& check, const Refinement& refinement) {
    const auto faces = check.reference.face_vertices();
    const Array<uint32_t>& ours = refinement.last().face_vertices;
    const bool same = std::equal(ours.begin(), ours.end(), faces.begin(), faces.end());
    check.rows.push_back({"faces", same ? 0.0 : 1.0, 0, "mismatch"});
    const std::vector<double> expected = check.reference.refine(check.points());
    const Extent extent = extent_of(check.points(), 3);
    const double tolerance = extent.point_tolerance();

    std::vector<StencilTable> chain;
    for (uint32_t level = 1; level <= check.options.level; ++level) {
        Result<StencilTable> table = build_step_table<float>(refinement, level);
        if (!table) return table.error();
        chain.push_back(std::move(*table));
    }
    const auto stepped = check.runners.points.run(chain, check.points(), 3);
    if (!stepped) return stepped.error();
    check.rows.push_back(
        {"points, level by level", worst_difference(*stepped, expected) / extent.size, tolerance, "of size"});

    const Result<StencilTable> table = build_stencil_table<float>(refinement, check.options.level);
    if (!table) return table.error();
    const auto composed = check.runners.points.run({&*table, 1}, check.points(), 3);
    if (!composed) return composed.error();
    check.rows.push_back(
        {"points, one table", worst_difference(*composed, expected) / extent.size, tolerance, "of size"});
    return {};
}

Result<void> check_limits(Check& check, const Refinement& refinement) {
    const Result<StencilTable> table = build_limit_table<float>(refinement, check.options.level, true);
    if (!table) return table.error();
    const Result<LimitPoints> limits = check.runners.points.run_limits(*table, check.points());
    if (!limits) return limits.error();
    const ReferenceLimits expected = check.reference.limits(check.points());
    const Extent extent = extent_of(check.points(), 3);
    check.rows.push_back({"limit points",
                          worst_difference(limits->positions, expected.positions) / extent.size,
                          extent.point_tolerance(), "of size"});
    check.rows.push_back(
        {"limit normals", worst_normal_angle(*limits, expected, extent.size), 0.1, "degrees"});
    return {};
}

Result<void> check_texture_coordinates(Check& check) {
    if (check.loaded.mesh.channels.empty()) return {};
    Result<Refinement> refinement =
        build_face_varying_refinement(check.loaded.mesh, 0, {check.options.level, false});
    if (!refinement) return refinement.error();
    const Result<StencilTable> table = build_stencil_table<float>(*refinement, check.options.level);
    if (!table) return table.error();
    const auto values = check.runners.points.run({&*table, 1}, check.loaded.model.texture_coordinates, 2);
    if (!values) return values.error();
    std::vector<float> corners;
    for (const uint32_t i : refinement->last().face_vertices)
        corners.insert(corners.end(), {(*values)[2 * i], (*values)[2 * i + 1]});
    const Extent extent = extent_of(check.loaded.model.texture_coordinates, 2);
    const auto expected = check.reference.refine_face_varying(check.loaded.model.texture_coordinates);
    check.rows.push_back({"texture coordinates", worst_difference(corners, expected) / extent.size,
                          extent.point_tolerance(), "of size"});
    return {};
}

/// How far limn's own limits are from the compatible ones: not an error, but worth knowing.
Result<double> default_departure(const Check& check, const Refinement& compatible) {
    ControlMesh mesh = check.loaded.mesh;
    mesh.options.opensubdiv_compatible = false;
    const Result<Refinement> refinement = build_refinement(mesh, {0, false});
    if (!refinement) return refinement.error();
    std::vector<double> positions[2];
    const Refinement* sides[] = {&*refinement, &compatible};
    for (size_t i = 0; i < 2; ++i) {
        const auto table = build_limit_table<double>(*sides[i], check.options.level);
        if (!table) return table.error();
        const std::vector<double> source(check.points().begin(), check.points().end());
        positions[i].resize(size_t{table->row_count()} * 3);
        apply_stencil_table<double>(*table, source, positions[i], 3);
    }
    double worst = 0;
    for (size_t i = 0; i < positions[0].size(); ++i)
        worst = std::max(worst, std::abs(positions[0][i] - positions[1][i]));
    return worst / extent_of(check.points(), 3).size;
}

bool print(const std::string& path, const Check& check, double departure) {
    std::printf("%s, level %u, on %s\n", path.c_str(), check.options.level,
                check.runners.device.name().c_str());
    bool ok = true;
    for (const Row& row : check.rows) {
        std::printf("  %-24s %9.2e  of %.1e %s  %s%s\n", row.what.c_str(), row.error, row.tolerance, row.unit,
                    row.ok() ? "ok" : "OUT", row.remark.empty() ? "" : ("  (" + row.remark + ")").c_str());
        ok = ok && row.ok();
    }
    for (const std::string& note : check.notes) std::printf("  %s\n", note.c_str());
    if (departure > 1e-9)
        std::printf("  limn's own limit points, without --compat opensubdiv, lie up to %.2e of size away\n",
                    departure);
    return ok;
}

Result<bool> check_model(const std::string& path, const CheckOptions& options, const Runners& runners) {
    auto progress = std::make_unique<Progress>();
    progress->show("checking " + path);
    SurfaceOptions surface = options.surface;
    surface.compat = "opensubdiv";
    const Result<LoadedModel> loaded = load_model(path, surface);
    if (!loaded) return loaded.error();
    const Result<Refinement> refinement = build_refinement(loaded->mesh, {options.level, false});
    if (!refinement) return refinement.error();
    const Result<OpenSubdivReference> reference = OpenSubdivReference::create(loaded->mesh, options.level);
    if (!reference) return Error{reference.error().code, path + ": " + reference.error().message};
    Check check{options, runners, *loaded, *reference, {}, {}};
    if (auto done = check_points(check, *refinement); !done) return done.error();
    if (auto done = check_limits(check, *refinement); !done) return done.error();
    if (auto done = check_texture_coordinates(check); !done) return done.error();
    if (auto done = check_surface(check); !done) return done.error();
    const Result<double> departure = default_departure(check, *refinement);
    if (!departure) return departure.error();
    progress.reset();
    return print(path, check, *departure);
}

int run(const CheckOptions& options) {
    const Result<RunDevice> device = RunDevice::create(options.device);
    if (!device) return fail(device.error());
    const Result<PointRunner> points = PointRunner::create(*device);
    if (!points) return fail(points.error());
    const Result<SurfaceRunner> surfaces = SurfaceRunner::create(*device);
    if (!surfaces) return fail(surfaces.error());
    const Runners runners{*device, *points, *surfaces};
    bool all_ok = true;
    for (const std::string& path : options.models) {
        const Result<bool> ok = check_model(path, options, runners);
        if (!ok) return fail(ok.error());
        all_ok = all_ok && *ok;
    }
    if (auto silent = device->check_validation(); !silent) return fail(silent.error());
    std::printf(all_ok ? "all within tolerance\n" : "out of tolerance\n");
    return all_ok ? 0 : kBadInput;
}

#else

int run(const CheckOptions&) {
    return fail({ErrorCode::unsupported, "built without OpenSubdiv: 'check' has nothing to compare with"});
}

#endif

}  // namespace

void add_check(CLI::App& program, int& status) {
    auto options = std::make_shared<CheckOptions>();
    CLI::App* command =
        program.add_subcommand("check", "Cross-check models against OpenSubdiv, in double precision");
    command->add_option("MODEL", options->models, "OBJ files")->required();
    command->add_option("--level", options->level, "Refinement level to compare at, 1 to 6")
        ->check(CLI::Range(1u, 6u))
        ->capture_default_str();
    add_surface_options(*command, options->surface, SchemesTaken::opensubdiv);
    add_device_option(*command, options->device);
    command->footer(
        "Exit status 1 if any error is out of tolerance. OpenSubdiv's deviations from its own limit are "
        "reproduced (--compat opensubdiv), so that everything can be compared.");
    command->callback([options, &status] { status = run(*options); });
}

}  // namespace limn::cli
