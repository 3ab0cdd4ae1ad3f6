// The program limn. Commands, options and formats are a contract: scripts rely on them.
#include "cli/program.h"

#include <algorithm>
#include <cstdio>

int main(int argc, char** argv) {
    int status = 0;
    CLI::App program{
        "limn evaluates subdivision surfaces on Vulkan.\n"
        "A model is an OBJ file; creases, corners and holes are OpenSubdiv's tag lines, for example\n"
        "'t crease 2/1/0 4 7 2.5' for sharpness 2.5 along the edge between vertices 4 and 7 (counted from "
        "0).\n"
        "Start with: limn info MODEL; limn refine MODEL --level 3 -o OUT.obj; limn check MODEL."};
    program.set_version_flag("--version", "limn " LIMN_VERSION);
    program.require_subcommand(1);
    program.failure_message(CLI::FailureMessage::simple);
    limn::cli::add_info(program, status);
    limn::cli::add_bake(program, status);
    limn::cli::add_refine(program, status);
    limn::cli::add_eval(program, status);
    limn::cli::add_nurbs(program, status);
    limn::cli::add_tessellate(program, status);
    limn::cli::add_check(program, status);
    limn::cli::add_render(program, status);
    limn::cli::add_view(program, status);
    limn::cli::add_gallery(program, status);
    limn::cli::add_schemes(program, status);
    limn::cli::add_analyze(program, status);
    limn::cli::add_devices(program, status);
    limn::cli::add_bench(program, status);
    const auto commands = program.get_subcommands([](const CLI::App*) { return true; });
    const bool known = argc < 2 || argv[1][0] == '-' ||
                       std::any_of(commands.begin(), commands.end(),
                                   [&](const CLI::App* command) { return command->get_name() == argv[1]; });
    if (!known) {
        std::fprintf(stderr, "limn: there is no command '%s'; see limn --help\n", argv[1]);
        return limn::cli::kBadUsage;
    }
    try {
        program.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return program.exit(error) == 0 ? 0 : limn::cli::kBadUsage;
    }
    return status;
}
