// A model as tables, whichever kind of file it comes in: made of an OBJ file, or where a baked file has them.
#pragma once

#include <memory>

#include "cli/program.h"
#include "limn/baked_file.h"
#include "limn/tessellate.h"

namespace limn::cli {

/// The tables of an OBJ file; control points of channel 0 are its texture coordinates. `uv`: the channel's number,
/// none, or auto, 0 if there is one; a warning says so where there are no tables for it. Errors: as load_model and
/// bake_mesh; index_out_of_range (no such channel). Error::message is one line that names the file.
Result<BakedMesh> build_tables(const std::string& path, const SurfaceOptions& surface, const std::string& uv,
                               const BakeOptions& options, Progress& progress);
/// --uv
void add_uv_option(CLI::App& command, std::string& uv);

class ModelTables {
  public:
    /// A baked file's tables, pointed into; the other arguments are for OBJ files alone. Errors: as build_tables and
    /// BakedFile::open; invalid_argument (a baked file without positions).
    static Result<ModelTables> load(const std::string& path, const SurfaceOptions& surface, const std::string& uv,
                                    const BakeOptions& options, Progress& progress);
    const BakedMesh& mesh() const { return file_ != nullptr ? file_->mesh() : *built_; }
    std::span<const float> positions() const { return {mesh().positions.data(), mesh().positions.size()}; }

  private:
    // One of the two.
    std::unique_ptr<BakedMesh> built_;
    std::unique_ptr<BakedFile> file_;
};

/// The channel that is written as texture coordinates, or null.
const BakedChannel* texture_of(const BakedMesh& mesh);

/// Rates as large as trees are made for, at most, where there are trees. Errors: invalid_argument (a uniform rate that
/// is larger).
Result<void> limit_rates(const BakedMesh& mesh, RateSettings& settings);

/// What a baked file has settled is not for the command line: options about the surface, and `more`. Throws as CLI11
/// does.
void check_baked_usage(const CLI::App& command, const std::string& model, std::initializer_list<const char*> more = {});

}  // namespace limn::cli
