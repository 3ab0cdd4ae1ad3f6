// What the commands of the program share: options, models, errors, progress.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "limn/control_mesh.h"
#include "limn/obj.h"
#include "limn/result.h"

namespace limn::cli {

// Exit statuses are a contract with scripts.
inline constexpr int kBadInput = 1;
inline constexpr int kBadUsage = 2;
inline constexpr int kNoDevice = 3;

/// One line on standard error; the exit status that goes with the error.
int fail(const Error& error);

/// Options about the surface. What the command line says goes before the model's tags, and those before
/// defaults.
struct SurfaceOptions {
    std::string scheme = "catmark";
    std::optional<std::string> boundary, creasing, triangles, face_varying;
    std::string compat = "none";
    bool triangulate = false, quads = false;  ///< faces that the scheme does not take
};
inline constexpr const char* kSurfaceGroup = "Surface (the model's own tags hold where these are not given)";
/// Which schemes a command takes: those that OpenSubdiv has, those with patches, or all that there are.
enum class SchemesTaken { opensubdiv, with_patches, all };
void add_surface_options(CLI::App& command, SurfaceOptions& options,
                         SchemesTaken schemes = SchemesTaken::with_patches);

/// The schemes with patches, by Scheme; those of them that OpenSubdiv has; and all.
std::vector<std::string> scheme_names();
std::vector<std::string> opensubdiv_scheme_names();
std::vector<std::string> all_scheme_names();

/// A model file as a checked control mesh.
struct LoadedModel {
    Model model;
    ControlMesh mesh;
};
/// Error::message is one line that names the file and, where one is to blame, the line. Baked files are none. Under a
/// scheme without patches mesh.options.scheme is that of quads.
Result<LoadedModel> load_model(const std::string& path, const SurfaceOptions& options);

/// --device: an index of `limn devices`, or "cpu" for limn's own code on the host, without Vulkan.
struct DeviceOption {
    std::string device = "auto";
    bool validation = false;
};
void add_device_option(CLI::App& command, DeviceOption& option);
/// What is wrong with this value of --device; empty where nothing is.
std::string check_device(const std::string& text);

/// Pixels.
struct PictureSize {
    uint32_t width = 0, height = 0;
};
/// WIDTHxHEIGHT, each 1 to 2^20. Errors: parse_error.
Result<PictureSize> parse_size(const std::string& text);
/// --size, checked by parse_size.
void add_size_option(CLI::App& command, std::string& size);

/// A line on standard error that is rewritten as work goes on; nothing where that is no terminal.
class Progress {
  public:
    Progress();
    ~Progress();
    void show(const std::string& what);
    void clear();  ///< before other lines

  private:
    bool visible_;
};

std::string plural(uint64_t count, const char* noun);
std::string human_bytes(uint64_t bytes);

// One function a command: adds it to the program.
void add_info(CLI::App& program, int& status);
void add_bake(CLI::App& program, int& status);
void add_refine(CLI::App& program, int& status);
void add_eval(CLI::App& program, int& status);
void add_nurbs(CLI::App& program, int& status);
void add_tessellate(CLI::App& program, int& status);
void add_check(CLI::App& program, int& status);
void add_render(CLI::App& program, int& status);
void add_view(CLI::App& program, int& status);
void add_schemes(CLI::App& program, int& status);
void add_gallery(CLI::App& program, int& status);
void add_analyze(CLI::App& program, int& status);
void add_devices(CLI::App& program, int& status);
void add_bench(CLI::App& program, int& status);  // bench/bench_command.cpp, where benchmarks are built

}  // namespace limn::cli
