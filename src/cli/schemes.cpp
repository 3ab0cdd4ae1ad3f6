// limn schemes: what --scheme takes.
#include <algorithm>
#include <cstdio>

#include "cli/program.h"
#include "limn/schemes/subdivision_scheme.h"

namespace limn::cli {
namespace {

const char* name_of(FaceKind faces) {
    return faces == FaceKind::polygons ? "any faces" : faces == FaceKind::quads ? "quads" : "triangles";
}

void print_schemes() {
    const auto patches = scheme_names();
    for (const SubdivisionScheme& scheme : subdivision_schemes()) {
        std::string traits = name_of(scheme.faces);
        traits += scheme.dual ? ", dual" : ", primal";
        if (scheme.interpolates) traits += ", interpolating";
        if (scheme.creases == CreaseRules::semi_sharp) traits += ", creases";
        if (std::find(patches.begin(), patches.end(), scheme.name) != patches.end()) traits += ", patches";
        if (scheme.reconstructed) traits += ", reconstructed";
        std::printf("%-22s %-39s %s%s%s\n", scheme.name, scheme.title, traits.c_str(), *scheme.source != 0 ? "; " : "",
                    scheme.source);
    }
}

}  // namespace

void add_schemes(CLI::App& program, int& status) {
    CLI::App* command = program.add_subcommand("schemes", "List the subdivision schemes that --scheme takes");
    command->footer(
        "Schemes with patches are evaluated anywhere, tessellated adaptively, baked and checked; all are refined,\n"
        "moved to their limit, tessellated evenly and drawn. Reconstructed: rules that could not be compared with\n"
        "the paper's own text.");
    command->callback([&status] {
        print_schemes();
        status = 0;
    });
}

}  // namespace limn::cli
