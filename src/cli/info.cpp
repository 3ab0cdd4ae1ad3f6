// limn info: what a model is made of.
#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/model_tables.h"
#include "cli/scheme_model.h"
#include "limn/baked_file.h"
#include "limn/file.h"
#include "limn/patch_table.h"
#include "limn/refinement.h"
#include "limn/stencil_table.h"

namespace limn::cli {
namespace {

struct Options {
    std::string path;
    SurfaceOptions surface;
    bool json = false;
};

struct Histogram {
    const char* title;
    std::map<uint32_t, uint64_t> counts;
};

/// The patch table of positions or of texture coordinates.
struct TableSummary {
    uint64_t ptex_faces = 0, surfaces = 0, plans = 0, level1_points = 0, bytes = 0, plan_bytes = 0;
    uint32_t largest_ring = 0;
};

struct Summary {
    uint64_t vertices = 0, edges = 0, faces = 0, corners = 0, boundary_edges = 0, non_manifold_vertices = 0,
             loose_vertices = 0, holes = 0, semi_sharp_edges = 0, infinite_edges = 0, sharp_vertices = 0;
    float largest_finite_sharpness = 0;
    Histogram face_sizes{"faces by size", {}}, interior_valences{"interior vertices by valence", {}},
        boundary_faces{"boundary vertices by faces", {}};
    uint64_t texture_values = 0, texture_seam_vertices = 0;
    uint64_t step_table_bytes = 0;  ///< level 1
    std::optional<TableSummary> surface, texture;
    std::vector<std::string> notes;  ///< why there is no table
};

void count_edges(const Topology& t, Summary& s) {
    for (uint32_t e = 0; e < t.edge_count; ++e) {
        const float sharpness = t.edge_sharpness[e];
        const size_t faces = t.corners_of_edge(e).size();
        s.boundary_edges += faces == 1;
        if (faces == 1) continue;
        s.infinite_edges += is_infinite(sharpness);
        s.semi_sharp_edges += sharpness > 0 && !is_infinite(sharpness);
        if (!is_infinite(sharpness))
            s.largest_finite_sharpness = std::max(s.largest_finite_sharpness, sharpness);
    }
}

void count_vertices(const Topology& t, Summary& s) {
    for (uint32_t v = 0; v < t.vertex_count; ++v) {
        const auto faces = static_cast<uint32_t>(t.corners_of_vertex(v).size());
        const bool closed = t.edges_of_vertex(v).size() == faces;
        const float sharpness = t.vertex_sharpness[v];
        if (faces == 0) {
            ++s.loose_vertices;
        } else if (t.vertex_manifold[v] == 0) {
            ++s.non_manifold_vertices;
        } else {
            s.sharp_vertices += sharpness > 0;
            if (!is_infinite(sharpness))
                s.largest_finite_sharpness = std::max(s.largest_finite_sharpness, sharpness);
            ++(closed ? s.interior_valences : s.boundary_faces).counts[faces];
        }
    }
}

TableSummary summary_of(const PatchTable& table) {
    TableSummary t;
    t.ptex_faces = table.ptex_surfaces.size();
    t.surfaces = table.surfaces.size();
    t.plans = table.plans.size();
    t.level1_points = table.refined_count;
    t.bytes = table.bytes();
    t.plan_bytes = table.plan_bytes();
    for (const Plan& plan : table.plans) t.largest_ring = std::max(t.largest_ring, plan.ring_size);
    return t;
}

/// A mesh that has no patch table is still one to be told about.
void summarize_table(const Result<PatchTable>& table, const char* what, std::optional<TableSummary>& out,
                     Summary& s) {
    if (table)
        out = summary_of(*table);
    else
        s.notes.push_back("no patch table of " + std::string(what) + ": " + table.error().message);
}

/// Of the stencils of level 1.
Result<uint64_t> count_step_table_bytes(const LoadedModel& model, const SurfaceOptions& options) {
    if (const SubdivisionScheme* scheme = scheme_without_refinement(options)) {
        const auto values = corner_values_of(model, *scheme);
        if (!values) return values.error();
        const auto refined = build_scheme_refinement<float>(model.mesh, *scheme, {1, false}, *values);
        if (!refined) return refined.error();
        return refined->tables[0].bytes();
    }
    const Result<Refinement> refinement = build_refinement(model.mesh, {1, false});
    if (!refinement) return refinement.error();
    const auto step = build_step_table<float>(*refinement, 1);
    if (!step) return step.error();
    return step->bytes();
}

Result<Summary> summarize(const LoadedModel& model, const SurfaceOptions& options) {
    const ControlMesh& mesh = model.mesh;
    const Topology t = build_topology(mesh);
    Summary s;
    s.vertices = t.vertex_count;
    s.edges = t.edge_count;
    s.faces = t.face_count;
    s.corners = t.corner_count();
    for (uint32_t f = 0; f < t.face_count; ++f) {
        ++s.face_sizes.counts[t.size_of_face(f)];
        s.holes += t.face_holes[f];
    }
    count_edges(t, s);
    count_vertices(t, s);
    if (!mesh.channels.empty()) {
        Array<uint32_t> values;
        const Topology cut = build_face_varying_topology(mesh, t, 0, values);
        s.texture_values = mesh.channels[0].value_count;
        s.texture_seam_vertices = cut.vertex_count - (t.vertex_count - s.loose_vertices);
    }
    const auto step_table_bytes = count_step_table_bytes(model, options);
    if (!step_table_bytes) return step_table_bytes.error();
    s.step_table_bytes = *step_table_bytes;
    if (const SubdivisionScheme* scheme = scheme_without_patches(options)) {
        s.notes.push_back("no patch tables: " + std::string(scheme->title) + " has no patches and is refined evenly");
        return s;
    }
    const PlanCache cache;
    summarize_table(build_patch_table<float>(mesh, {}, &cache), "positions", s.surface, s);
    if (!mesh.channels.empty())
        summarize_table(build_face_varying_patch_table<float>(mesh, 0, {}, &cache), "texture coordinates",
                        s.texture, s);
    return s;
}

void print_histogram(const Histogram& h) {
    if (h.counts.empty()) return;
    std::printf("%s:", h.title);
    for (const auto& [key, count] : h.counts)
        std::printf("  %u: %llu", key, static_cast<unsigned long long>(count));
    std::printf("\n");
}

void print_table(const char* what, const TableSummary& t) {
    std::printf("%s: %s, %s, %s, largest ring %u, %s of level 1\n", what,
                plural(t.ptex_faces, "ptex face").c_str(), plural(t.surfaces, "surface").c_str(),
                plural(t.plans, "plan").c_str(), t.largest_ring, plural(t.level1_points, "point").c_str());
    std::printf("%s, patch table: %s, %s of it plans\n", what, human_bytes(t.bytes).c_str(),
                human_bytes(t.plan_bytes).c_str());
}

void print_text(const Options& options, const Summary& s) {
    std::printf("%s: %s, %s, %s\n", options.path.c_str(), (std::to_string(s.vertices) + " vertices").c_str(),
                plural(s.edges, "edge").c_str(), plural(s.faces, "face").c_str());
    print_histogram(s.face_sizes);
    print_histogram(s.interior_valences);
    print_histogram(s.boundary_faces);
    auto line = [](const char* what, uint64_t count) {
        if (count != 0) std::printf("%s: %llu\n", what, static_cast<unsigned long long>(count));
    };
    line("boundary edges", s.boundary_edges);
    line("non-manifold vertices", s.non_manifold_vertices);
    line("vertices without faces", s.loose_vertices);
    line("holes", s.holes);
    line("semi-sharp edges", s.semi_sharp_edges);
    line("infinitely sharp edges", s.infinite_edges);
    line("sharp vertices", s.sharp_vertices);
    if (s.largest_finite_sharpness > 0)
        std::printf("largest finite sharpness: %g\n", static_cast<double>(s.largest_finite_sharpness));
    if (s.texture_values != 0)
        std::printf("texture coordinates: %llu, %llu more than vertices along seams\n",
                    static_cast<unsigned long long>(s.texture_values),
                    static_cast<unsigned long long>(s.texture_seam_vertices));
    std::printf("stencils of level 1: %s\n", human_bytes(s.step_table_bytes).c_str());
    if (s.surface) print_table("limit surface", *s.surface);
    if (s.texture) print_table("texture coordinates", *s.texture);
    for (const std::string& note : s.notes) std::printf("%s\n", note.c_str());
}

nlohmann::json histogram_json(const Histogram& h) {
    nlohmann::json json = nlohmann::json::object();
    for (const auto& [key, count] : h.counts) json[std::to_string(key)] = count;
    return json;
}

/// Keys begin with `prefix`; null where there is no table.
void add_table_json(const std::string& prefix, const std::optional<TableSummary>& table,
                    nlohmann::json& json) {
    const TableSummary t = table.value_or(TableSummary{});
    const std::pair<const char*, uint64_t> values[] = {
        {"ptex_faces", t.ptex_faces},     {"surfaces", t.surfaces},           {"plans", t.plans},
        {"largest_ring", t.largest_ring}, {"level1_points", t.level1_points}, {"patch_table_bytes", t.bytes},
        {"plan_bytes", t.plan_bytes}};
    for (const auto& [key, value] : values)
        json[prefix + key] = table ? nlohmann::json(value) : nlohmann::json();
}

void print_json(const Options& options, const Summary& s) {
    nlohmann::json json = {{"model", options.path},
                           {"vertices", s.vertices},
                           {"edges", s.edges},
                           {"faces", s.faces},
                           {"face_sizes", histogram_json(s.face_sizes)},
                           {"interior_valences", histogram_json(s.interior_valences)},
                           {"boundary_vertex_faces", histogram_json(s.boundary_faces)},
                           {"boundary_edges", s.boundary_edges},
                           {"non_manifold_vertices", s.non_manifold_vertices},
                           {"loose_vertices", s.loose_vertices},
                           {"holes", s.holes},
                           {"semi_sharp_edges", s.semi_sharp_edges},
                           {"infinitely_sharp_edges", s.infinite_edges},
                           {"sharp_vertices", s.sharp_vertices},
                           {"largest_finite_sharpness", s.largest_finite_sharpness},
                           {"texture_values", s.texture_values},
                           {"texture_seam_vertices", s.texture_seam_vertices},
                           {"level1_stencil_bytes", s.step_table_bytes}};
    add_table_json("", s.surface, json);
    add_table_json("texture_", s.texture, json);
    std::printf("%s\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
}

/// What is in a baked file.
struct BakedSummary {
    std::string scheme;
    std::vector<uint32_t> grid_rates, refined_levels;
    TableSummary surface;
    std::optional<TableSummary> texture;
};

BakedSummary summarize(const BakedMesh& mesh) {
    BakedSummary s;
    s.scheme = scheme_names()[static_cast<size_t>(mesh.patches.options.scheme)];
    for (const GridTable& grid : mesh.grids) s.grid_rates.push_back(grid.rate);
    for (const RefinedGridTable& refined : mesh.refined) s.refined_levels.push_back(refined.level);
    s.surface = summary_of(mesh.patches);
    if (const BakedChannel* channel = texture_of(mesh)) s.texture = summary_of(channel->patches);
    return s;
}

void print_baked_text(const Options& options, const BakedFile& file) {
    const BakedMesh& mesh = file.mesh();
    const BakedSummary s = summarize(mesh);
    std::printf("%s: baked, %s, %u vertices, %s, %s; rates up to %u; %s\n", printable(options.path).c_str(),
                s.scheme.c_str(), mesh.patches.control_count, plural(mesh.edges.size() / 2, "edge").c_str(),
                plural(mesh.face_count, "face").c_str(), mesh.trees.max_rate, human_bytes(file.bytes()).c_str());
    print_table("limit surface", s.surface);
    if (s.texture) print_table("texture coordinates", *s.texture);
    std::printf("tessellation: %s; patch trees: %s\n", human_bytes(mesh.tessellation.bytes()).c_str(),
                human_bytes(mesh.trees.bytes()).c_str());
    const auto list = [](const char* what, const std::vector<uint32_t>& numbers) {
        if (numbers.empty()) return;
        std::printf("%s:", what);
        for (const uint32_t number : numbers) std::printf(" %u", number);
        std::printf("\n");
    };
    list("grids of rate", s.grid_rates);
    list("refined points of level", s.refined_levels);
    std::printf("key: %s\n", mesh.key.hex().c_str());
}

void print_baked_json(const Options& options, const BakedFile& file) {
    const BakedMesh& mesh = file.mesh();
    const BakedSummary s = summarize(mesh);
    nlohmann::json json = {{"model", options.path},
                           {"baked", true},
                           {"key", mesh.key.hex()},
                           {"file_bytes", file.bytes()},
                           {"scheme", s.scheme},
                           {"vertices", mesh.patches.control_count},
                           {"edges", mesh.edges.size() / 2},
                           {"faces", mesh.face_count},
                           {"max_rate", mesh.trees.max_rate},
                           {"tessellation_bytes", mesh.tessellation.bytes()},
                           {"patch_tree_bytes", mesh.trees.bytes()},
                           {"grid_rates", s.grid_rates},
                           {"refined_levels", s.refined_levels}};
    add_table_json("", s.surface, json);
    add_table_json("texture_", s.texture, json);
    std::printf("%s\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
}

int run_baked(const Options& options) {
    const Result<BakedFile> file = BakedFile::open(options.path);
    if (!file) return fail(file.error());
    options.json ? print_baked_json(options, *file) : print_baked_text(options, *file);
    return 0;
}

int run(const Options& options) {
    if (is_baked_file(options.path)) return run_baked(options);
    const Result<LoadedModel> loaded = load_model(options.path, options.surface);
    if (!loaded) return fail(loaded.error());
    Result<Summary> summary = summarize(*loaded, options.surface);
    if (!summary) {
        Error error = summary.error();
        error.message = printable(options.path) + ": " + error.message;
        return fail(error);
    }
    if (options.json)
        print_json(options, *summary);
    else
        print_text(options, *summary);
    return 0;
}

}  // namespace

void add_info(CLI::App& program, int& status) {
    auto options = std::make_shared<Options>();
    CLI::App* command = program.add_subcommand("info", "Say what a model is made of");
    command->add_option("MODEL", options->path, "OBJ file, or one of limn bake")->required();
    command->add_flag("--json", options->json, "Print JSON");
    add_surface_options(*command, options->surface, SchemesTaken::all);
    command->callback([options, command, &status] {
        check_baked_usage(*command, options->path);
        status = run(*options);
    });
}

}  // namespace limn::cli
