#include "shapes/random_mesh.h"

#include <algorithm>
#include <map>
#include <set>

namespace limn::test {
namespace {

using Face = std::vector<uint32_t>;

std::vector<Face> faces_of(const TestMesh& mesh) {
    std::vector<Face> faces;
    size_t begin = 0;
    for (uint32_t size : mesh.face_sizes) {
        const auto first = mesh.face_vertices.begin() + static_cast<ptrdiff_t>(begin);
        faces.push_back(Face(first, first + static_cast<ptrdiff_t>(size)));
        begin += size;
    }
    return faces;
}

void set_faces(TestMesh& mesh, const std::vector<Face>& faces) {
    mesh.face_sizes.clear();
    mesh.face_vertices.clear();
    for (const Face& face : faces) mesh.add_face(face);
}

std::vector<std::pair<uint32_t, uint32_t>> edges_of(const TestMesh& mesh) {
    std::set<std::pair<uint32_t, uint32_t>> edges;
    for (const Face& face : faces_of(mesh)) {
        for (size_t c = 0; c < face.size(); ++c) {
            const uint32_t a = face[c], b = face[(c + 1) % face.size()];
            if (a != b) edges.insert({std::min(a, b), std::max(a, b)});
        }
    }
    return {edges.begin(), edges.end()};
}

TestMesh random_base(RandomNumbers& random) {
    switch (random.below(9)) {
        case 0:
            return make_grid(1 + random.below(6), 1 + random.below(6));
        case 1:
            return make_torus(3 + random.below(6), 3 + random.below(4));
        case 2:
            return make_quad_star(3 + random.below(7), 1 + random.below(2));
        case 3:
            return make_globe(3 + random.below(9), random.below(4));
        case 4:
            return make_prism(3 + random.below(6));
        case 5:
            return make_cube();
        case 6:
            return make_quad_half_star(1 + random.below(6), 1 + random.below(2));
        case 7:
            return random.chance(0.5) ? make_icosahedron() : make_octahedron();
        default:
            return make_pyramid(3 + random.below(4));
    }
}

// Joins two faces along an edge where each passes it once, in opposite directions, and they share nothing
// else.
bool merge_faces(std::vector<Face>& faces, size_t first, size_t second) {
    const Face &f = faces[first], &g = faces[second];
    size_t common = 0;
    for (uint32_t v : f) common += static_cast<size_t>(std::count(g.begin(), g.end(), v));
    if (common != 2) return false;
    for (size_t i = 0; i < f.size(); ++i) {
        for (size_t j = 0; j < g.size(); ++j) {
            if (f[i] != g[(j + 1) % g.size()] || f[(i + 1) % f.size()] != g[j]) continue;
            Face merged;
            for (size_t k = 1; k <= f.size(); ++k) merged.push_back(f[(i + k) % f.size()]);
            for (size_t k = 2; k < g.size(); ++k) merged.push_back(g[(j + k) % g.size()]);
            faces[first] = merged;
            faces.erase(faces.begin() + static_cast<ptrdiff_t>(second));
            return true;
        }
    }
    return false;
}

void change_faces(TestMesh& mesh, RandomNumbers& random) {
    std::vector<Face> faces = faces_of(mesh);
    const double split_chance = random.chance(0.4) ? 0.3 : 0.0;
    for (size_t f = faces.size(); f-- > 0;) {  // some polygons lose a triangle
        if (faces[f].size() < 4 || !random.chance(split_chance)) continue;
        faces.push_back({faces[f][0], faces[f][1], faces[f][2]});
        faces[f].erase(faces[f].begin() + 1);
    }
    if (random.chance(0.4)) {
        for (uint32_t i = random.below(6); i > 0 && faces.size() > 2; --i) {
            const uint32_t count = static_cast<uint32_t>(faces.size());
            const size_t a = random.below(count), b = random.below(count);
            if (a != b) merge_faces(faces, a, b);
        }
    }
    if (random.chance(0.4)) {  // holes in the mesh itself, and vertices that no face uses
        for (uint32_t i = 1 + random.below(4); i > 0 && faces.size() > 1; --i) {
            faces.erase(faces.begin() + random.below(static_cast<uint32_t>(faces.size())));
        }
    }
    set_faces(mesh, faces);
}

// Parts that no manifold has.
void break_mesh(TestMesh& mesh, RandomNumbers& random) {
    std::vector<Face> faces = faces_of(mesh);
    const uint32_t face_count = static_cast<uint32_t>(faces.size());
    if (random.chance(0.35)) {  // a face the other way round
        Face& face = faces[random.below(face_count)];
        std::reverse(face.begin() + 1, face.end());
    }
    if (random.chance(0.35)) {  // two vertices of different faces become one
        const uint32_t keep = random.below(mesh.vertex_count), drop = random.below(mesh.vertex_count);
        bool shares_face = false;
        for (const Face& face : faces) {
            shares_face |= std::count(face.begin(), face.end(), keep) > 0 &&
                           std::count(face.begin(), face.end(), drop) > 0;
        }
        for (Face& face : faces) {
            if (!shares_face) std::replace(face.begin(), face.end(), drop, keep);
        }
    }
    if (random.chance(0.15)) {  // an edge shrinks to a point: its faces repeat a vertex
        const Face& face = faces[random.below(face_count)];
        const uint32_t keep = face[0], drop = face[1];
        for (Face& other : faces) std::replace(other.begin(), other.end(), drop, keep);
    }
    set_faces(mesh, faces);
    for (uint32_t i = random.chance(0.4) ? 1 + random.below(3) : 0; i > 0; --i) {  // fins
        const auto edges = edges_of(mesh);
        if (edges.empty()) break;
        const auto [a, b] = edges[random.below(static_cast<uint32_t>(edges.size()))];
        const double x = random.uniform(-1, 1), y = random.uniform(-1, 1);
        const uint32_t c = mesh.add_vertex(x, y, 1.5);
        if (random.chance(0.5)) {
            mesh.add_face({a, b, c});
        } else {
            mesh.add_face({b, a, c, mesh.add_vertex(x + 0.4, y, 1.3)});
        }
    }
    if (random.chance(0.15)) append(mesh, make_cube(), {{0, random.below(mesh.vertex_count)}});
    if (random.chance(0.1)) {  // a second layer with the same vertices
        std::vector<Face> layers = faces_of(mesh);
        Face copy = layers[random.below(static_cast<uint32_t>(layers.size()))];
        if (random.chance(0.7)) std::reverse(copy.begin(), copy.end());
        mesh.add_face(copy);
    }
    if (random.chance(0.2)) mesh.add_vertex(0.5, 0.5, 2);
}

// Values that decay at different levels, the special ones often.
double random_sharpness(RandomNumbers& random) {
    switch (random.below(6)) {
        case 0:
            return 10;
        case 1:
            return 1 + random.below(3);
        case 2:
            return random.uniform(0.05, 1);
        default:
            return random.uniform(0.1, 4.5);
    }
}

void add_features(TestMesh& mesh, RandomNumbers& random) {
    const auto edges = edges_of(mesh);
    std::map<uint32_t, std::vector<uint32_t>> neighbours;
    for (const auto& [a, b] : edges) {
        neighbours[a].push_back(b);
        neighbours[b].push_back(a);
    }
    if (!edges.empty() && random.chance(0.75)) {
        for (uint32_t path = 1 + random.below(4); path > 0; --path) {
            auto [v, next] = edges[random.below(static_cast<uint32_t>(edges.size()))];
            double sharpness = random_sharpness(random);
            const bool varies = random.chance(0.5);
            for (uint32_t step = 1 + random.below(6); step > 0; --step) {
                mesh.add_crease(v, next, sharpness);
                const std::vector<uint32_t>& around = neighbours[next];
                v = std::exchange(next, around[random.below(static_cast<uint32_t>(around.size()))]);
                if (varies) sharpness = random_sharpness(random);
            }
        }
    }
    if (random.chance(0.5)) {
        for (uint32_t i = 1 + random.below(4); i > 0; --i) {
            mesh.add_corner(random.below(mesh.vertex_count), random_sharpness(random));
        }
    }
    if (random.chance(0.3)) {
        std::set<uint32_t> holes;
        for (uint32_t i = 1 + random.below(3); i > 0; --i) holes.insert(random.below(mesh.face_count()));
        mesh.holes.assign(holes.begin(), holes.end());
    }
}

void add_channels(TestMesh& mesh, RandomNumbers& random) {
    for (uint32_t count = random.below(3); count > 0; --count) {
        const auto interpolation = static_cast<FaceVaryingInterpolation>(random.below(6));
        if (random.chance(0.4)) {
            const uint32_t kinds = 1 + random.below(4);
            std::vector<uint32_t> regions(mesh.face_count());
            for (uint32_t& region : regions) region = random.below(kinds);
            add_channel_by_region(mesh, interpolation, regions);
        } else {
            const double seams = random.chance(0.3) ? 0 : random.uniform(0.02, 0.5);
            std::set<std::pair<uint32_t, uint32_t>> cut;
            for (const auto& edge : edges_of(mesh)) {
                if (random.chance(seams)) cut.insert(edge);
            }
            add_channel(mesh, interpolation, [&](uint32_t a, uint32_t b) { return cut.count({a, b}) > 0; });
        }
    }
}

}  // namespace

uint64_t RandomNumbers::next() {
    state_ += 0x9e3779b97f4a7c15u;
    uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

uint32_t RandomNumbers::below(uint32_t count) {
    return static_cast<uint32_t>((next() >> 32) * count >> 32);
}

double RandomNumbers::uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(next() >> 11) * 0x1p-53;
}

TestMesh random_mesh(uint64_t seed) {
    RandomNumbers random(seed);
    TestMesh mesh = random_base(random);
    const uint32_t scheme = random.below(8);
    change_faces(mesh, random);
    if (random.chance(0.35)) break_mesh(mesh, random);
    if (scheme < 3) mesh.triangulate();
    mesh.options.scheme = scheme < 3 ? Scheme::loop : scheme < 7 ? Scheme::catmull_clark : Scheme::bilinear;
    mesh.options.boundary = static_cast<BoundaryInterpolation>(random.below(3));
    mesh.options.creasing = static_cast<CreasingMethod>(random.below(2));
    mesh.options.triangles = static_cast<TriangleSubdivision>(random.below(2));
    mesh.left_handed = random.chance(0.15);
    mesh.perturb(0.15, seed);
    add_features(mesh, random);
    add_channels(mesh, random);
    mesh.name = "random_" + std::to_string(seed);
    return mesh;
}

TestMesh make_messy_torus(uint32_t around, uint32_t across, uint64_t seed) {
    TestMesh mesh = make_torus(around, across);
    const TestMesh quads = std::exchange(mesh, {});
    mesh.vertex_count = quads.vertex_count;
    mesh.positions = quads.positions;
    mesh.name = "messy_torus";
    RandomNumbers random(seed);
    auto vertex = [&](uint32_t i, uint32_t j) { return i % around * across + j % across; };
    for (uint32_t i = 0; i < around; ++i) {
        for (uint32_t j = 0; j < across; ++j) {
            const uint32_t a = vertex(i, j), b = vertex(i + 1, j), c = vertex(i + 1, j + 1),
                           d = vertex(i, j + 1);
            if (j + 1 < across && random.chance(0.06)) {
                mesh.add_face({a, b, c, vertex(i + 1, j + 2), vertex(i, j + 2), d});
                ++j;
            } else if (random.chance(0.55)) {
                mesh.add_face({a, b, c, d});
            } else if (random.chance(0.5)) {
                mesh.add_face({a, b, c});
                mesh.add_face({a, c, d});
            } else {
                mesh.add_face({a, b, d});
                mesh.add_face({b, c, d});
            }
        }
    }
    return mesh;
}

std::vector<TestMesh> doo_sabin_shapes() {
    std::vector<TestMesh> out = {make_cube(), make_torus(5, 4), make_prism(5), make_globe(7, 2), make_messy_torus(9, 7, 1)};
    for (TestMesh& mesh : out) {
        mesh.options.scheme = Scheme::doo_sabin;
        mesh.perturb(0.05);
    }
    return out;
}

}  // namespace limn::test
