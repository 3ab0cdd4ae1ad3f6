#include "shapes/shapes.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numeric>

namespace limn::test {
namespace {

// A number in [-1, 1) that depends on all three arguments and on nothing else.
double noise(uint64_t seed, uint64_t a, uint64_t b) {
    uint64_t z = seed * 0x9e3779b97f4a7c15u + a * 0xbf58476d1ce4e5b9u + b * 0x94d049bb133111ebu;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    z ^= z >> 31;
    return static_cast<double>(z >> 11) * 0x1p-52 - 1.0;
}

uint32_t find_root(std::vector<uint32_t>& parents, uint32_t i) {
    while (parents[i] != i) i = parents[i] = parents[parents[i]];
    return i;
}

}  // namespace

double TestMesh::size() const {
    double size = 0;
    for (size_t axis = 0; axis < 3 && vertex_count > 0; ++axis) {
        double low = positions[axis], high = low;
        for (size_t v = 0; v < vertex_count; ++v) {
            low = std::min<double>(low, positions[3 * v + axis]);
            high = std::max<double>(high, positions[3 * v + axis]);
        }
        size = std::max(size, high - low);
    }
    return size;
}

float TestMesh::max_finite_sharpness() const {
    float result = 0;
    for (float s : crease_sharpness) result = is_infinite(s) ? result : std::max(result, s);
    for (float s : corner_sharpness) result = is_infinite(s) ? result : std::max(result, s);
    return result;
}

ControlMeshDescription TestMesh::description() const {
    channel_views_.clear();
    for (const TestChannel& channel : channels) {
        channel_views_.push_back({channel.value_count, channel.face_values, channel.interpolation});
    }
    ControlMeshDescription result;
    result.options = options;
    result.vertex_count = vertex_count;
    result.face_sizes = face_sizes;
    result.face_vertices = face_vertices;
    result.crease_vertices = creases;
    result.crease_sharpness = crease_sharpness;
    result.corner_vertices = corners;
    result.corner_sharpness = corner_sharpness;
    result.holes = holes;
    result.channels = channel_views_;
    result.positions = positions;
    result.left_handed = left_handed;
    return result;
}

uint32_t TestMesh::add_vertex(double x, double y, double z) {
    for (double value : {x, y, z}) positions.push_back(static_cast<float>(value));
    return vertex_count++;
}

void TestMesh::add_face(std::initializer_list<uint32_t> vertices) {
    add_face(std::vector<uint32_t>(vertices));
}

void TestMesh::add_face(const std::vector<uint32_t>& vertices) {
    face_sizes.push_back(static_cast<uint32_t>(vertices.size()));
    face_vertices.insert(face_vertices.end(), vertices.begin(), vertices.end());
}

void TestMesh::add_crease(uint32_t a, uint32_t b, double sharpness) {
    creases.push_back(a);
    creases.push_back(b);
    crease_sharpness.push_back(static_cast<float>(sharpness));
}

void TestMesh::add_crease_path(const std::vector<uint32_t>& path, double sharpness) {
    for (size_t i = 0; i + 1 < path.size(); ++i) add_crease(path[i], path[i + 1], sharpness);
}

void TestMesh::add_corner(uint32_t vertex, double sharpness) {
    corners.push_back(vertex);
    corner_sharpness.push_back(static_cast<float>(sharpness));
}

bool TestMesh::has_edge(uint32_t a, uint32_t b) const {
    size_t begin = 0;
    for (uint32_t size : face_sizes) {
        for (uint32_t c = 0; c < size; ++c) {
            const uint32_t p = face_vertices[begin + c], q = face_vertices[begin + (c + 1) % size];
            if ((p == a && q == b) || (p == b && q == a)) return true;
        }
        begin += size;
    }
    return false;
}

void TestMesh::perturb(double amount, uint64_t seed) {
    for (size_t i = 0; i < positions.size(); ++i) {
        positions[i] += static_cast<float>(amount * noise(seed, i / 3, i % 3));
    }
}

void TestMesh::triangulate() {
    std::vector<uint32_t> sizes, vertices;
    size_t begin = 0;
    for (uint32_t size : face_sizes) {
        for (uint32_t c = 1; c + 1 < size; ++c) {
            sizes.push_back(3);
            vertices.insert(vertices.end(),
                            {face_vertices[begin], face_vertices[begin + c], face_vertices[begin + c + 1]});
        }
        begin += size;
    }
    face_sizes = sizes;
    face_vertices = vertices;
}

void add_channel(TestMesh& mesh, FaceVaryingInterpolation interpolation, const SeamPredicate& is_seam) {
    const uint32_t corner_count = static_cast<uint32_t>(mesh.face_vertices.size());
    std::vector<uint32_t> parents(corner_count);
    std::iota(parents.begin(), parents.end(), 0u);
    // The corners at the lower and the higher end of every edge, one entry for each face beside it.
    std::map<std::pair<uint32_t, uint32_t>, std::vector<std::pair<uint32_t, uint32_t>>> edges;
    uint32_t begin = 0;
    for (uint32_t size : mesh.face_sizes) {
        for (uint32_t c = 0; c < size; ++c) {
            uint32_t p = begin + c, q = begin + (c + 1) % size;
            if (mesh.face_vertices[p] > mesh.face_vertices[q]) std::swap(p, q);
            edges[{mesh.face_vertices[p], mesh.face_vertices[q]}].push_back({p, q});
        }
        begin += size;
    }
    for (const auto& [edge, ends] : edges) {
        if (is_seam(edge.first, edge.second)) continue;
        for (const auto& [low, high] : ends) {
            parents[find_root(parents, low)] = find_root(parents, ends[0].first);
            parents[find_root(parents, high)] = find_root(parents, ends[0].second);
        }
    }
    TestChannel channel;
    channel.interpolation = interpolation;
    channel.face_values.resize(corner_count);
    std::map<uint32_t, uint32_t> value_of_root;
    for (uint32_t c = 0; c < corner_count; ++c) {
        const auto [entry, is_new] = value_of_root.insert({find_root(parents, c), channel.value_count});
        if (is_new) {
            const size_t v = mesh.face_vertices[c];
            const uint64_t id = channel.value_count++;
            for (size_t axis = 0; axis < 2; ++axis) {
                channel.values.push_back(mesh.positions[3 * v + axis] +
                                         static_cast<float>(0.2 * noise(7, id, axis)));
            }
        }
        channel.face_values[c] = entry->second;
    }
    mesh.channels.push_back(std::move(channel));
}

void add_channel_by_region(TestMesh& mesh, FaceVaryingInterpolation interpolation,
                           const std::vector<uint32_t>& regions) {
    std::map<std::pair<uint32_t, uint32_t>, std::pair<uint32_t, bool>> edges;  // first region, regions differ
    uint32_t begin = 0;
    for (size_t f = 0; f < mesh.face_sizes.size(); ++f) {
        const uint32_t size = mesh.face_sizes[f];
        for (uint32_t c = 0; c < size; ++c) {
            const uint32_t a = mesh.face_vertices[begin + c], b = mesh.face_vertices[begin + (c + 1) % size];
            const auto [entry, is_new] = edges.insert({std::minmax(a, b), {regions[f], false}});
            if (!is_new && entry->second.first != regions[f]) entry->second.second = true;
        }
        begin += size;
    }
    add_channel(mesh, interpolation,
                [&](uint32_t a, uint32_t b) { return edges.at(std::minmax(a, b)).second; });
}

std::vector<uint32_t> append(TestMesh& mesh, const TestMesh& other,
                             const std::vector<std::pair<uint32_t, uint32_t>>& shared) {
    std::vector<uint32_t> map(other.vertex_count, ~0u);
    for (const auto& [theirs, ours] : shared) map[theirs] = ours;
    for (uint32_t v = 0; v < other.vertex_count; ++v) {
        if (map[v] != ~0u) continue;
        map[v] =
            mesh.add_vertex(other.positions[3 * v], other.positions[3 * v + 1], other.positions[3 * v + 2]);
    }
    mesh.face_sizes.insert(mesh.face_sizes.end(), other.face_sizes.begin(), other.face_sizes.end());
    for (uint32_t v : other.face_vertices) mesh.face_vertices.push_back(map[v]);
    return map;
}

std::vector<TestMesh> all_shapes() {
    std::vector<TestMesh> result;
    for (auto& part : {bilinear_shapes(), catmull_clark_shapes(), catmull_clark_odd_shapes(), loop_shapes(),
                       face_varying_shapes()}) {
        result.insert(result.end(), part.begin(), part.end());
    }
    return result;
}

std::vector<std::vector<TestMesh>> shapes_by_options() {
    std::vector<std::vector<TestMesh>> result;
    for (const TestMesh& shape : all_shapes()) {
        auto at = std::find_if(result.begin(), result.end(),
                               [&](const auto& alike) { return alike[0].options == shape.options; });
        if (at == result.end()) at = result.emplace(result.end());
        at->push_back(shape);
    }
    return result;
}

std::vector<TestMesh> shapes_of(Scheme scheme) {
    std::vector<TestMesh> result = all_shapes();
    std::erase_if(result, [&](const TestMesh& mesh) { return mesh.options.scheme != scheme; });
    return result;
}

const char* name_of(Scheme scheme) {
    switch (scheme) {
        case Scheme::catmull_clark:
            return "catmark";
        case Scheme::loop:
            return "loop";
        case Scheme::bilinear:
            return "bilinear";
        case Scheme::doo_sabin:
            return "doo_sabin";
    }
    return "";
}

const char* name_of(BoundaryInterpolation boundary) {
    switch (boundary) {
        case BoundaryInterpolation::none:
            return "edge_none";
        case BoundaryInterpolation::edge_only:
            return "edge_only";
        case BoundaryInterpolation::edge_and_corner:
            return "edge_corner";
    }
    return "";
}

const char* name_of(CreasingMethod creasing) {
    return creasing == CreasingMethod::uniform ? "uniform" : "chaikin";
}

const char* name_of(FaceVaryingInterpolation interpolation) {
    switch (interpolation) {
        case FaceVaryingInterpolation::none:
            return "none";
        case FaceVaryingInterpolation::corners_only:
            return "corners_only";
        case FaceVaryingInterpolation::corners_plus1:
            return "corners_plus1";
        case FaceVaryingInterpolation::corners_plus2:
            return "corners_plus2";
        case FaceVaryingInterpolation::boundaries:
            return "boundaries";
        case FaceVaryingInterpolation::all:
            return "all";
    }
    return "";
}

std::string name_of_number(double number) {
    char text[32];
    std::snprintf(text, sizeof(text), "%g", number);
    std::string result = text;
    std::replace(result.begin(), result.end(), '.', 'p');
    return result;
}

}  // namespace limn::test
