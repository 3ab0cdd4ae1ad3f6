// The surroundings of one vertex, refined by OpenSubdiv as often as one likes.
#pragma once

#include <vector>

#include "conformance/vectors.h"
#include "shapes/shapes.h"

namespace limn::test {

// The faces around vertex 0 of a mesh, with points in double: small enough to refine as often as one likes.
struct Neighbourhood {
    TestMesh mesh;
    std::vector<double> points;
    Vector origin{};    // of `points`; vertex 0 is kept near zero
    double unit = 1.0;  // of `points`; the ring is kept near size 1
};

// One step of refinement around vertex 0, cut down to its two rings. Points nearer to the cut than that are
// wrong, and none of them reaches the next step. Faces around vertex 0 keep their order, and vertex 0 its
// place in each of them that is a quad or a triangle.
Neighbourhood refine_around(const Neighbourhood& parent);

}  // namespace limn::test
