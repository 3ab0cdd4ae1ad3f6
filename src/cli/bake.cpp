// limn bake: what a model needs at run time, made ahead of it.
#include <cstdio>

#include "cli/model_tables.h"
#include "limn/file.h"

namespace limn::cli {
namespace {

struct Options {
    std::string model, output, uv = "auto";
    SurfaceOptions surface;
    BakeOptions bake;
};

Result<void> bake_model(const Options& options, Progress& progress) {
    const Result<BakedMesh> mesh = build_tables(options.model, options.surface, options.uv, options.bake, progress);
    if (!mesh) return mesh.error();
    progress.show("writing " + options.output);
    if (auto written = write_baked_file(options.output, *mesh); !written) return written;
    progress.clear();
    std::printf("%s: %s, %s\n", printable(options.output).c_str(), plural(mesh->face_count, "face").c_str(),
                human_bytes(mesh->bytes()).c_str());
    return {};
}

int run(const Options& options) {
    Progress progress;
    const Result<void> done = bake_model(options, progress);
    progress.clear();
    return done ? 0 : fail(done.error());
}

}  // namespace

void add_bake(CLI::App& program, int& status) {
    auto options = std::make_shared<Options>();
    CLI::App* command = program.add_subcommand("bake", "Make the tables of a model ahead of time, into a file");
    command->add_option("MODEL", options->model, "OBJ file")->required();
    command->add_option("-o,--output", options->output, "File to write: .limn")
        ->required()
        ->check([](const std::string& path) {
            return path.ends_with(".limn") ? std::string() : "'" + path + "' does not end in .limn";
        });
    command->add_option("--grid-rate", options->bake.grid_rates, "Tables of grids of these rates, 1 to 256, too")
        ->check(CLI::Range(1u, 256u));
    command->add_option("--refine-level", options->bake.refined_levels, "Tables of refined points of these levels, 1 to 7, too")
        ->check(CLI::Range(1u, 7u));
    command->add_option("--max-rate", options->bake.max_rate, "The largest rate of tessellation, 2 to 128")
        ->check(CLI::Range(2u, shared::kMaxSideRate))
        ->capture_default_str();
    add_uv_option(*command, options->uv);
    add_surface_options(*command, options->surface);
    command->footer("limn info, eval, tessellate, render and view take the file in place of the model: nothing is built again then.");
    command->callback([options, &status] { status = run(*options); });
}

}  // namespace limn::cli
