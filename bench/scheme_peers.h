// Other libraries that refine by subdivision schemes, as tests and benchmarks hold limn against them. All of
// them compute in double, and each refines a mesh of its own in place.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace limn::peers {

struct PolygonMesh {
    std::vector<double> points;  ///< 3 per vertex
    std::vector<uint32_t> face_sizes, face_vertices;
};

enum class Boundaries : uint8_t {
    same,      ///< limn's
    none,      ///< limn's, with BoundaryInterpolation::none
    other,     ///< rules of its own
    crashing,  ///< closed meshes only
};

/// A scheme of another library. Numbering is its own.
struct PeerScheme {
    const char* name;    ///< of limn's scheme
    const char* method;  ///< what the library calls it
    Boundaries boundaries;
    /// Refines `level` times. `milliseconds`, where given, receives the time of that alone, without making
    /// the library's mesh and reading it. A mesh without faces where the library refuses this one.
    PolygonMesh (*refine)(const PolygonMesh& mesh, uint32_t level, double* milliseconds);
};

struct Library {
    const char* name;
    std::span<const PeerScheme> schemes;
};

Library cgal_schemes();
Library openmesh_schemes();

}  // namespace limn::peers
