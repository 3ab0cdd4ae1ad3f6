// Meshes refined in double, and verified numbers to hold them against (scheme_checks.json).
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "limn/schemes/scheme_refinement.h"

namespace limn::test {

/// Vertices that some face uses, and faces.
struct RefinedMesh {
    std::vector<double> points;  // 3 per vertex
    std::vector<uint32_t> face_sizes, face_vertices;

    uint32_t vertex_count() const { return static_cast<uint32_t>(points.size() / 3); }
};

/// tests/schemes/scheme_checks.json
const nlohmann::json& scheme_checks();

RefinedMesh json_mesh(const std::string& name);

ControlMesh control_mesh_of(const RefinedMesh& mesh, const SchemeOptions& options = {});

/// Refined `level` times by tables in double. Fails the test where that is an error.
RefinedMesh refine_mesh(const RefinedMesh& mesh, const SubdivisionScheme& scheme, uint32_t level,
                        const SchemeOptions& options = {});

/// A regular torus, n faces each way: quads, or two triangles for each of them.
RefinedMesh make_regular_torus(uint32_t n, bool triangles);

/// A mesh that the scheme takes: closed or open, irregular, without symmetry.
RefinedMesh make_irregular_mesh(const SubdivisionScheme& scheme, bool open, uint64_t seed);

/// A torus that the scheme takes, if not quads alone, irregular nearly everywhere; with holes where it is open.
RefinedMesh make_random_manifold(const SubdivisionScheme& scheme, bool open, uint64_t seed);

}  // namespace limn::test
