// limn bench in a build without benchmarks.
#include "cli/program.h"

namespace limn::cli {

void add_bench(CLI::App& program, int& status) {
    CLI::App* command = program.add_subcommand("bench", "Measure limn beside OpenSubdiv (not in this build)");
    command->allow_extras();
    command->callback([&status] {
        status = fail({ErrorCode::unsupported, "this build has no benchmarks: it needs LIMN_BUILD_BENCH and OpenSubdiv"});
    });
}

}  // namespace limn::cli
