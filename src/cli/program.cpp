#include "cli/program.h"

#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <map>

#include "cli/face_cuts.h"
#include "limn/baked_file.h"
#include "limn/file.h"
#include "limn/schemes/scheme_refinement.h"

namespace limn::cli {
namespace {

template <class T>
struct Choice {
    const char* name;
    T value;
};
constexpr uint32_t kMostPixels = uint32_t{1} << 20;  // a side; devices say less
constexpr Choice<Scheme> kSchemes[] = {
    {"catmark", Scheme::catmull_clark},
    {"loop", Scheme::loop},
    {"bilinear", Scheme::bilinear},
    {"doo-sabin", Scheme::doo_sabin}};
constexpr Choice<BoundaryInterpolation> kBoundaries[] = {
    {"none", BoundaryInterpolation::none},
    {"edge-only", BoundaryInterpolation::edge_only},
    {"edge-and-corner", BoundaryInterpolation::edge_and_corner}};
constexpr Choice<CreasingMethod> kCreasing[] = {{"uniform", CreasingMethod::uniform},
                                                {"chaikin", CreasingMethod::chaikin}};
constexpr Choice<TriangleSubdivision> kTriangles[] = {{"catmark", TriangleSubdivision::catmark},
                                                      {"smooth", TriangleSubdivision::smooth}};
constexpr Choice<FaceVaryingInterpolation> kFaceVarying[] = {
    {"none", FaceVaryingInterpolation::none},
    {"corners-only", FaceVaryingInterpolation::corners_only},
    {"corners-plus1", FaceVaryingInterpolation::corners_plus1},
    {"corners-plus2", FaceVaryingInterpolation::corners_plus2},
    {"boundaries", FaceVaryingInterpolation::boundaries},
    {"all", FaceVaryingInterpolation::all}};

template <class T, size_t N>
std::vector<std::string> names(const Choice<T> (&choices)[N]) {
    std::vector<std::string> out;
    for (const Choice<T>& choice : choices) out.emplace_back(choice.name);
    return out;
}

/// CLI11 has checked the name.
template <class T, size_t N>
T value_of(const Choice<T> (&choices)[N], const std::string& name) {
    for (const Choice<T>& choice : choices)
        if (name == choice.name) return choice.value;
    return choices[0].value;
}

template <class T, size_t N>
void override_tag(std::optional<T>& tag, const Choice<T> (&choices)[N],
                  const std::optional<std::string>& name) {
    if (name) tag = value_of(choices, *name);
}

/// The line of the index-th line that starts with `keyword`, or 0. Only errors read a file again.
uint64_t find_line(const std::string& path, const std::string& keyword, uint64_t index) {
    const Result<FileBytes> file = read_file(path);
    if (!file) return 0;
    const std::string_view text = file->text();
    uint64_t line = 1, count = 0;
    for (size_t at = 0; at < text.size(); ++line) {
        const size_t end = std::min(text.find('\n', at), text.size());
        const std::string_view words = text.substr(at, end - at);
        if (words.substr(0, keyword.size()) == keyword && count++ == index) return line;
        at = end + 1;
    }
    return 0;
}

Error name_file(const Error& error, const std::string& path) {
    uint64_t line = 0;
    if (error.code == ErrorCode::missing_edge) line = find_line(path, "t crease ", error.element);
    if (error.code == ErrorCode::not_a_triangle || error.code == ErrorCode::unsupported)
        line = find_line(path, "f ", error.element);
    Error named = error;
    named.message = printable(path) + (line != 0 ? ":" + std::to_string(line) : "") + ": " + error.message;
    return named;
}

/// What to do about faces that the scheme does not take.
Error advise(Error error) {
    if (error.code == ErrorCode::not_a_triangle) error.message += " (--triangulate cuts it)";
    if (error.code == ErrorCode::unsupported) error.message += " (--quads splits it)";
    return error;
}

}  // namespace

int fail(const Error& error) {
    std::fprintf(stderr, "limn: %s\n", error.message.c_str());
    return error.code == ErrorCode::no_device ? kNoDevice : kBadInput;
}

std::vector<std::string> scheme_names() {
    return names(kSchemes);
}

std::vector<std::string> opensubdiv_scheme_names() {
    std::vector<std::string> out = scheme_names();
    out.erase(std::find(out.begin(), out.end(), "doo-sabin"));
    return out;
}

std::vector<std::string> all_scheme_names() {
    std::vector<std::string> out = scheme_names();
    for (const SubdivisionScheme& scheme : subdivision_schemes())
        if (std::find(out.begin(), out.end(), scheme.name) == out.end()) out.emplace_back(scheme.name);
    return out;
}

void add_surface_options(CLI::App& command, SurfaceOptions& options, SchemesTaken schemes) {
    const char* group = kSurfaceGroup;
    const auto known = all_scheme_names(), taken = schemes == SchemesTaken::all          ? known
                                                   : schemes == SchemesTaken::opensubdiv ? opensubdiv_scheme_names()
                                                                                         : scheme_names();
    const std::string list = CLI::detail::join(taken, ", ");
    command
        .add_option("--scheme", options.scheme,
                    schemes == SchemesTaken::all ? "Subdivision scheme; 'limn schemes' lists them" : "Subdivision scheme: " + list)
        ->check([known, taken, list, name = command.get_name()](const std::string& text) -> std::string {
            if (std::find(taken.begin(), taken.end(), text) != taken.end()) return {};
            if (std::find(known.begin(), known.end(), text) != known.end())
                return "limn " + name + " takes no '" + text + "': " + list;
            return "there is no scheme '" + text + "': limn schemes lists them";
        })
        ->capture_default_str()
        ->group(group);
    auto* triangulate = command.add_flag("--triangulate", options.triangulate, "Cut faces into triangles first")->group(group);
    command.add_flag("--quads", options.quads, "Split all faces into quads first, linearly")->excludes(triangulate)->group(group);
    command.add_option("--boundary", options.boundary, "Boundary interpolation (default edge-only)")
        ->check(CLI::IsMember(names(kBoundaries)))
        ->group(group);
    command.add_option("--creasing", options.creasing, "Creasing method (default uniform)")
        ->check(CLI::IsMember(names(kCreasing)))
        ->group(group);
    command
        .add_option("--triangles", options.triangles, "Catmull-Clark weights at triangles (default catmark)")
        ->check(CLI::IsMember(names(kTriangles)))
        ->group(group);
    command.add_option("--fvar", options.face_varying, "Linear parts of texture coordinates (default all)")
        ->check(CLI::IsMember(names(kFaceVarying)))
        ->group(group);
    command
        .add_option("--compat", options.compat, "Reproduce OpenSubdiv where it departs from its own limit")
        ->check(CLI::IsMember(std::vector<std::string>{"none", "opensubdiv"}))
        ->capture_default_str()
        ->group(group);
}

Result<LoadedModel> load_model(const std::string& path, const SurfaceOptions& options) {
    if (is_baked_file(path))
        return Error{ErrorCode::parse_error, printable(path) + ": is a baked file, which does not keep the control mesh that this needs; give the OBJ file"};
    Result<Model> model = read_obj(path);
    if (!model) return model.error();
    override_tag(model->boundary, kBoundaries, options.boundary);
    override_tag(model->creasing, kCreasing, options.creasing);
    override_tag(model->triangles, kTriangles, options.triangles);
    override_tag(model->face_varying, kFaceVarying, options.face_varying);
    if (options.triangulate) triangulate(*model);
    if (options.quads) split_into_quads(*model);
    SchemeOptions defaults;
    defaults.scheme = value_of(kSchemes, options.scheme);
    defaults.opensubdiv_compatible = options.compat == "opensubdiv";
    Result<ControlMesh> mesh = ControlMesh::create(describe(*model, defaults));
    if (!mesh) return advise(name_file(mesh.error(), path));
    if (const SubdivisionScheme* scheme = find_subdivision_scheme(options.scheme))
        if (auto checked = check_scheme_faces(*mesh, *scheme); !checked) return advise(name_file(checked.error(), path));
    return LoadedModel{std::move(*model), std::move(*mesh)};
}

std::string check_device(const std::string& text) {
    if (text == "cpu" || text == "auto") return {};
    const bool number = !text.empty() && text.size() < 7 && text.find_first_not_of("0123456789") == text.npos;
    return number ? "" : "a device is a number, 'cpu' or 'auto', not '" + text + "'";
}

void add_device_option(CLI::App& command, DeviceOption& option) {
    command
        .add_option("--device", option.device,
                    "Vulkan device: a number from 'limn devices'; 'cpu' for the host without Vulkan; "
                    "'auto' for the first discrete GPU, else what there is")
        ->check(check_device)
        ->capture_default_str();
    command.add_flag("--validation", option.validation,
                     "Run under the Khronos validation layer; any message is an error");
}

Result<PictureSize> parse_size(const std::string& text) {
    PictureSize size;
    const char *at = text.data(), *end = at + text.size();
    const auto width = std::from_chars(at, end, size.width);
    bool good = width.ec == std::errc() && width.ptr != end && *width.ptr == 'x';
    if (good) {
        const auto height = std::from_chars(width.ptr + 1, end, size.height);
        good = height.ec == std::errc() && height.ptr == end;
    }
    if (!good || size.width - 1 >= kMostPixels || size.height - 1 >= kMostPixels)
        return Error{ErrorCode::parse_error,
                     "a size is WIDTHxHEIGHT, each at least one pixel, not '" + text + "'"};
    return size;
}

void add_size_option(CLI::App& command, std::string& size) {
    command.add_option("--size", size, "Pixels, WIDTHxHEIGHT")
        ->check([](const std::string& text) {
            const auto parsed = parse_size(text);
            return parsed ? std::string() : parsed.error().message;
        })
        ->capture_default_str();
}

Progress::Progress() : visible_(isatty(STDERR_FILENO) != 0) {}
Progress::~Progress() {
    clear();
}
void Progress::show(const std::string& what) {
    if (!visible_) return;
    std::fprintf(stderr, "\r\033[K%s ...", what.c_str());
    std::fflush(stderr);
}

void Progress::clear() {
    if (visible_) std::fputs("\r\033[K", stderr);
}

std::string plural(uint64_t count, const char* noun) {
    return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

std::string human_bytes(uint64_t bytes) {
    const char* units[] = {"B", "KB", "MB", "GB"};
    double value = static_cast<double>(bytes);
    size_t unit = 0;
    for (; value >= 1000 && unit < 3; ++unit) value /= 1000;
    char text[32];
    std::snprintf(text, sizeof text, unit == 0 ? "%.0f %s" : "%.2f %s", value, units[unit]);
    return text;
}

}  // namespace limn::cli
