// The C interface: baked files.
#include "limn/baked_file.h"

#include "limn/c/interop.h"

struct limn_baked_file {
    limn::BakedFile value;
};

namespace limn::c {
namespace {

const BakedMesh* mesh_of(const limn_baked_file* file) {
    return file != nullptr ? &file->value.mesh() : nullptr;
}
const BakedChannel* channel_of(const limn_baked_file* file, uint32_t channel) {
    const BakedMesh* mesh = mesh_of(file);
    return mesh != nullptr && channel < mesh->channels.size() ? &mesh->channels[channel] : nullptr;
}
const float* give_values(const Array<float>* values, uint64_t* count) {
    if (count != nullptr) *count = values != nullptr ? values->size() : 0;
    return values != nullptr && !values->empty() ? values->data() : nullptr;
}

Result<BakeOptions> read_bake_options(const limn_bake_options* given) {
    BakeOptions out;
    if (given == nullptr) return out;
    const auto options = read_struct(given);
    if (!options) return options.error();
    auto patches = read_patch_table_options(options->patches);
    if (!patches) return patches.error();
    out.patches = *patches;
    Reader reader;
    reader.flags(options->flags, LIMN_BAKE_JOIN_CREASES | LIMN_BAKE_NO_TREES);
    out.split_creases = (options->flags & LIMN_BAKE_JOIN_CREASES) == 0;
    if (options->max_rate != 0) out.max_rate = options->max_rate;
    if ((options->flags & LIMN_BAKE_NO_TREES) != 0) out.max_rate = 0;
    for (const limn_baked_channel& channel :
         reader.array(options->channels, options->channel_count, "channels"))
        out.channel_values.push_back(
            reader.array(channel.values, channel.value_count, "values of a channel"));
    if (!reader.state) return reader.state.error();
    return out;
}

/// What is baked, and how; arrays are the caller's.
struct BakeRequest {
    std::vector<FaceVaryingDescription> channels;
    ControlMeshDescription description;
    BakeOptions options;
};
Result<void> read_request(const char* path, const limn_control_mesh_description* given, const limn_bake_options* options,
                          BakeRequest& out) {
    if (path == nullptr) return bad_argument("path is null");
    if (auto read = read_description(given, out.description, out.channels); !read) return read;
    auto bake_options = read_bake_options(options);
    if (!bake_options) return bake_options.error();
    out.options = std::move(*bake_options);
    return {};
}

Result<void> bake(const char* path, const limn_control_mesh_description* given,
                  const limn_bake_options* options) {
    BakeRequest request;
    if (auto read = read_request(path, given, options, request); !read) return read;
    const auto baked = bake_mesh(request.description, request.options);
    if (!baked) return baked.error();
    return write_baked_file(path, *baked);
}

Result<BakedLoadOptions> read_load_options(uint32_t flags) {
    Reader reader;
    reader.flags(flags, LIMN_BAKED_FILE_TRUSTED | LIMN_BAKED_FILE_READ);
    if (!reader.state) return reader.state.error();
    const bool checked = (flags & LIMN_BAKED_FILE_TRUSTED) == 0;
    return BakedLoadOptions{.check_sums = checked, .check_contents = checked, .map = (flags & LIMN_BAKED_FILE_READ) == 0};
}

Result<BakedFile> open(const char* path, uint32_t flags) {
    if (path == nullptr) return bad_argument("path is null");
    const auto load = read_load_options(flags);
    if (!load) return load.error();
    return BakedFile::open(path, *load);
}

Result<BakedFile> load_or_bake(const char* folder, const limn_control_mesh_description* given,
                               const limn_bake_options* options, uint32_t flags) {
    const auto load = read_load_options(flags);
    if (!load) return load.error();
    BakeRequest request;
    if (auto read = read_request(folder, given, options, request); !read) return read.error();
    return limn::load_or_bake(folder, request.description, request.options, *load);
}

}  // namespace
}  // namespace limn::c

using namespace limn::c;

limn_result limn_baked_file_write(const char* path, const limn_control_mesh_description* description,
                                  const limn_bake_options* options, limn_error* error) noexcept {
    const auto written = bake(path, description, options);
    return written ? LIMN_SUCCESS : report(written.error(), error);
}

limn_result limn_baked_file_open(const char* path, uint32_t flags, limn_baked_file** file,
                                 limn_error* error) noexcept {
    return create(file, error, [&] { return open(path, flags); });
}
limn_result limn_baked_file_load_or_bake(const char* folder, const limn_control_mesh_description* description,
                                         const limn_bake_options* options, uint32_t flags, limn_baked_file** file,
                                         limn_error* error) noexcept {
    return create(file, error, [&] { return load_or_bake(folder, description, options, flags); });
}
void limn_baked_file_destroy(limn_baked_file* file) noexcept {
    delete file;
}

const limn_patch_table* limn_baked_file_get_patches(const limn_baked_file* file) noexcept {
    const auto* mesh = mesh_of(file);
    return as_object<limn_patch_table>(mesh != nullptr ? &mesh->patches : nullptr);
}
const limn_patch_trees* limn_baked_file_get_trees(const limn_baked_file* file) noexcept {
    const auto* mesh = mesh_of(file);
    return as_object<limn_patch_trees>(mesh != nullptr ? &mesh->trees : nullptr);
}
const limn_tessellation_table* limn_baked_file_get_tessellation(const limn_baked_file* file) noexcept {
    const auto* mesh = mesh_of(file);
    return as_object<limn_tessellation_table>(mesh != nullptr ? &mesh->tessellation : nullptr);
}
const limn_patch_table* limn_baked_file_get_channel_patches(const limn_baked_file* file,
                                                            uint32_t channel) noexcept {
    const auto* baked = channel_of(file, channel);
    return as_object<limn_patch_table>(baked != nullptr ? &baked->patches : nullptr);
}
const limn_patch_trees* limn_baked_file_get_channel_trees(const limn_baked_file* file,
                                                          uint32_t channel) noexcept {
    const auto* baked = channel_of(file, channel);
    return as_object<limn_patch_trees>(baked != nullptr ? &baked->trees : nullptr);
}
const float* limn_baked_file_get_positions(const limn_baked_file* file, uint64_t* value_count) noexcept {
    const auto* mesh = mesh_of(file);
    return give_values(mesh != nullptr ? &mesh->positions : nullptr, value_count);
}
const float* limn_baked_file_get_channel_values(const limn_baked_file* file, uint32_t channel,
                                                uint64_t* value_count) noexcept {
    const auto* baked = channel_of(file, channel);
    return give_values(baked != nullptr ? &baked->values : nullptr, value_count);
}
