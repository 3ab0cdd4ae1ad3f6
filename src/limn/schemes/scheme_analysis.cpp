#include "limn/schemes/scheme_analysis.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "limn/schemes/characteristic_map.h"
#include "limn/schemes/eigen_masks.h"
#include "limn/schemes/star.h"
#include "limn/schemes/star_chain.h"
#include "limn/schemes/star_limit.h"

namespace limn {
namespace {

using Complex = std::complex<double>;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

constexpr double kEqual = 1e-9;
constexpr double pi = std::numbers::pi;

Stage stage_of_faces(const SubdivisionScheme& scheme, uint32_t vertex_count,
                     const std::vector<std::vector<uint32_t>>& faces) {
    SchemeOptions options;
    options.scheme = scheme.faces == FaceKind::triangles ? Scheme::loop : Scheme::catmull_clark;
    Array<uint32_t> offsets, vertices;
    offsets.push_back(0);
    for (const auto& face : faces) {
        for (const uint32_t v : face) vertices.push_back(v);
        offsets.push_back(static_cast<uint32_t>(vertices.size()));
    }
    Stage stage;
    stage.topology = topology_of_faces(options, vertex_count, std::move(offsets), std::move(vertices), true);
    return stage;
}

/// Closed, with n faces around vertex 0 and as many around vertex 1; or a prism whose face 0 has n sides.
Stage closed_star(const SubdivisionScheme& scheme, uint32_t n) {
    std::vector<std::vector<uint32_t>> faces;
    if (scheme.dual) {
        faces.resize(2);
        for (uint32_t i = 0; i < n; ++i) {
            faces[0].push_back(i);
            faces[1].push_back(2 * n - 1 - i);
            faces.push_back({i, i + n, (i + 1) % n + n, (i + 1) % n});
        }
        return stage_of_faces(scheme, 2 * n, faces);
    }
    const bool triangles = scheme.faces == FaceKind::triangles;
    const uint32_t around = triangles ? n : 2 * n;
    for (uint32_t i = 0; i < n; ++i) {
        auto at = [&](uint32_t k) { return 2 + k % around; };
        if (triangles) {
            faces.push_back({0, at(i), at(i + 1)});
            faces.push_back({1, at(i + 1), at(i)});
        } else {
            faces.push_back({0, at(2 * i), at(2 * i + 1), at(2 * i + 2)});
            faces.push_back({1, at(2 * i + 3), at(2 * i + 2), at(2 * i + 1)});
        }
    }
    return stage_of_faces(scheme, 2 + around, faces);
}

/// Vertex 0 on the boundary of a fan of k faces.
Stage open_star(const SubdivisionScheme& scheme, uint32_t k) {
    std::vector<std::vector<uint32_t>> faces;
    const bool triangles = scheme.faces == FaceKind::triangles;
    for (uint32_t i = 0; i < k; ++i) {
        faces.push_back({0, 1 + i});
        if (!triangles) faces.back().push_back(2 + k + i);
        faces.back().push_back(2 + i);
    }
    return stage_of_faces(scheme, triangles ? 2 + k : 2 + 2 * k, faces);
}

/// The stationary patch, what a step does to its points, and the points within the rings of interest.
struct Neighborhood {
    StarChain chain;
    StarPatch patch;
    MatrixXd matrix;  ///< of the first matrix.rows() points, which depend on no others
};

Result<Neighborhood> find_neighborhood(const SubdivisionScheme& scheme, const AnalysisOptions& options) {
    const uint32_t rings = map_rings(scheme, options.rings);
    const Stage stage = options.boundary ? open_star(scheme, options.valence) : closed_star(scheme, options.valence);
    const StarPatch start = extract_patch(stage, {scheme.dual, 0}, scheme.period, rings);
    auto chain = follow_steps(start, scheme, rings, [](const std::vector<uint32_t>&) { return false; });
    if (!chain) return chain.error();
    if (!chain->exists) return Error{ErrorCode::unsupported, "the element turns into nothing"};
    Neighborhood out{std::move(*chain), {}, {}};
    out.patch = out.chain.in_cycle(0).patch;
    if (options.boundary && (out.patch.element.is_face || !is_boundary_vertex(out.patch.stage.topology, 0)))
        return Error{ErrorCode::unsupported, "boundary vertices of this scheme do not stay on the boundary"};
    out.matrix = out.chain.matrix_of_cycle(out.patch.ring_ends[std::max(options.rings, scheme.rings)]);
    return out;
}

/// label -> the one that lies there after a turn by one sector.
std::vector<uint32_t> sector_turn(const StarPatch& patch) {
    const Topology& t = patch.stage.topology;
    uint32_t next = 1;
    if (!patch.element.is_face) {
        const auto corners = t.corners_of_vertex(0);
        uint32_t first = 0;
        while (t.face_of_corner(corners[first]) != 0) ++first;
        next = (first + 1) % face_valence(t, 0);
    }
    StarWalk walk;
    walk.walk(t, {patch.element, next}, static_cast<uint32_t>(patch.ring_ends.size()) - 1);
    return walk.vertices;
}

/// Labels by sector: orbits[b][s] is member b of sector s. The centre is an orbit of one.
std::vector<std::vector<int>> orbits_of(const Neighborhood& around) {
    const std::vector<uint32_t> turn = sector_turn(around.patch);
    std::vector<uint8_t> seen(turn.size(), 0);
    std::vector<std::vector<int>> orbits;
    for (uint32_t label = 0; label < around.matrix.rows(); ++label) {
        if (seen[label] != 0) continue;
        auto& orbit = orbits.emplace_back();
        for (uint32_t v = label; seen[v] == 0; v = turn[v]) {
            seen[v] = 1;
            orbit.push_back(static_cast<int>(v));
        }
    }
    return orbits;
}

/// By how much a step turns the star, a multiple of half a sector.
double turn_of_step(const Neighborhood& around, uint32_t valence) {
    const bool is_face = around.patch.element.is_face;
    const std::vector<double> at = planar_layout(around.patch.stage.topology);
    VectorXcd z(around.patch.size());
    for (uint32_t v = 0; v < around.patch.size(); ++v) z[v] = {at[2 * size_t{v}], at[2 * size_t{v} + 1]};
    const Complex center = is_face ? z.head(valence).mean() : z[0];
    const Eigen::Index ray = is_face ? 0 : 1;
    const Complex child = around.chain.step(z)[ray];
    const double unit = pi / valence;
    return std::round(std::arg((child - center) / (z[ray] - center)) / unit) * unit;
}

MatrixXcd fourier_block(const MatrixXd& matrix, const std::vector<std::vector<int>>& orbits, uint32_t frequency,
                        uint32_t valence, double turn) {
    std::vector<size_t> used;
    for (size_t i = 0; i < orbits.size(); ++i)
        if (frequency == 0 || orbits[i].size() == valence) used.push_back(i);
    const auto size = static_cast<Eigen::Index>(used.size());
    MatrixXcd block = MatrixXcd::Zero(size, size);
    for (Eigen::Index a = 0; a < size; ++a)
        for (Eigen::Index b = 0; b < size; ++b) {
            const auto& to = orbits[used[static_cast<size_t>(b)]];
            for (size_t s = 0; s < to.size(); ++s)
                block(a, b) += matrix(orbits[used[static_cast<size_t>(a)]][0], to[s]) *
                               std::polar(1.0, 2 * pi * frequency * static_cast<double>(s) / valence);
        }
    return block * std::polar(1.0, -turn * frequency);
}

Curvature classify_curvature(double lambda, double mu0, double mu2, bool has_mu2) {
    const double square = lambda * lambda;
    constexpr double kSame = 1e-6;  // both may be defective
    auto same = [&](double mu) { return std::abs(mu - square) < kSame; };
    if (std::max(mu0, mu2) > square + kSame) return Curvature::unbounded;
    if (same(mu0)) return same(mu2) || !has_mu2 ? Curvature::bounded : Curvature::elliptic;
    return same(mu2) ? Curvature::hyperbolic : Curvature::flat;
}

Continuity classify(const SchemeAnalysis& a, bool subdominant) {
    const double least = std::min(a.lambda, a.lambda_cross);
    if (!subdominant || a.third > least + kEqual || a.lambda >= 1 - kEqual) return Continuity::not_smooth;
    if (a.third > least - kEqual) return Continuity::borderline;
    return a.map_is_regular && a.map_is_injective ? Continuity::smooth : Continuity::folds;
}

/// The right eigenvector of the first frequency's largest eigenvalue, in the plane; empty where it is not simple.
VectorXcd plane_of(const Neighborhood& around, const std::vector<std::vector<int>>& orbits, const MatrixXcd& block,
                   Complex lambda, uint32_t valence) {
    const MatrixXcd kernel = null_space(MatrixXcd(block - lambda * MatrixXcd::Identity(block.rows(), block.cols())));
    if (kernel.cols() != 1) return {};
    VectorXcd z = VectorXcd::Zero(around.patch.size());
    Eigen::Index row = 0;
    for (const auto& orbit : orbits) {
        if (orbit.size() != valence) continue;
        for (size_t s = 0; s < orbit.size(); ++s)
            z[orbit[s]] = kernel(row, 0) * std::polar(1.0, 2 * pi * static_cast<double>(s) / valence);
        ++row;
    }
    const Complex ray = z[around.patch.element.is_face ? 0 : 1];
    return std::abs(ray) > 1e-12 ? VectorXcd(z / ray) : VectorXcd();
}

void analyze_interior(const SubdivisionScheme& scheme, const AnalysisOptions& options, const Neighborhood& around,
                      SchemeAnalysis& out) {
    const uint32_t n = options.valence;
    const auto orbits = orbits_of(around);
    const double turn = turn_of_step(around, n);
    MatrixXcd first;
    for (uint32_t k = 0; k <= n / 2; ++k) {
        const MatrixXcd block = fourier_block(around.matrix, orbits, k, n, turn);
        out.frequencies.push_back({k, sorted_eigenvalues(block)});
        if (k == 1) first = block;
    }
    const Complex lambda = out.frequencies[1].eigenvalues[0];
    out.lambda = out.lambda_cross = lambda.real();
    out.mu0 = out.frequencies[0].eigenvalues.size() > 1 ? out.frequencies[0].eigenvalues[1] : 0;
    out.mu2 = n >= 4 ? out.frequencies[2].eigenvalues[0] : 0;
    for (const auto& [k, eigenvalues] : out.frequencies)
        for (size_t i = k < 2 ? 1 : 0; i < eigenvalues.size(); ++i)
            out.third = std::max(out.third, std::abs(eigenvalues[i]));
    out.curvature = classify_curvature(out.lambda, std::abs(out.mu0), std::abs(out.mu2), n >= 4);
    const VectorXcd z = plane_of(around, orbits, first, lambda, n);
    const Complex factor = lambda * std::polar(1.0, turn);
    if (z.size() != 0) draw_map(scheme, around.patch, options.rings, extend_map(around.chain, z, factor), out);
    out.continuity = classify(out, std::abs(lambda.imag()) < kEqual && lambda.real() > 0);
}

/// Left eigenvectors over all points of the patch.
MatrixXd tangents_of(const StarMask& mask, uint32_t size) {
    MatrixXd tangents = MatrixXd::Zero(size, 2);
    for (size_t i = 0; i < mask.labels.size(); ++i) {
        tangents(mask.labels[i], 0) = mask.tangent1[i];
        tangents(mask.labels[i], 1) = mask.tangent2[i];
    }
    return tangents;
}

/// Right eigenvectors that belong to two left ones; empty where they do not pair up (defective eigenvalues).
MatrixXd dual_vectors(const Neighborhood& around, const MatrixXd& left, const double (&lambda)[2]) {
    const MatrixXd& block = around.matrix;
    const MatrixXd unit = MatrixXd::Identity(block.rows(), block.cols());
    MatrixXd right = null_space(MatrixXd(block - lambda[0] * unit));
    if (std::abs(lambda[0] - lambda[1]) > kEqual) {
        const MatrixXd second = null_space(MatrixXd(block - lambda[1] * unit));
        right.conservativeResize(right.rows(), right.cols() + second.cols());
        right.rightCols(second.cols()) = second;
    }
    const MatrixXd pairing = left.topRows(block.rows()).transpose() * right;
    if (pairing.cols() != 2 || std::abs(pairing.determinant()) < 1e-9) return {};
    MatrixXd out = MatrixXd::Zero(around.patch.size(), 2);
    out.topRows(block.rows()) = right * pairing.inverse();
    return out;
}

Result<void> analyze_boundary(const SubdivisionScheme& scheme, const AnalysisOptions& options,
                              const Neighborhood& around, SchemeAnalysis& out) {
    StarLimits limits(scheme, patch_rings(scheme));
    const auto mask =
        limits.make(extract_patch(around.patch.stage, around.patch.element, scheme.period, patch_rings(scheme)));
    if (!mask) return mask.error();
    const MatrixXd left = tangents_of(**mask, around.patch.size());
    double lambda[2];
    for (int i = 0; i < 2; ++i)
        lambda[i] = left.col(i).dot(around.chain.step(left.col(i).cast<Complex>()).real()) / left.col(i).squaredNorm();
    out.lambda = lambda[0];
    out.lambda_cross = lambda[1];
    out.frequencies.push_back({0, sorted_eigenvalues(around.matrix)});
    auto others = out.frequencies[0].eigenvalues;
    for (const double known : {1.0, lambda[0], lambda[1]})
        others.erase(std::min_element(others.begin(), others.end(),
                                      [&](Complex a, Complex b) { return std::abs(a - known) < std::abs(b - known); }));
    for (const Complex value : others) out.third = std::max(out.third, std::abs(value));
    const MatrixXd right = dual_vectors(around, left, lambda);
    if (right.cols() == 2) {
        const VectorXcd x = extend_map(around.chain, right.col(0).cast<Complex>(), lambda[0]);
        const VectorXcd y = extend_map(around.chain, right.col(1).cast<Complex>(), lambda[1]);
        draw_map(scheme, around.patch, options.rings, x + Complex(0, 1) * y, out);
    }
    out.continuity = classify(out, (*mask)->smooth);
    return {};
}

}  // namespace

Result<SchemeAnalysis> analyze_scheme(const SubdivisionScheme& scheme, const AnalysisOptions& options) {
    if (options.valence < (options.boundary ? 1u : 3u) || options.valence > 64)
        return Error{ErrorCode::invalid_argument, "a valence is 3 to 64, of a boundary 1 to 64 faces"};
    if (options.rings < 1 || options.rings > 6)
        return Error{ErrorCode::invalid_argument, "a characteristic map has 1 to 6 rings"};
    if (options.boundary && scheme.dual)
        return Error{ErrorCode::unsupported, "boundary vertices of a dual scheme turn into faces inside"};
    const auto around = find_neighborhood(scheme, options);
    if (!around) return around.error();
    SchemeAnalysis out;
    out.steps = static_cast<uint32_t>(around->chain.cycle_size());
    if (!options.boundary) {
        analyze_interior(scheme, options, *around, out);
        return out;
    }
    if (auto ok = analyze_boundary(scheme, options, *around, out); !ok) return ok.error();
    return out;
}

const char* describe(Continuity continuity) {
    switch (continuity) {
        case Continuity::smooth:
            return "C1";
        case Continuity::borderline:
            return "not C1: a third eigenvalue equals the subdominant ones";
        case Continuity::not_smooth:
            return "not C1: subdominant eigenvalues of other frequencies";
        case Continuity::folds:
            return "not C1: the characteristic map folds";
    }
    return "";
}

const char* describe(Curvature curvature) {
    switch (curvature) {
        case Curvature::bounded:
            return "bounded";
        case Curvature::elliptic:
            return "bounded, elliptic";
        case Curvature::hyperbolic:
            return "bounded, hyperbolic";
        case Curvature::flat:
            return "zero";
        case Curvature::unbounded:
            return "unbounded";
    }
    return "";
}

}  // namespace limn
