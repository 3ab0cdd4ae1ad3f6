// Writes small baked files into a directory: what the fuzzer begins with.
#include <cstdio>

#include "limn/baked_file.h"
#include "shapes/bake_shape.h"

int main(int argc, char** argv) {
    if (argc != 2) return std::fprintf(stderr, "usage: limn_baked_file_seeds DIRECTORY\n"), 2;
    uint32_t count = 0;
    for (const limn::test::TestMesh& shape : limn::test::all_shapes()) {
        const auto mesh = limn::test::bake_shape(shape, false);
        if (!mesh || mesh->bytes() > 20'000) continue;
        const auto all = limn::test::bake_shape(shape, true);
        const bool extras = all && all->bytes() < 30'000;
        if (!limn::write_baked_file(std::string(argv[1]) + "/" + shape.name + ".limn", extras ? *all : *mesh)) return 1;
        ++count;
    }
    std::printf("%u files\n", count);
    return count == 0 ? 1 : 0;
}
