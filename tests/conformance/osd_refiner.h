// What the parts of the oracle that know OpenSubdiv's types share.
#pragma once

#include <opensubdiv/far/topologyRefiner.h>

#include <memory>
#include <string>

#include "shapes/shapes.h"

namespace limn::test {

// The mesh, not refined yet. Null when OpenSubdiv refuses it or warns; `error` then holds what it said.
std::unique_ptr<OpenSubdiv::Far::TopologyRefiner> make_osd_refiner(const TestMesh& mesh, std::string* error);

}  // namespace limn::test
