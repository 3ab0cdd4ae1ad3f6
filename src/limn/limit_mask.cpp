// Limit masks: left eigenvectors of the subdivision matrix around a vertex, for eigenvalue 1 (position) and
// for the subdominant ones (tangents). The crease and dart masks are those of the rules that limn refines
// with, which are not the ones that OpenSubdiv evaluates (options.opensubdiv_compatible gives its masks).
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "limn/scheme.h"

namespace limn {
namespace {

using std::numbers::pi;

void clear(LimitMask& mask) {
    mask.vertex = 0;
    std::fill(mask.edge.begin(), mask.edge.end(), 0.0);
    std::fill(mask.face.begin(), mask.face.end(), 0.0);
}

/// Subdominant eigenvalue of Catmull-Clark for frequency cosine c.
double catmull_clark_lambda(double c) {
    return (5 + c + std::sqrt((c + 9) * (c + 1))) / 16;
}

/// Weight of the face vertices between two edge neighbours whose weights are sin or cos of successive angles.
double catmull_clark_face_factor(double lambda) {
    return 1 / (16 * lambda - 4);
}

void smooth_position(Scheme scheme, uint32_t n, LimitMask& mask) {
    const double valence = n;
    double edge = 0, face = 0;
    if (scheme == Scheme::catmull_clark) {
        face = 1 / (valence * (valence + 5));
        edge = 4 * face;
    } else {
        edge = 1 / (valence + 3 / (8 * smooth_vertex_mask(scheme, n).edge));
    }
    mask.vertex = 1 - valence * (edge + face);
    std::fill(mask.edge.begin(), mask.edge.end(), edge);
    if (face != 0) std::fill(mask.face.begin(), mask.face.end(), face);
}

/// An infinitely sharp edge ends at the vertex: that edge's point is its midpoint, all else is smooth. The
/// left eigenvector satisfies a constant-coefficient recurrence over the smooth edges with zero ends, hence
/// the powers of r.
void infinite_dart_position(Scheme scheme, uint32_t n, uint32_t sharp, LimitMask& mask) {
    const bool quads = scheme == Scheme::catmull_clark;
    const double valence = n, nn = valence * valence;
    const double trace = quads ? 7 : 5;
    const double r = (trace - std::sqrt(trace * trace - 4)) / 2;
    const double level = quads ? 4 / nn : 8.0 / 3.0 * smooth_vertex_mask(scheme, n).edge;
    std::vector<double> b(n + 1, 0.0);  // smooth edges only: b[0] and b[n] stay zero
    for (uint32_t i = 1; i < n; ++i)
        b[i] = level * (1 - (std::pow(r, i) + std::pow(r, n - i)) / (1 + std::pow(r, n)));
    double sum = 1, sharp_edge = 0;
    if (quads) {
        for (uint32_t i = 0; i < n; ++i) {
            const double c = 4.0 / 3.0 * (0.25 / nn + (b[i] + b[i + 1]) / 16);
            mask.face[(sharp + i) % n] = c;
            sum += c;
            if (i == 0 || i == n - 1) sharp_edge += c / 2;
        }
        sharp_edge += 2 * (1.5 / nn + (b[1] + b[n - 1]) / 16);
    } else {
        sharp_edge = 2 * (smooth_vertex_mask(scheme, n).edge + (b[1] + b[n - 1]) / 8);
    }
    b[0] = sharp_edge;
    for (uint32_t i = 0; i < n; ++i) {
        mask.edge[(sharp + i) % n] = b[i];
        sum += b[i];
    }
    mask.vertex = 1 / sum;
    for (double& w : mask.edge) w /= sum;
    for (double& w : mask.face) w /= sum;
}

/// Tangent along ring position `phase`: cos of the angle from there.
void smooth_tangent(Scheme scheme, uint32_t n, double phase, LimitMask& mask) {
    clear(mask);
    const double theta = 2 * pi / n;
    const double beta = catmull_clark_face_factor(catmull_clark_lambda(std::cos(theta)));
    for (uint32_t i = 0; i < n; ++i) {
        const double c0 = std::cos((i - phase) * theta), c1 = std::cos((i + 1 - phase) * theta);
        mask.edge[i] = c0;
        if (scheme == Scheme::catmull_clark) mask.face[i] = beta * (c0 + c1);
    }
}

/// One application of the transposed subdivision matrix around an infinitely sharp dart whose sharp edge is
/// edge 0.
struct RingWeights {
    double vertex;
    std::vector<double> edge, face;
};
RingWeights apply_dart_transposed(Scheme scheme, const RingWeights& l) {
    const auto n = static_cast<uint32_t>(l.edge.size());
    const bool quads = scheme == Scheme::catmull_clark;
    const VertexMask mask = smooth_vertex_mask(scheme, n);
    const double side = quads ? 1.0 / 16 : 1.0 / 8;
    RingWeights out{l.vertex * (mask.vertex + n * mask.face / 4), std::vector<double>(n, 0.0),
                    std::vector<double>(n, 0.0)};
    for (uint32_t i = 0; i < n; ++i) {
        const uint32_t next = (i + 1) % n, previous = (i + n - 1) % n;
        out.edge[i] += l.vertex * (mask.edge + mask.face / 2);
        if (i == 0) {
            out.vertex += l.edge[i] / 2;
            out.edge[i] += l.edge[i] / 2;
        } else {
            out.vertex += l.edge[i] * 0.375;
            out.edge[i] += l.edge[i] * 0.375;
            out.edge[next] += l.edge[i] * side;
            out.edge[previous] += l.edge[i] * side;
            if (quads) out.face[i] += l.edge[i] * side;
            if (quads) out.face[previous] += l.edge[i] * side;
        }
        if (!quads) continue;
        out.face[i] += l.vertex * mask.face / 4 + l.face[i] / 4;
        out.vertex += l.face[i] / 4;
        out.edge[i] += l.face[i] / 4;
        out.edge[next] += l.face[i] / 4;
    }
    return out;
}

/// Tangent towards the sharp edge of an infinitely sharp dart: the leading even left eigenvector after the
/// constant one. Power iteration; vectors that sum to zero are orthogonal to the constant right eigenvector
/// and stay so.
void infinite_dart_tangent(Scheme scheme, uint32_t n, uint32_t sharp, LimitMask& mask) {
    RingWeights l{0, std::vector<double>(n), std::vector<double>(n, 0.0)};
    for (uint32_t i = 0; i < n; ++i) l.edge[i] = std::cos(2 * pi * i / n);
    for (int iteration = 0; iteration < 4000; ++iteration) {
        RingWeights next = apply_dart_transposed(scheme, l);
        double sum = next.vertex, largest = std::abs(next.vertex), change = 0;
        for (uint32_t i = 0; i < n; ++i) {
            sum += next.edge[i] + next.face[i];
            largest = std::max({largest, std::abs(next.edge[i]), std::abs(next.face[i])});
        }
        next.vertex -= sum;  // removes what rounding added along the constant
        next.vertex /= largest;
        change = std::abs(next.vertex - l.vertex);
        for (uint32_t i = 0; i < n; ++i) {
            next.edge[i] /= largest;
            next.face[i] /= largest;
            change =
                std::max({change, std::abs(next.edge[i] - l.edge[i]), std::abs(next.face[i] - l.face[i])});
        }
        l = std::move(next);
        if (change < 1e-14) break;
    }
    mask.vertex = l.vertex;
    for (uint32_t i = 0; i < n; ++i) {
        mask.edge[(sharp + i) % n] = l.edge[i];
        if (scheme == Scheme::catmull_clark) mask.face[(sharp + i) % n] = l.face[i];
    }
}

/// Across a boundary or crease with k faces between its edges, from edge `first`: eigenvectors of the rules
/// above.
void cross_tangent(Scheme scheme, uint32_t first, uint32_t k, LimitMask& mask) {
    const bool quads = scheme == Scheme::catmull_clark;
    const auto edges = static_cast<uint32_t>(mask.edge.size());
    auto edge = [&](uint32_t i) -> double& { return mask.edge[(first + i) % edges]; };
    if (k == 1) {
        mask.vertex = -2;
        edge(0) = edge(1) = 1;
        return;
    }
    const double theta = pi / k, c = std::cos(theta), s = std::sin(theta), cotangent = (1 + c) / s;
    const double lambda = quads ? catmull_clark_lambda(c) : 0.375 + c / 4;
    const double beta = quads ? catmull_clark_face_factor(lambda) : 0;
    // (lambda - 1/2) d - l/8 = p;  -d + (lambda - 3/4) l = q
    const double p = quads ? s / 16 + beta * s / 4 : s / 8;
    const double q = quads ? cotangent * (0.375 + beta / 2) : 0.375 * cotangent;
    const double determinant = (lambda - 0.5) * (lambda - 0.75) - 0.125;
    const double d = (p * (lambda - 0.75) + q / 8) / determinant;
    mask.vertex = ((lambda - 0.5) * q + p) / determinant;
    edge(0) = edge(k) = d;
    for (uint32_t i = 1; i < k; ++i) edge(i) = std::sin(i * theta);
    if (!quads) return;
    const auto faces = static_cast<uint32_t>(mask.face.size());
    for (uint32_t i = 0; i < k; ++i)
        mask.face[(first + i) % faces] = beta * (std::sin(i * theta) + std::sin((i + 1) * theta));
}

/// OpenSubdiv's: the masks of Biermann, Levin and Zorin 2000 (Catmull-Clark) and of Hoppe et al. 1994 (Loop).
void opensubdiv_cross_tangent(Scheme scheme, uint32_t first, uint32_t k, LimitMask& mask) {
    const bool quads = scheme == Scheme::catmull_clark;
    if (k < (quads ? 3u : 4u)) return cross_tangent(scheme, first, k, mask);
    const double theta = pi / k, c = std::cos(theta), s = std::sin(theta);
    if (!quads) {
        mask.edge[first] = mask.edge[first + k] = -s;
        for (uint32_t i = 1; i < k; ++i) mask.edge[first + i] = 2 * (1 - c) * std::sin(i * theta);
        return;
    }
    const double r = (c + 1) / s;
    mask.vertex = 4 * r * (c - 1);
    mask.edge[first] = mask.edge[first + k] = -r * (1 + 2 * c);
    for (uint32_t i = 0; i < k; ++i) {
        if (i != 0) mask.edge[first + i] = 4 * std::sin(i * theta);
        mask.face[first + i] = std::sin(i * theta) + std::sin((i + 1) * theta);
    }
}

void edge_tangent(uint32_t i, LimitMask& mask) {
    mask.vertex = -1;
    mask.edge[i] = 1;
}

}  // namespace

void limit_position_mask(const SchemeOptions& options, const LimitStar& star, LimitMask& mask) {
    clear(mask);
    const bool compatible = options.opensubdiv_compatible;
    if (options.scheme == Scheme::bilinear || star.rule == VertexRule::corner || star.face_count == 0) {
        mask.vertex = 1;
    } else if (star.rule == VertexRule::crease) {
        mask.vertex = 2.0 / 3.0;
        mask.edge[star.sharp_edges[0]] = mask.edge[star.sharp_edges[1]] = 1.0 / 6.0;
    } else if (star.infinite_dart && !compatible) {
        infinite_dart_position(options.scheme, star.face_count, star.sharp_edges[0], mask);
    } else if (compatible && options.scheme == Scheme::catmull_clark && star.face_count == 2) {
        mask.vertex = 1;
    } else {
        smooth_position(options.scheme, star.face_count, mask);
    }
}

void limit_tangent_masks(const SchemeOptions& options, const LimitStar& star, LimitMask& tangent1,
                         LimitMask& tangent2) {
    clear(tangent1);
    clear(tangent2);
    const bool compatible = options.opensubdiv_compatible;
    const uint32_t n = star.face_count;
    if (star.edge_count < 2) return;  // a vertex without faces: no tangents
    if (options.scheme == Scheme::bilinear || star.rule == VertexRule::corner) {
        // The sector between the first two sharp edges; without such, the first face.
        const bool sector = star.sharp_edge_count >= 2 && !compatible && options.scheme != Scheme::bilinear;
        edge_tangent(sector ? star.sharp_edges[0] : 0, tangent1);
        edge_tangent(sector ? star.sharp_edges[1] : 1, tangent2);
    } else if (star.rule == VertexRule::crease) {
        tangent1.edge[star.sharp_edges[0]] += 0.5;
        tangent1.edge[star.sharp_edges[1]] -= 0.5;
        const uint32_t first = star.sharp_edges[0], k = star.sharp_edges[1] - first;
        if (k > n) return;
        if (compatible)
            opensubdiv_cross_tangent(options.scheme, first, k, tangent2);
        else
            cross_tangent(options.scheme, first, k, tangent2);
    } else if (star.infinite_dart && !compatible) {
        infinite_dart_tangent(options.scheme, n, star.sharp_edges[0], tangent1);
        smooth_tangent(options.scheme, n, star.sharp_edges[0] + 0.25 * n, tangent2);
    } else if (options.scheme == Scheme::catmull_clark && n == 2) {
        if (compatible) {
            edge_tangent(0, tangent1);
            edge_tangent(1, tangent2);
        } else {  // both eigenvalues are 1/4: the two edges, the two faces
            tangent1.edge[0] = tangent2.face[0] = 1;
            tangent1.edge[1] = tangent2.face[1] = -1;
        }
    } else {
        smooth_tangent(options.scheme, n, 0, tangent1);
        smooth_tangent(options.scheme, n,
                       compatible && options.scheme == Scheme::catmull_clark ? 1 : 0.25 * n, tangent2);
    }
}

}  // namespace limn
