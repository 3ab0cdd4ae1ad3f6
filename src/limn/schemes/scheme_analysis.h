// What a scheme does around one vertex or face, analysed from its own steps: eigenvalues, characteristic map,
// continuity.
#pragma once

#include <complex>
#include <cstdint>
#include <vector>

#include "limn/result.h"
#include "limn/schemes/subdivision_scheme.h"

namespace limn {

/// A vertex of a primal scheme, a face of a dual one, all around it regular. Of boundary, crease and dart at most one.
struct AnalysisOptions {
    uint32_t valence = 4;   ///< faces around the vertex, 3 to 64, of a boundary vertex 1 to 64; sides of the face
    bool boundary = false;  ///< of a primal scheme: a vertex on a smooth boundary
    /// Of a scheme with crease rules: a vertex on an infinitely sharp crease, which has as many faces (1 to valence - 1)
    /// on the side that is looked at, the others beyond; 0: none.
    uint32_t crease = 0;
    bool dart = false;   ///< of a scheme with crease rules: a vertex at which an infinitely sharp crease ends
    uint32_t rings = 3;  ///< of the characteristic map, 1 to 6
};

enum class Continuity : uint8_t {
    smooth,      ///< C1 for almost all control points: a tangent plane, and no fold (Reif 1995)
    borderline,  ///< another eigenvalue is as large as the subdominant ones: not C1 in general
    not_smooth,  ///< another eigenvalue is larger, or the subdominant one is none of the first frequency
    folds,       ///< eigenvalues would do, but the characteristic map folds or covers the plane more than once
};

/// Which eigenvalues decide curvature, mu of the frequencies 0 and 2 beside lambda^2 (Peters and Reif 2004).
enum class Curvature : uint8_t {
    bounded,     ///< both equal: every shape, of bounded curvature
    elliptic,    ///< frequency 0 alone equals it: no saddles
    hyperbolic,  ///< frequency 2 alone equals it: saddles alone
    flat,        ///< both less: curvature vanishes there
    unbounded,   ///< one is greater: curvature grows without bound
};

struct SchemeAnalysis {
    /// Eigenvalues of one Fourier frequency, largest modulus first. Frequencies 0 to valence / 2 (a frequency k between
    /// 0 and valence / 2 counts twice, as valence - k); of boundaries, creases (of the side that is looked at) and darts,
    /// which have no symmetry to turn by, one list of all.
    struct Frequency {
        uint32_t frequency = 0;
        std::vector<std::complex<double>> eigenvalues;
    };
    /// Of as many steps as lie between alike neighbourhoods: mostly 1; 2 at boundaries that repeat each second step.
    /// Steps that turn the mesh by half a sector are turned back.
    uint32_t steps = 1;
    std::vector<Frequency> frequencies;
    double lambda = 0;              ///< subdominant eigenvalue; of a boundary or crease the one along it
    double lambda_cross = 0;        ///< of a boundary or crease the one across it, of a dart the second; else lambda
    double third = 0;               ///< largest modulus of all others, 1 excepted
    std::complex<double> mu0, mu2;  ///< largest of frequency 0 after 1, and of frequency 2 (0 below valence 4)
    Continuity continuity = Continuity::not_smooth;
    Curvature curvature = Curvature::flat;  ///< not of boundaries, creases and darts

    /// The characteristic map, the surface's shape next to the element, subdivision by subdivision: x and y of its
    /// control points, and faces, counter-clockwise. Empty where there is none. The vertex is point 0, or the face is
    /// face 0. Of a crease the side that is looked at: points beyond are 0, and no face refers to them.
    std::vector<double> points;
    std::vector<uint32_t> face_sizes, face_vertices, face_rings;
    bool map_is_regular = false;    ///< refined twice, all faces have positive corners
    bool map_is_injective = false;  ///< its outline winds once and crosses itself nowhere

    uint32_t point_count() const { return static_cast<uint32_t>(points.size() / 2); }
};

/// Builds a star, refines it until it repeats, and takes that step's matrix apart. Thread-safe. Errors:
/// invalid_argument (options out of range or at odds), unsupported (boundaries of dual schemes, and of schemes whose
/// boundary vertices leave the boundary; creases of schemes that have no rules for them).
Result<SchemeAnalysis> analyze_scheme(const SubdivisionScheme& scheme, const AnalysisOptions& options);

/// In words: "C1", "not C1: ...".
const char* describe(Continuity continuity);
const char* describe(Curvature curvature);

}  // namespace limn
