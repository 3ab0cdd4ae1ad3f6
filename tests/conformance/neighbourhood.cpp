#include "conformance/neighbourhood.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "conformance/osd_oracle.h"

namespace limn::test {

Neighbourhood refine_around(const Neighbourhood& parent) {
    std::string error;
    const auto oracle = OsdOracle::create(parent.mesh, 1, &error);
    EXPECT_TRUE(oracle) << error;
    if (!oracle) return parent;
    const std::vector<double> points = oracle->refine(parent.points, 3).back();
    const std::vector<uint32_t> sizes = oracle->face_sizes(1), vertices = oracle->face_vertices(1);
    std::vector<uint8_t> near(oracle->vertex_count(1), 0);
    near[0] = 1;
    std::vector<uint8_t> kept(sizes.size(), 0);
    for (int ring = 0; ring < 2; ++ring) {
        size_t begin = 0;
        for (size_t f = 0; f < sizes.size(); begin += sizes[f++]) {
            for (size_t c = begin; c < begin + sizes[f]; ++c) kept[f] |= near[vertices[c]];
        }
        begin = 0;
        for (size_t f = 0; f < sizes.size(); begin += sizes[f++]) {
            for (size_t c = begin; c < begin + sizes[f]; ++c) near[vertices[c]] |= kept[f];
        }
    }
    Neighbourhood child;
    child.mesh.options = parent.mesh.options;
    child.origin = parent.origin;
    child.unit = parent.unit;
    std::vector<uint32_t> map(near.size(), ~0u);
    for (size_t v = 0; v < near.size(); ++v) {
        if (!near[v]) continue;
        const Vector p = vector_at(points, v);
        map[v] = child.mesh.add_vertex(p[0], p[1], p[2]);
        child.points.insert(child.points.end(), p.begin(), p.end());
    }
    size_t begin = 0;
    for (size_t f = 0; f < sizes.size(); begin += sizes[f++]) {
        if (!kept[f]) continue;
        std::vector<uint32_t> face;
        for (size_t c = begin; c < begin + sizes[f]; ++c) face.push_back(map[vertices[c]]);
        child.mesh.add_face(face);
    }
    const std::vector<float> sharpness = oracle->edge_sharpness(1);
    const std::vector<uint32_t> ends = oracle->edge_vertices(1);
    for (size_t e = 0; e < sharpness.size(); ++e) {
        const uint32_t a = map[ends[2 * e]], b = map[ends[2 * e + 1]];
        if (sharpness[e] > 0 && a != ~0u && b != ~0u && child.mesh.has_edge(a, b)) {
            child.mesh.add_crease(a, b, static_cast<double>(sharpness[e]));
        }
    }
    const std::vector<float> corners = oracle->vertex_sharpness(1);
    for (size_t v = 0; v < near.size(); ++v) {
        if (corners[v] > 0 && map[v] != ~0u) child.mesh.add_corner(map[v], static_cast<double>(corners[v]));
    }
    // Keep numbers near one, so that differences of neighbours stay exact.
    const Vector shift = vector_at(child.points, 0);
    double largest = 0;
    for (size_t i = 0; i < child.points.size(); ++i) {
        child.points[i] -= shift[i % 3];
        largest = std::max(largest, std::abs(child.points[i]));
    }
    for (size_t i = 0; i < 3; ++i) child.origin[i] += child.unit * shift[i];
    for (double& x : child.points) x /= largest;
    child.unit *= largest;
    return child;
}

}  // namespace limn::test
