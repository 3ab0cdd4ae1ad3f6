#include "viewer/test_mesh.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <glm/geometric.hpp>

#include "limn/refinement.h"
#include "limn/stencil_table.h"

namespace limn::viewer::test {
namespace {

glm::vec3 vector_at(const std::vector<float>& values, size_t i) {
    return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
}

/// Where the line from `eye` along `direction` meets the triangle, as a distance; negative where it does not.
float hit(const glm::vec3& eye, const glm::vec3& direction, const glm::vec3& a, const glm::vec3& b,
          const glm::vec3& c) {
    const glm::vec3 ab = b - a, ac = c - a, p = glm::cross(direction, ac);
    const float det = glm::dot(ab, p);
    if (std::abs(det) < 1e-12f) return -1;
    const glm::vec3 q = eye - a, r = glm::cross(q, ab);
    const float u = glm::dot(q, p) / det, v = glm::dot(direction, r) / det;
    return u < 0 || v < 0 || u + v > 1 ? -1 : glm::dot(ac, r) / det;
}

vk::Buffer upload_words(const vk::Device& device, const std::vector<uint32_t>& words,
                        VkBufferUsageFlags more) {
    auto buffer = vk::create_buffer(device, words.size() * sizeof(uint32_t), vk::kPointUsage | more,
                                    vk::MemoryUse::device);
    if (buffer && vk::upload_bytes(device, *buffer, 0, std::as_bytes(std::span(words))))
        return std::move(*buffer);
    ADD_FAILURE() << "cannot upload";
    return {};
}

}  // namespace

uint32_t HostMesh::add_vertex(const glm::vec3& position, const glm::vec3& normal) {
    positions.push_back(position);
    normals.push_back(normal);
    return static_cast<uint32_t>(positions.size() - 1);
}

void HostMesh::add_triangle(uint32_t a, uint32_t b, uint32_t c) {
    indices.insert(indices.end(), {a, b, c});
}

Bounds HostMesh::bounds() const {
    Bounds bounds = {positions[0], positions[0]};
    for (const glm::vec3& position : positions) {
        bounds.low = glm::min(bounds.low, position);
        bounds.high = glm::max(bounds.high, position);
    }
    return bounds;
}

HostMesh refine_to_limit(const limn::test::TestMesh& shape, uint32_t level) {
    HostMesh out;
    const auto mesh = ControlMesh::create(shape.description());
    EXPECT_TRUE(mesh);
    const auto refinement = build_refinement(*mesh, {level, true});
    EXPECT_TRUE(refinement);
    const auto table = build_limit_table<float>(*refinement, level, true);
    EXPECT_TRUE(table);
    if (!table) return out;
    const auto apply = [&](const Array<float>* weights) {
        StencilTable rows;
        rows.source_count = table->source_count;
        rows.offsets = table->offsets;
        rows.indices = table->indices;
        rows.weights = weights != nullptr ? *weights : table->weights;
        std::vector<float> values(size_t{3} * table->row_count());
        apply_stencil_table<float>(rows, shape.positions, values, 3);
        return values;
    };
    const auto points = apply(nullptr), du = apply(&table->tangent1_weights),
               dv = apply(&table->tangent2_weights);
    for (size_t i = 0; i < points.size() / 3; ++i)
        out.add_vertex(vector_at(points, i), glm::normalize(glm::cross(vector_at(du, i), vector_at(dv, i))));
    const Topology& last = refinement->last();
    for (uint32_t f = 0; f < last.face_count; ++f) {
        const auto face = last.vertices_of_face(f);
        for (size_t c = 2; c < face.size(); ++c) out.add_triangle(face[0], face[c - 1], face[c]);
    }
    return out;
}

HostMesh make_sphere(uint32_t steps) {
    HostMesh out;
    const uint32_t around = 2 * steps;
    const auto add = [&](double polar, double azimuth) {
        const glm::vec3 p(std::sin(polar) * std::sin(azimuth), std::cos(polar),
                          std::sin(polar) * std::cos(azimuth));
        return out.add_vertex(p, p);
    };
    const uint32_t top = add(0, 0), bottom = add(M_PI, 0);
    for (uint32_t i = 1; i < steps; ++i)
        for (uint32_t j = 0; j < around; ++j) add(M_PI * i / steps, 2 * M_PI * j / around);
    const auto at = [&](uint32_t i, uint32_t j) { return 2 + (i - 1) * around + j % around; };
    for (uint32_t j = 0; j < around; ++j) {
        out.add_triangle(top, at(1, j), at(1, j + 1));
        out.add_triangle(bottom, at(steps - 1, j + 1), at(steps - 1, j));
        for (uint32_t i = 1; i + 1 < steps; ++i) {
            out.add_triangle(at(i, j), at(i + 1, j), at(i + 1, j + 1));
            out.add_triangle(at(i, j), at(i + 1, j + 1), at(i, j + 1));
        }
    }
    return out;
}

size_t find_triangle(const HostMesh& mesh, const glm::vec3& eye, const glm::vec3& target) {
    size_t found = mesh.triangle_count();
    float nearest = INFINITY;
    for (size_t t = 0; t < mesh.triangle_count(); ++t) {
        const uint32_t* i = mesh.indices.data() + 3 * t;
        const float at = hit(eye, glm::normalize(target - eye), mesh.positions[i[0]], mesh.positions[i[1]],
                             mesh.positions[i[2]]);
        if (at > 0 && at < nearest) nearest = at, found = t;
    }
    return found;
}

void cut_sliver(HostMesh& mesh, size_t triangle, float width) {
    const uint32_t a = mesh.indices[3 * triangle], b = mesh.indices[3 * triangle + 1],
                   c = mesh.indices[3 * triangle + 2];
    const glm::vec3 middle = 0.5f * (mesh.positions[a] + mesh.positions[b]);
    const glm::vec3 inwards = glm::normalize(mesh.positions[c] - middle);
    const uint32_t p = mesh.add_vertex(middle + width * inwards, mesh.normals[a]);
    mesh.indices[3 * triangle] = p;  // p b c
    mesh.add_triangle(p, c, a);
    mesh.add_triangle(a, b, p);
}

void pull_apart(HostMesh& mesh, size_t triangle, float width) {
    const glm::vec3 corners[] = {mesh.positions[mesh.indices[3 * triangle]],
                                 mesh.positions[mesh.indices[3 * triangle + 1]],
                                 mesh.positions[mesh.indices[3 * triangle + 2]]};
    // Edges move as far towards the middle of the inscribed circle.
    const float opposite[] = {glm::distance(corners[1], corners[2]), glm::distance(corners[2], corners[0]),
                              glm::distance(corners[0], corners[1])};
    const float around = opposite[0] + opposite[1] + opposite[2];
    const glm::vec3 middle =
        (opposite[0] * corners[0] + opposite[1] * corners[1] + opposite[2] * corners[2]) / around;
    const float radius = glm::length(glm::cross(corners[1] - corners[0], corners[2] - corners[0])) / around;
    for (size_t k = 0; k < 3; ++k) {
        uint32_t& index = mesh.indices[3 * triangle + k];
        index = mesh.add_vertex(glm::mix(corners[k], middle, width / radius), mesh.normals[index]);
    }
}

RenderMesh DeviceMesh::mesh() const {
    return {.vertices = vertices.handle,
            .indices = indices.handle,
            .indirect = indirect.handle,
            .places = places.handle,
            .triangle_faces = triangle_faces.handle,
            .face_rates = face_rates.handle};
}

DeviceMesh upload(const vk::Device& device, const HostMesh& mesh) {
    std::vector<uint32_t> vertices, places, faces, rates;
    for (size_t i = 0; i < mesh.positions.size(); ++i) {
        for (const glm::vec3& v : {mesh.positions[i], mesh.normals[i]})
            for (int k = 0; k < 3; ++k) vertices.push_back(std::bit_cast<uint32_t>(v[k]));
        const auto number = static_cast<uint32_t>(i);
        places.insert(places.end(), {number, 0, 0, number % 8 | number % 9 << 8});
    }
    for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
        faces.push_back(t);
        rates.push_back((1 + t % 64) | (1 + t % 64) << 16);
    }
    DeviceMesh out;
    out.vertices = upload_words(device, vertices, 0);
    out.indices = upload_words(device, mesh.indices, VK_BUFFER_USAGE_INDEX_BUFFER_BIT);
    out.indirect = upload_words(device, {static_cast<uint32_t>(mesh.indices.size()), 1, 0, 0, 0},
                                VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT);
    out.places = upload_words(device, places, 0);
    out.triangle_faces = upload_words(device, faces, 0);
    out.face_rates = upload_words(device, rates, 0);
    return out;
}

}  // namespace limn::viewer::test
