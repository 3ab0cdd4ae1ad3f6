// Random control meshes from a seed: the same mesh on every machine.
#pragma once

#include <cstdint>

#include "shapes/shapes.h"

namespace limn::test {

// splitmix64, so that results do not depend on the standard library.
class RandomNumbers {
  public:
    explicit RandomNumbers(uint64_t seed) : state_(seed) {}
    uint64_t next();
    uint32_t below(uint32_t count);           // 0 .. count - 1
    double uniform(double low, double high);  // [low, high)
    bool chance(double probability) { return uniform(0, 1) < probability; }

  private:
    uint64_t state_;
};

// 1 to 200 faces, of any scheme and options: boundaries, polygons, creases, corners, holes, channels with
// seams; sometimes non-manifold, unoriented, with unused vertices or edges of length zero.
TestMesh random_mesh(uint64_t seed);

// A torus of around * across quads, some cut into triangles and some joined with the next to hexagons:
// irregular nearly everywhere, like production meshes at their worst.
TestMesh make_messy_torus(uint32_t around, uint32_t across, uint64_t seed);

// Under Doo-Sabin, which OpenSubdiv does not have: closed, with faces and valences of most sizes.
std::vector<TestMesh> doo_sabin_shapes();

}  // namespace limn::test
