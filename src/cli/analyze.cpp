// limn analyze: what a scheme does at each valence, from its own steps.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/plot.h"
#include "cli/program.h"
#include "limn/schemes/scheme_analysis.h"

namespace limn::cli {
namespace {

struct Options {
    std::string scheme, output;
    std::vector<uint32_t> valences;
    uint32_t boundary = 0, crease = 0;
    bool dart = false, json = false;
};

/// Of one star, or why there is none.
struct Star {
    AnalysisOptions options;
    Result<SchemeAnalysis> analysis;

    /// A piece of the surface, which has no symmetry.
    bool is_piece() const { return options.boundary || options.crease != 0 || options.dart; }
};

std::string name_of(const SubdivisionScheme& scheme, const AnalysisOptions& options) {
    const uint32_t n = options.valence;
    if (options.boundary) return "boundary vertex of " + plural(n, "face");
    if (options.crease != 0)
        return "crease vertex, the side of " + plural(options.crease, "face") + " of " + std::to_string(n);
    if (options.dart) return "end of a crease between " + plural(n, "face");
    return scheme.dual ? "face of " + plural(n, "side") : "vertex of " + plural(n, "face");
}

const char* yes_or_no(bool yes) {
    return yes ? "yes" : "no";
}

std::string number(std::complex<double> value) {
    char text[80];
    if (std::abs(value.imag()) < 1e-9)
        std::snprintf(text, sizeof text, "%.6f", std::abs(value.real()) < 5e-7 ? 0 : value.real());
    else
        std::snprintf(text, sizeof text, "%.6f%+.6fi", value.real(), value.imag());
    return text;
}

/// "0.25 x3  0.125": those that differ from nothing, how often each.
std::string list_eigenvalues(const std::vector<std::complex<double>>& values) {
    constexpr size_t kShown = 8;
    std::string out;
    size_t shown = 0;
    for (size_t i = 0, end = 0; i < values.size() && std::abs(values[i]) > 1e-7; i = end) {
        while (end < values.size() && std::abs(values[end] - values[i]) < 1e-7) ++end;
        if (++shown > kShown) return out + "  ...";
        out += "  " + number(values[i]);
        if (end - i > 1) out += " x" + std::to_string(end - i);
    }
    return out;
}

void print_one(const SubdivisionScheme& scheme, const Star& star) {
    const SchemeAnalysis& a = *star.analysis;
    std::printf("%s, %s\n", scheme.title, name_of(scheme, star.options).c_str());
    std::printf("  continuity           %s\n", describe(a.continuity));
    if (a.steps > 1) std::printf("  eigenvalues          of %u steps together\n", a.steps);
    if (star.options.dart) {
        std::printf("  subdominant          %.9f, %.9f\n  the next             %.9f\n", a.lambda, a.lambda_cross, a.third);
    } else if (star.is_piece()) {
        std::printf("  along the %-10s %.9f\n  across it            %.9f\n",
                    star.options.boundary ? "boundary" : "crease", a.lambda, a.lambda_cross);
        std::printf("  the next             %.9f\n", a.third);
    } else {
        std::printf("  subdominant, lambda  %.9f\n  the next             %.9f\n", a.lambda, a.third);
        std::printf("  curvature            %s: lambda^2 %.6f, mu0 %s, mu2 %s\n", describe(a.curvature),
                    a.lambda * a.lambda, number(a.mu0).c_str(), star.options.valence < 4 ? "-" : number(a.mu2).c_str());
    }
    if (a.points.empty())
        std::printf("  characteristic map   none\n");
    else
        std::printf("  characteristic map   regular: %s, injective: %s\n", yes_or_no(a.map_is_regular),
                    yes_or_no(a.map_is_injective));
    for (const auto& [frequency, eigenvalues] : a.frequencies) {
        const std::string name = star.is_piece() ? "eigenvalues" : "frequency " + std::to_string(frequency);
        std::printf("  %-18s %s\n", name.c_str(), list_eigenvalues(eigenvalues).c_str());
    }
}

void print_table(const SubdivisionScheme& scheme, const std::vector<Star>& stars) {
    std::printf("%s\n%s", scheme.title, scheme.reconstructed ? "(with reconstructed rules)\n" : "");
    std::printf("%7s  %-9s %-9s %-9s %-19s %-9s %-20s %s\n", scheme.dual ? "sides" : "valence", "lambda", "third",
                "lambda^2", "mu0", "mu2", "curvature", "continuity");
    for (const Star& star : stars) {
        if (!star.analysis) {
            std::printf("%7u  %s\n", star.options.valence, star.analysis.error().message.c_str());
            continue;
        }
        const SchemeAnalysis& a = *star.analysis;
        std::printf("%7u  %.6f  %.6f  %.6f  %-19s %-9s %-20s %s\n", star.options.valence, a.lambda, a.third,
                    a.lambda * a.lambda, number(a.mu0).c_str(), star.options.valence < 4 ? "-" : number(a.mu2).c_str(),
                    describe(a.curvature), describe(a.continuity));
    }
}

nlohmann::json json_of(std::complex<double> value) {
    if (std::abs(value.imag()) < 1e-12) return value.real();
    return nlohmann::json::array({value.real(), value.imag()});
}

nlohmann::json json_of(const Star& star) {
    nlohmann::json out = {{"valence", star.options.valence}, {"boundary", star.options.boundary}};
    if (star.options.crease != 0) out["crease"] = star.options.crease;
    if (star.options.dart) out["dart"] = true;
    if (!star.analysis) {
        out["error"] = star.analysis.error().message;
        return out;
    }
    const SchemeAnalysis& a = *star.analysis;
    out["steps"] = a.steps;
    out["lambda"] = a.lambda;
    out["lambda_cross"] = a.lambda_cross;
    out["third"] = a.third;
    out["continuity"] = describe(a.continuity);
    out["c1"] = a.continuity == Continuity::smooth;
    if (!star.is_piece()) {
        out["mu0"] = json_of(a.mu0);
        if (star.options.valence >= 4) out["mu2"] = json_of(a.mu2);
        out["curvature"] = describe(a.curvature);
    }
    for (const auto& [frequency, eigenvalues] : a.frequencies) {
        auto& list = out["eigenvalues"][std::to_string(frequency)] = nlohmann::json::array();
        for (const auto& value : eigenvalues) list.push_back(json_of(value));
    }
    out["map"] = {{"regular", a.map_is_regular},
                  {"injective", a.map_is_injective},
                  {"points", a.points},
                  {"face_sizes", a.face_sizes},
                  {"face_vertices", a.face_vertices}};
    return out;
}

constexpr uint32_t kInk = 0x26364a, kFaint = 0xc4ccd6;

/// The characteristic map within a square of side `size`, rings in shades.
void plot_map(const SchemeAnalysis& a, double left, double top, double size, Plot& plot) {
    constexpr uint32_t kShades[] = {0xf2b35c, 0xf2b35c, 0xf7d9a8, 0xfbefdc};
    double low[2] = {1e300, 1e300}, high[2] = {-1e300, -1e300};
    for (size_t i = 0; i < a.points.size(); ++i) {
        low[i % 2] = std::min(low[i % 2], a.points[i]);
        high[i % 2] = std::max(high[i % 2], a.points[i]);
    }
    const double scale = 0.94 * size / std::max({high[0] - low[0], high[1] - low[1], 1e-12});
    size_t begin = 0;
    for (size_t f = 0; f < a.face_sizes.size(); begin += a.face_sizes[f++]) {
        Plot::Shape& face = plot.shapes.emplace_back();
        face.fill = kShades[std::min<size_t>(a.face_rings[f], 3)];
        face.stroke = kInk;
        for (size_t i = 0; i < a.face_sizes[f]; ++i) {
            const double* p = &a.points[2 * size_t{a.face_vertices[begin + i]}];
            face.xy.push_back(left + size / 2 + scale * (p[0] - (low[0] + high[0]) / 2));
            face.xy.push_back(top + size / 2 - scale * (p[1] - (low[1] + high[1]) / 2));
        }
    }
}

/// All eigenvalues in the unit disc, colours by frequency; circles of radius lambda and lambda^2.
void plot_eigenvalues(const SchemeAnalysis& a, double left, double top, double size, Plot& plot) {
    constexpr uint32_t kColors[] = {0xd1495b, 0x2a7de1, 0x2e9e5b, 0x8a4fbf, 0xe08a1e, 0x13a8a8, 0x7d7d7d};
    const double center[2] = {left + size / 2, top + size / 2}, unit = 0.47 * size;
    auto circle = [&](double radius, uint32_t color, double width) {
        plot.shapes.push_back({{center[0], center[1]}, radius * unit, kNoColor, color, width});
    };
    plot.shapes.push_back({{center[0] - unit, center[1], center[0] + unit, center[1]}, 0, kNoColor, kFaint, 0.7});
    plot.shapes.push_back({{center[0], center[1] - unit, center[0], center[1] + unit}, 0, kNoColor, kFaint, 0.7});
    circle(1, kInk, 1.2);
    circle(a.lambda, kFaint, 1);
    circle(a.lambda * a.lambda, kFaint, 1);
    for (size_t f = a.frequencies.size(); f-- != 0;)
        for (const auto& value : a.frequencies[f].eigenvalues)
            plot.shapes.push_back({{center[0] + unit * value.real(), center[1] - unit * value.imag()},
                                   4.5,
                                   kColors[std::min<size_t>(f, std::size(kColors) - 1)],
                                   kInk,
                                   0.7});
}

/// One star beside its eigenvalues, or the maps of several.
Plot plot_of(const SubdivisionScheme& scheme, const std::vector<Star>& stars) {
    Plot plot;
    if (stars.size() == 1) {
        plot.width = 1000;
        plot.height = 520;
        plot.labels.push_back({20, 22, std::string(scheme.title) + ", " + name_of(scheme, stars[0].options)});
        plot_map(*stars[0].analysis, 10, 30, 480, plot);
        plot_eigenvalues(*stars[0].analysis, 510, 30, 480, plot);
        return plot;
    }
    constexpr uint32_t kSide = 240;
    const auto count = static_cast<uint32_t>(stars.size()), columns = std::min(count, 5u);
    plot.width = columns * kSide;
    plot.height = (count + columns - 1) / columns * kSide;
    for (uint32_t i = 0; i < count; ++i) {
        const double left = i % columns * kSide, top = i / columns * kSide;
        plot.labels.push_back({left + 8, top + 16, std::to_string(stars[i].options.valence)});
        if (stars[i].analysis) plot_map(*stars[i].analysis, left + 10, top + 10, kSide - 20, plot);
    }
    return plot;
}

int run(const Options& options) {
    const SubdivisionScheme& scheme = *find_subdivision_scheme(options.scheme);
    std::vector<Star> stars;
    auto add = [&](const AnalysisOptions& star) { stars.push_back({star, analyze_scheme(scheme, star)}); };
    for (const uint32_t valence : options.valences) {
        add({.valence = valence, .crease = options.crease, .dart = options.dart});
        if (options.crease != 0 && options.crease < valence && 2 * options.crease != valence)
            add({.valence = valence, .crease = valence - options.crease});  // the other side
    }
    if (options.boundary != 0) add({.valence = options.boundary, .boundary = true});
    const bool table = stars.empty();
    for (uint32_t valence = 3; table && valence <= 12; ++valence) add({.valence = valence});
    for (const Star& star : stars)
        if (!star.analysis && !table) return fail(star.analysis.error());
    if (options.json) {
        nlohmann::json out = {{"scheme", scheme.name}, {"stars", nlohmann::json::array()}};
        for (const Star& star : stars) out["stars"].push_back(json_of(star));
        std::printf("%s\n", out.dump(2).c_str());
    } else if (table) {
        print_table(scheme, stars);
    } else {
        for (const Star& star : stars) print_one(scheme, star);
    }
    if (options.output.empty()) return 0;
    if (auto done = write_plot(options.output, plot_of(scheme, stars)); !done) return fail(done.error());
    return 0;
}

}  // namespace

void add_analyze(CLI::App& program, int& status) {
    auto options = std::make_shared<Options>();
    CLI::App* command = program.add_subcommand(
        "analyze", "Eigenvalues, characteristic maps and continuity of a scheme, from its own steps");
    std::vector<std::string> names;
    for (const SubdivisionScheme& scheme : subdivision_schemes()) names.emplace_back(scheme.name);
    command->add_option("--scheme", options->scheme, "Which scheme")->required()->check(CLI::IsMember(names));
    command->add_option("--valence", options->valences, "Faces around the vertex, or sides of a dual scheme's face")
        ->check(CLI::Range(3, 64));
    command->add_option("--boundary", options->boundary, "A boundary vertex of as many faces")
        ->check(CLI::Range(1, 64));
    CLI::Option* crease = command->add_option("--crease", options->crease,
                                              "An infinitely sharp crease at the vertex, as many faces on one side: both");
    crease->check(CLI::Range(1, 63))->needs("--valence");
    command->add_flag("--dart", options->dart, "The end of an infinitely sharp crease at the vertex")
        ->needs("--valence")
        ->excludes(crease);
    command
        ->add_option("-o,--output", options->output, "A picture of characteristic maps and eigenvalues, .svg or .png")
        ->check(CLI::Validator(check_plot_path, "FILE"));
    command->add_flag("--json", options->json, "Everything as JSON");
    command->footer("Without --valence and --boundary: a table of valences 3 to 12.");
    command->callback([options, &status] { status = run(*options); });
}

}  // namespace limn::cli
