// What the oracles share: test meshes as OpenSubdiv has them. Only oracles include this.
#pragma once

#include <opensubdiv/far/topologyRefiner.h>

#include <memory>
#include <string>

#include "shapes/shapes.h"

namespace limn::test {

// The mesh before any refinement, face-varying channels included. Null when OpenSubdiv refuses it or warns;
// `error` then holds what it said.
std::unique_ptr<OpenSubdiv::Far::TopologyRefiner> make_osd_refiner(const TestMesh& mesh, std::string* error);

// Whether OpenSubdiv has said nothing since the last refiner was made.
bool osd_is_content(std::string* error);

}  // namespace limn::test
