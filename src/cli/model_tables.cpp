#include "cli/model_tables.h"

#include <algorithm>
#include <charconv>
#include <cstdio>

#include "cli/scheme_model.h"
#include "limn/file.h"

namespace limn::cli {
namespace {

std::optional<uint32_t> parse_channel(const std::string& text) {
    uint32_t channel = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), channel);
    if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return channel;
}

/// Whether texture coordinates are wanted and there. Errors: index_out_of_range.
Result<bool> wants_texture(const std::string& uv, const ControlMesh& mesh) {
    if (uv == "none" || (uv == "auto" && mesh.channels.empty())) return false;
    const uint32_t channel = uv == "auto" ? 0 : *parse_channel(uv);
    if (channel < mesh.channels.size()) return true;
    return Error{ErrorCode::index_out_of_range,
                 mesh.channels.empty() ? std::string("not every corner of its faces has texture coordinates")
                                       : "there is no channel " + std::to_string(channel) + " of texture coordinates"};
}

}  // namespace

void add_uv_option(CLI::App& command, std::string& uv) {
    command.add_option("--uv", uv, "Texture coordinates: 0, the model's; none; auto: 0 if it has them")
        ->check([](const std::string& text) {
            const bool good = text == "none" || text == "auto" || parse_channel(text);
            return good ? std::string() : "takes a channel's number, none or auto, not '" + text + "'";
        })
        ->capture_default_str();
}

Result<BakedMesh> build_tables(const std::string& path, const SurfaceOptions& surface, const std::string& uv,
                               const BakeOptions& options, Progress& progress) {
    progress.show("reading " + path);
    Result<LoadedModel> loaded = load_model(path, surface);
    if (!loaded) return loaded.error();
    note_creases_left_out(path, *loaded, *find_subdivision_scheme(surface.scheme), progress);
    const auto name_model = [&](Error error) {
        error.message = printable(path) + ": " + error.message;
        return error;
    };
    const Result<bool> texture = wants_texture(uv, loaded->mesh);
    if (!texture) return name_model(texture.error());
    progress.show("building the tables of " + plural(loaded->mesh.face_count(), "face"));
    // The mesh has the options that command line and tags agreed on.
    const ControlMeshDescription description = describe(loaded->model, loaded->mesh.options);
    BakeOptions with_texture = options;
    if (*texture) with_texture.channel_values = {loaded->model.texture_coordinates};
    Result<BakedMesh> mesh = bake_mesh(description, with_texture);
    if (mesh) return mesh;
    const Error cause = mesh.error();
    if (!*texture || cause.code != ErrorCode::unsupported) return name_model(cause);
    mesh = bake_mesh(description, options);
    if (!mesh) return name_model(mesh.error());
    progress.clear();
    std::fprintf(stderr, "limn: %s: goes without texture coordinates: %s\n", printable(path).c_str(),
                 cause.message.c_str());
    return mesh;
}

Result<ModelTables> ModelTables::load(const std::string& path, const SurfaceOptions& surface, const std::string& uv,
                                      const BakeOptions& options, Progress& progress) {
    ModelTables out;
    if (!is_baked_file(path)) {
        Result<BakedMesh> mesh = build_tables(path, surface, uv, options, progress);
        if (!mesh) return mesh.error();
        out.built_ = std::make_unique<BakedMesh>(std::move(*mesh));
        return out;
    }
    progress.show("reading " + path);
    Result<BakedFile> file = BakedFile::open(path);
    if (!file) return file.error();
    if (file->mesh().positions.empty() && file->mesh().patches.control_count != 0)
        return Error{ErrorCode::invalid_argument, printable(path) + ": was baked without positions"};
    out.file_ = std::make_unique<BakedFile>(std::move(*file));
    return out;
}

const BakedChannel* texture_of(const BakedMesh& mesh) {
    return !mesh.channels.empty() && mesh.channels[0].width == 2 ? &mesh.channels[0] : nullptr;
}

Result<void> limit_rates(const BakedMesh& mesh, RateSettings& settings) {
    const uint32_t most = mesh.trees.max_rate;
    if (most == 0) return {};
    if (settings.mode == RateMode::uniform && settings.value > static_cast<float>(most))
        return Error{ErrorCode::invalid_argument,
                     "was baked for rates up to " + std::to_string(most) + "; limn bake --max-rate gives more"};
    settings.max_rate = std::min(settings.max_rate, most);
    return {};
}

void check_baked_usage(const CLI::App& command, const std::string& model, std::initializer_list<const char*> more) {
    if (!is_baked_file(model)) return;
    for (const CLI::Option* option : command.get_options()) {
        const std::string name = option->get_name();
        const bool settled = option->get_group() == kSurfaceGroup || std::find(more.begin(), more.end(), name) != more.end();
        if (settled && option->count() != 0)
            throw CLI::ValidationError(name, "is for OBJ files: a baked file has settled it");
    }
}

}  // namespace limn::cli
