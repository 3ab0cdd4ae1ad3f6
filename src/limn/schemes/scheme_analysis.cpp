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
#include "limn/schemes/star_tangents.h"

namespace limn {
namespace {

using Complex = std::complex<double>;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

constexpr double kEqual = 1e-9;
constexpr double pi = std::numbers::pi;

ControlMesh empty_star(const SubdivisionScheme& scheme, uint32_t vertex_count) {
    ControlMesh star;
    star.options.scheme = scheme.faces == FaceKind::triangles ? Scheme::loop : Scheme::catmull_clark;
    star.vertex_count = vertex_count;
    star.face_offsets.push_back(0);
    return star;
}

void add_face(ControlMesh& star, std::initializer_list<uint32_t> vertices) {
    for (const uint32_t v : vertices) star.face_vertices.push_back(v);
    star.face_offsets.push_back(static_cast<uint32_t>(star.face_vertices.size()));
}

/// Face 0 with n sides, between quads.
ControlMesh prism(const SubdivisionScheme& scheme, uint32_t n) {
    ControlMesh star = empty_star(scheme, 2 * n);
    for (const bool top : {true, false}) {
        for (uint32_t i = 0; i < n; ++i) star.face_vertices.push_back(top ? i : 2 * n - 1 - i);
        star.face_offsets.push_back(static_cast<uint32_t>(star.face_vertices.size()));
    }
    for (uint32_t i = 0; i < n; ++i) add_face(star, {i, i + n, (i + 1) % n + n, (i + 1) % n});
    return star;
}

/// Closed, with n faces around vertex 0 and as many around vertex 1.
ControlMesh closed_star(const SubdivisionScheme& scheme, uint32_t n) {
    const bool triangles = scheme.faces == FaceKind::triangles;
    const uint32_t around = triangles ? n : 2 * n;
    ControlMesh star = empty_star(scheme, 2 + around);
    for (uint32_t i = 0; i < n; ++i) {
        auto at = [&](uint32_t k) { return 2 + k % around; };
        if (triangles) {
            add_face(star, {0, at(i), at(i + 1)});
            add_face(star, {1, at(i + 1), at(i)});
        } else {
            add_face(star, {0, at(2 * i), at(2 * i + 1), at(2 * i + 2)});
            add_face(star, {1, at(2 * i + 3), at(2 * i + 2), at(2 * i + 1)});
        }
    }
    return star;
}

/// Vertex 0 on the boundary of a fan of k faces.
ControlMesh open_star(const SubdivisionScheme& scheme, uint32_t k) {
    const bool triangles = scheme.faces == FaceKind::triangles;
    ControlMesh star = empty_star(scheme, triangles ? 2 + k : 2 + 2 * k);
    for (uint32_t i = 0; i < k; ++i) {
        if (triangles)
            add_face(star, {0, 1 + i, 2 + i});
        else
            add_face(star, {0, 1 + i, 2 + k + i, 2 + i});
    }
    return star;
}

/// Edge i around vertex 0 of a closed star becomes infinitely sharp.
void add_crease(ControlMesh& star, uint32_t i) {
    const uint32_t step = star.options.scheme == Scheme::loop ? 1 : 2;
    star.crease_edges.insert(star.crease_edges.end(), {0, 2 + step * i});
    star.crease_sharpness.push_back(kInfiniteSharpness);
}

Stage stage_of(const SubdivisionScheme& scheme, const AnalysisOptions& options) {
    ControlMesh star = options.boundary ? open_star(scheme, options.valence)
                       : scheme.dual    ? prism(scheme, options.valence)
                                        : closed_star(scheme, options.valence);
    if (options.crease != 0 || options.dart) add_crease(star, 0);
    if (options.crease != 0) add_crease(star, options.crease);
    Stage stage;
    stage.topology = build_topology(star);
    show_all_faces(stage.topology);
    return stage;
}

/// The stationary patch, what a step does to its points, and the points within the rings of interest.
struct Neighborhood {
    StarChain chain;
    StarPatch patch;
    MatrixXd matrix;  ///< of the first matrix.rows() points, which depend on no others
};

Result<Neighborhood> find_neighborhood(const SubdivisionScheme& scheme, const AnalysisOptions& options) {
    const uint32_t rings = map_rings(scheme, options.rings);
    const StarPatch start = extract_patch(stage_of(scheme, options), {scheme.dual, 0}, scheme.period, rings);
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

/// A piece of the surface at a vertex without symmetry: one side of what cuts it, or all around a dart.
struct Piece {
    StarPatch patch;  ///< the faces of the piece alone, of the same labels
    std::optional<Tangents> tangents;
    std::vector<int> labels;  ///< of the matrix: of the piece, and what they depend on

    bool has(uint32_t v) const { return face_valence(patch.stage.topology, v) != 0; }
};

/// The faces that hang together with those of a sector without a sharp edge between: a crease becomes a boundary, which
/// is the same to them.
Topology faces_beside(const Topology& t, const Sector& sector) {
    ControlMesh mesh;
    mesh.options = t.options;
    mesh.vertex_count = t.vertex_count;
    mesh.face_offsets.push_back(0);
    std::vector<uint8_t> seen(t.face_count, 0);
    std::vector<uint32_t> faces = {t.face_of_corner(t.corners_of_vertex(0)[sector.edge % face_valence(t, 0)])};
    seen[faces[0]] = 1;
    for (size_t i = 0; i < faces.size(); ++i) {
        for (uint32_t c = t.face_begin(faces[i]), k = t.size_of_face(faces[i]); k-- != 0; ++c) {
            mesh.face_vertices.push_back(t.face_vertices[c]);
            const uint32_t opposite = opposite_corner(t, c);
            if (opposite == kInvalidIndex || is_infinite(t.edge_sharpness[t.face_edges[c]])) continue;
            const uint32_t f = t.face_of_corner(opposite);
            if (std::exchange(seen[f], uint8_t{1}) == 0) faces.push_back(f);
        }
        mesh.face_offsets.push_back(static_cast<uint32_t>(mesh.face_vertices.size()));
    }
    Topology out = build_topology(mesh);
    show_all_faces(out);
    return out;
}

Piece piece_of(const AnalysisOptions& options, const Neighborhood& around) {
    const StarPatch& patch = around.patch;
    const MatrixXd matrix = around.chain.matrix_of_cycle(patch.size());
    Piece piece{patch, {}, {}};
    if (options.dart) {
        piece.tangents = smooth_tangents(patch, matrix);
    } else {
        std::vector<Sector> sectors = sectors_of(patch);
        if (options.crease != 0)
            std::erase_if(sectors, [&](const Sector& sector) { return sector.faces != options.crease; });
        piece.tangents = sector_tangents(patch, matrix, sectors[0]);
        piece.patch.stage.topology = faces_beside(patch.stage.topology, sectors[0]);
    }
    if (piece.tangents) orient(patch, *piece.tangents);
    for (int v = 0; v < around.matrix.rows(); ++v)
        if (piece.has(static_cast<uint32_t>(v))) piece.labels.push_back(v);
    piece.labels = closed_labels(around.matrix, piece.labels);
    return piece;
}

/// Right eigenvectors that belong to two left ones; empty where they do not pair up (defective eigenvalues).
MatrixXd dual_vectors(const MatrixXd& block, const MatrixXd& left, const double (&lambda)[2]) {
    const MatrixXd unit = MatrixXd::Identity(block.rows(), block.cols());
    MatrixXd right = null_space(MatrixXd(block - lambda[0] * unit));
    if (std::abs(lambda[0] - lambda[1]) > kEqual) {
        const MatrixXd second = null_space(MatrixXd(block - lambda[1] * unit));
        right.conservativeResize(right.rows(), right.cols() + second.cols());
        right.rightCols(second.cols()) = second;
    }
    const MatrixXd pairing = left.transpose() * right;
    if (pairing.cols() != 2 || std::abs(pairing.determinant()) < 1e-9) return {};
    return right * pairing.inverse();
}

/// The largest modulus beside 1 and two others, each once.
double third_of(std::vector<Complex> eigenvalues, const double (&lambda)[2]) {
    for (const double known : {1.0, lambda[0], lambda[1]})
        eigenvalues.erase(std::min_element(eigenvalues.begin(), eigenvalues.end(), [&](Complex a, Complex b) {
            return std::abs(a - known) < std::abs(b - known);
        }));
    double third = 0;
    for (const Complex value : eigenvalues) third = std::max(third, std::abs(value));
    return third;
}

void analyze_piece(const SubdivisionScheme& scheme, const AnalysisOptions& options, const Neighborhood& around,
                   SchemeAnalysis& out) {
    const Piece piece = piece_of(options, around);
    const MatrixXd block = block_of(around.matrix, piece.labels);
    out.frequencies.push_back({0, sorted_eigenvalues(block)});
    const std::vector<Complex>& eigenvalues = out.frequencies[0].eigenvalues;
    if (!piece.tangents) {
        out.lambda = std::abs(eigenvalues[1]);
        out.lambda_cross = std::abs(eigenvalues[2]);
        out.third = std::abs(eigenvalues[3]);
        return;
    }
    MatrixXd left(block.rows(), 2);
    left.col(0) = piece.tangents->first(piece.labels);
    left.col(1) = piece.tangents->second(piece.labels);
    double lambda[2];
    for (int i = 0; i < 2; ++i) lambda[i] = left.col(i).dot(block.transpose() * left.col(i)) / left.col(i).squaredNorm();
    out.lambda = lambda[0];
    out.lambda_cross = lambda[1];
    out.third = third_of(eigenvalues, lambda);
    const MatrixXd right = dual_vectors(block, left, lambda);
    if (right.cols() == 2) {
        auto extend = [&](int i) {
            const VectorXcd inner = scatter(right.col(i), piece.labels, around.patch.size()).cast<Complex>();
            return extend_map(around.chain, inner, lambda[i]);
        };
        VectorXcd z = extend(0) + Complex(0, 1) * extend(1);
        for (uint32_t v = 0; v < around.patch.size(); ++v)
            if (!piece.has(v)) z[v] = 0;
        draw_map(scheme, piece.patch, options.rings, z, out);
    }
    out.continuity = classify(out, true);
}

Result<void> check_options(const SubdivisionScheme& scheme, const AnalysisOptions& options) {
    auto invalid = [](const char* why) { return Error{ErrorCode::invalid_argument, why}; };
    if (options.valence < (options.boundary ? 1u : 3u) || options.valence > 64)
        return invalid("a valence is 3 to 64, of a boundary 1 to 64 faces");
    if (options.rings < 1 || options.rings > 6) return invalid("a characteristic map has 1 to 6 rings");
    if (options.boundary + (options.crease != 0) + options.dart > 1)
        return invalid("a vertex is on a boundary, on a crease or at its end");
    if (options.crease >= options.valence) return invalid("a crease has faces on both of its sides");
    if (options.boundary && scheme.dual)
        return Error{ErrorCode::unsupported, "boundary vertices of a dual scheme turn into faces inside"};
    if ((options.crease != 0 || options.dart) && scheme.creases == CreaseRules::none)
        return Error{ErrorCode::unsupported, "this scheme has no rules for creases"};
    return {};
}

}  // namespace

Result<SchemeAnalysis> analyze_scheme(const SubdivisionScheme& scheme, const AnalysisOptions& options) {
    if (auto ok = check_options(scheme, options); !ok) return ok.error();
    const auto around = find_neighborhood(scheme, options);
    if (!around) return around.error();
    SchemeAnalysis out;
    out.steps = static_cast<uint32_t>(around->chain.cycle_size());
    if (options.boundary || options.crease != 0 || options.dart)
        analyze_piece(scheme, options, *around, out);
    else
        analyze_interior(scheme, options, *around, out);
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
