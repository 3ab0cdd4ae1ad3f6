// The control meshes that benchmarks run on.
#pragma once

#include <string>
#include <vector>

#include "bench.h"
#include "limn/control_mesh.h"

namespace limn::bench {

/// Noise: the same numbers on every machine, in [0, 1), multiples of 2^-24.
double noise(uint64_t i);

struct BenchModel {
    std::string name;
    ControlMesh mesh;              ///< without face-varying channels
    std::vector<float> positions;  ///< 3 per vertex
};

/// The models named on the command line, or generated ones: a torus of quads with creases and extraordinary
/// vertices, small and large, and a messy one of triangles, quads and larger faces; with --quick the small
/// one. Fails on the first that cannot be read.
std::vector<BenchModel> load_models(const Options& options);

/// A torus like those of load_models, about 1.3 * around * across faces, with creases and extraordinary vertices where the
/// seed says: as dense however large it is.
BenchModel make_random_torus(uint32_t around, uint32_t across, uint64_t seed);

/// A plane of side x side quads, a little uneven.
BenchModel make_quads(std::string name, uint32_t side);

/// Six faces.
BenchModel make_cube();

/// A torus of about so many quads, without creases; a third of its vertices are extraordinary.
BenchModel make_smooth_torus(std::string name, uint32_t faces);

}  // namespace limn::bench
