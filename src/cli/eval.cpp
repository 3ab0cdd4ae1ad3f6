// limn eval: the limit surface and its derivatives at a list of places.
#include <unistd.h>

#include <charconv>

#include "cli/model_tables.h"
#include "cli/point_runner.h"
#include "cli/samples_csv.h"
#include "cli/scheme_model.h"
#include "cli/surface_runner.h"
#include "limn/file.h"
#include "limn/patch_table.h"
#include "limn/schemes/scheme_samples.h"

namespace limn::cli {
namespace {

struct Options {
    std::string model, samples, output;
    bool texture = false, curvature = false;
    SurfaceOptions surface;
    DeviceOption device;
};

constexpr size_t kRowsPerPass = size_t{1} << 18;  // progress is shown, and memory bounded, by passes
constexpr size_t kNumberBytes = 24;               // of the longest float or face, and a comma
constexpr uint32_t kMaxNumbers = 3 + 6 * 3 + shared::kCurvatureFloats;
constexpr const char* kCurvatureNames = ",gaussian,mean,k1,k2,d1x,d1y,d1z,d2x,d2y,d2z";
constexpr const char* kValueNames[] = {"p", "du", "dv", "duu", "duv", "dvv"};

const char* status_name(SampleStatus status) {
    switch (status) {
        case SampleStatus::valid:
            return "valid";
        case SampleStatus::hole:
            return "hole";
        default:
            return "out_of_range";
    }
}

/// What is evaluated: positions, or texture coordinates over the same faces.
struct Quantity {
    std::shared_ptr<const void> owner;  ///< of what is pointed to
    const PatchTable* table = nullptr;
    std::span<const float> control;
    std::string_view components;  ///< a letter each
    uint32_t width() const { return static_cast<uint32_t>(components.size()); }
};

Error name_model(const Options& options, const Error& error) {
    return {error.code, printable(options.model) + ": " + error.message};
}

/// Of an OBJ file.
Result<Quantity> build_quantity(const Options& options, Progress& progress) {
    struct Built {
        LoadedModel model;
        PatchTable table;
    };
    Result<LoadedModel> loaded = load_model(options.model, options.surface);
    if (!loaded) return loaded.error();
    auto built = std::make_shared<Built>(Built{std::move(*loaded), {}});
    const ControlMesh& mesh = built->model.mesh;
    const Model& model = built->model.model;
    if (options.texture && mesh.channels.empty())
        return name_model(options, {ErrorCode::invalid_argument, "not every corner of its faces has texture coordinates"});
    progress.show("building the patch table of " + plural(mesh.face_count(), "face"));
    Result<PatchTable> table = options.texture ? build_face_varying_patch_table<float>(mesh, 0, {})
                                               : build_patch_table<float>(mesh, {});
    if (!table) return name_model(options, table.error());
    built->table = std::move(*table);
    if (options.texture) return Quantity{built, &built->table, model.texture_coordinates, "st"};
    return Quantity{built, &built->table, model.positions, "xyz"};
}

/// Of a baked file.
Result<Quantity> find_quantity(const Options& options, Progress& progress) {
    Result<ModelTables> loaded = ModelTables::load(options.model, {}, "none", {}, progress);
    if (!loaded) return loaded.error();
    const auto tables = std::make_shared<const ModelTables>(std::move(*loaded));
    if (!options.texture) return Quantity{tables, &tables->mesh().patches, tables->positions(), "xyz"};
    const BakedChannel* texture = texture_of(tables->mesh());
    if (texture == nullptr)
        return name_model(options, {ErrorCode::invalid_argument, "was baked without texture coordinates"});
    return Quantity{tables, &texture->patches, {texture->values.data(), texture->values.size()}, "st"};
}

std::string header(const Quantity& quantity, bool curvature) {
    std::string line = "face,u,v";
    for (const char* name : kValueNames)
        for (const char component : quantity.components) {
            // Texture coordinates are s and t, points px, py, pz.
            line += std::string(",") + (quantity.width() == 2 && name == kValueNames[0] ? "" : name);
            line += component;
        }
    return line + (curvature ? kCurvatureNames : "") + ",status\n";
}

/// In the shortest form that reads back as the same float.
template <class Number>
char* put_number(char* to, Number value) {
    to = std::to_chars(to, to + kNumberBytes, value).ptr;
    *to++ = ',';
    return to;
}

void write_rows(std::span<const SampleRow> rows, const SurfaceValues& values, size_t count,
                TextOutput& output) {
    char line[kMaxNumbers * kNumberBytes];
    const float *numbers = values.numbers.data(), *curvatures = values.curvatures.data();
    const size_t curvature_count = values.curvatures.size() / rows.size();
    for (size_t i = 0; i < rows.size(); ++i) {
        char* to = put_number(line, rows[i].face);
        to = put_number(to, rows[i].u);
        to = put_number(to, rows[i].v);
        for (size_t k = 0; k < count; ++k) to = put_number(to, *numbers++);
        for (size_t k = 0; k < curvature_count; ++k) to = put_number(to, *curvatures++);
        output.append({line, static_cast<size_t>(to - line)});
        output.append(status_name(values.statuses[i]));
        output.append("\n");
    }
}

SurfaceSample sample_of(const SampleRow& row) {
    const bool fits = row.face >= 0 && row.face < int64_t{kInvalidIndex};
    return {fits ? static_cast<uint32_t>(row.face) : kInvalidIndex, row.u, row.v};
}

Result<void> evaluate_rows(const SurfaceRunner& runner, const RunSurface& surface,
                           std::span<const SampleRow> rows, bool curvature, Progress* progress,
                           TextOutput& output) {
    constexpr Derivatives kAll = Derivatives::second;
    std::vector<SurfaceSample> samples;
    for (size_t first = 0; first < rows.size(); first += samples.size()) {
        if (progress != nullptr)
            progress->show("evaluated " + std::to_string(first) + " of " + plural(rows.size(), "sample") +
                           " on " + runner.name());
        const auto pass = rows.subspan(first, std::min(kRowsPerPass, rows.size() - first));
        samples.clear();
        for (const SampleRow& row : pass) samples.push_back(sample_of(row));
        const Result<SurfaceValues> values = runner.run(surface, samples, kAll, curvature);
        if (!values) return values.error();
        write_rows(pass, *values, value_count(kAll) * surface.width, output);
    }
    return {};
}

Result<void> evaluate(const Options& options, Progress& progress) {
    progress.show("reading " + options.model);
    const Result<Quantity> quantity =
        is_baked_file(options.model) ? find_quantity(options, progress) : build_quantity(options, progress);
    if (!quantity) return quantity.error();
    progress.show("reading " + options.samples);
    const Result<std::vector<SampleRow>> rows = read_samples(options.samples);
    if (!rows) return rows.error();
    const Result<RunDevice> device = RunDevice::create(options.device);
    if (!device) return device.error();
    const Result<SurfaceRunner> runner = SurfaceRunner::create(*device);
    if (!runner) return runner.error();
    const Result<RunSurface> surface = runner->prepare(*quantity->table, quantity->control, quantity->width());
    if (!surface) return surface.error();
    Result<TextOutput> output = TextOutput::create(options.output);
    if (!output) return output.error();
    // Rows on the terminal are progress enough.
    const bool to_terminal = options.output == "-" && isatty(STDOUT_FILENO) != 0;
    if (to_terminal) progress.clear();
    output->append(header(*quantity, options.curvature));
    if (auto done = evaluate_rows(*runner, *surface, *rows, options.curvature,
                                  to_terminal ? nullptr : &progress, *output);
        !done)
        return done;
    if (auto silent = device->check_validation(); !silent) return silent;
    return output->commit();
}

/// By limit stencils of a scheme without patches: positions and normals.
Result<void> evaluate_by_scheme(const Options& options, const SubdivisionScheme& scheme, Progress& progress) {
    progress.show("reading " + options.model);
    const Result<LoadedModel> loaded = load_model(options.model, options.surface);
    if (!loaded) return loaded.error();
    if (!has_coordinates(scheme))
        return name_model(options, {ErrorCode::unsupported, std::string(scheme.title) + " does not split faces in four: "
                                                            "places on them have no coordinates"});
    note_left_out(options.model, *loaded, scheme, progress);
    progress.show("reading " + options.samples);
    const Result<std::vector<SampleRow>> rows = read_samples(options.samples);
    if (!rows) return rows.error();
    std::vector<PatchSample> samples;
    for (const SampleRow& row : *rows) {
        const SurfaceSample sample = sample_of(row);
        samples.push_back({sample.face, static_cast<double>(sample.u), static_cast<double>(sample.v)});
    }
    progress.show("building the stencils of " + plural(samples.size(), "sample"));
    const auto corners = corner_values_of(*loaded, scheme);
    if (!corners) return name_model(options, corners.error());
    const auto built = build_scheme_sample_table<float>(loaded->mesh, scheme, samples, *corners);
    if (!built) return name_model(options, built.error());
    const Result<RunDevice> device = RunDevice::create(options.device);
    if (!device) return device.error();
    const Result<PointRunner> runner = PointRunner::create(*device);
    if (!runner) return runner.error();
    const auto limits = runner->run_limits(built->table, loaded->model.positions);
    if (!limits) return limits.error();
    const std::vector<float> normals = normals_of(limits->tangents1, limits->tangents2);
    Result<TextOutput> output = TextOutput::create(options.output);
    if (!output) return output.error();
    output->append("face,u,v,px,py,pz,nx,ny,nz,status\n");
    for (size_t i = 0; i < rows->size(); ++i) {
        char line[9 * kNumberBytes];
        const bool valid = built->statuses[i] == SampleStatus::valid;
        char* to = put_number(line, (*rows)[i].face);
        to = put_number(to, (*rows)[i].u);
        to = put_number(to, (*rows)[i].v);
        for (const std::vector<float>* values : {&limits->positions, &normals})
            for (size_t k = 0; k < 3; ++k) to = put_number(to, valid ? (*values)[3 * i + k] : 0.0f);
        output->append({line, static_cast<size_t>(to - line)});
        output->append(status_name(built->statuses[i]));
        output->append("\n");
    }
    if (auto silent = device->check_validation(); !silent) return silent;
    return output->commit();
}

int run(const Options& options) {
    Progress progress;
    const SubdivisionScheme* scheme = scheme_without_patches(options.surface);
    const Result<void> done =
        scheme != nullptr ? evaluate_by_scheme(options, *scheme, progress) : evaluate(options, progress);
    progress.clear();
    return done ? 0 : fail(done.error());
}

}  // namespace

void add_eval(CLI::App& program, int& status) {
    auto options = std::make_shared<Options>();
    CLI::App* command =
        program.add_subcommand("eval", "Evaluate the limit surface and its derivatives at samples");
    command->add_option("MODEL", options->model, "OBJ file, or one of limn bake")->required();
    command
        ->add_option(
            "--at", options->samples,
            "CSV file of samples, a row face,u,v each; a header line is accepted; - is standard input")
        ->required();
    command->add_option("-o,--output", options->output, "CSV file to write; - is standard output")
        ->required();
    CLI::Option* texture =
        command->add_flag("--texture", options->texture, "Evaluate texture coordinates instead of positions");
    command->add_flag("--curvature", options->curvature, "Write curvatures, too")->excludes(texture);
    add_surface_options(*command, options->surface, SchemesTaken::all);
    add_device_option(*command, options->device);
    command->footer(
        "face is the ptex face: a quad (Loop: a triangle) is one, any other face of n sides is n, numbered "
        "in "
        "face order; u and v go from 0 to 1, (0,0) at the corner's vertex and u along the edge to the next "
        "one (triangles: u + v <= 1).\n"
        "For each sample, in order, a row: face,u,v,px,py,pz, then dux..duz, dvx..dvz, duux.., duvx.., "
        "dvvx.. "
        "by u and v, and status: valid; hole; out_of_range (no such face, or u and v are not within it). "
        "Values that are not valid are 0. With --texture: face,u,v,s,t,dus,dut,dvs,dvt, and so on.\n"
        "With --curvature, before status: gaussian, mean, the principal curvatures k1 >= k2 (positive where "
        "the "
        "surface bends away from its normal, as a sphere does) and the unit directions d1x..d1z, d2x..d2z "
        "that "
        "they belong to. Exactly at extraordinary vertices all are 0.\n"
        "Evaluation is in float, u and v included.\n"
        "Schemes without patches that split faces in four are evaluated by limit stencils, as deep as u and v ask "
        "for (to 24 binary digits): a row is face,u,v,px,py,pz,nx,ny,nz and status, with the unit normal.");
    command->callback([options, command, &status] {
        const SubdivisionScheme* scheme = scheme_without_patches(options->surface);
        if (scheme != nullptr && (options->texture || options->curvature))
            throw CLI::ValidationError("--scheme", "has no patches: positions and normals are all that there is");
        check_baked_usage(*command, options->model);
        status = run(*options);
    });
}

}  // namespace limn::cli
