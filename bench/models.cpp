#include "models.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "limn/file.h"
#include "limn/obj.h"
#include "limn/topology.h"

namespace limn::bench {
namespace {

uint32_t add_vertex(Model& model, double x, double y, double z) {
    for (const double value : {x, y, z}) model.positions.push_back(static_cast<float>(value));
    return static_cast<uint32_t>(model.vertex_count() - 1);
}

void add_face(Model& model, const std::vector<uint32_t>& vertices) {
    model.face_sizes.push_back(static_cast<uint32_t>(vertices.size()));
    model.face_vertices.insert(model.face_vertices.end(), vertices.begin(), vertices.end());
}

/// An uneven torus of around x across vertices.
struct Torus {
    uint32_t around, across;
    uint32_t vertex(uint32_t i, uint32_t j) const { return (i % around) * across + j % across; }
    void add_vertices(Model& model) const {
        for (uint32_t i = 0; i < around; ++i)
            for (uint32_t j = 0; j < across; ++j) {
                const double u = 2 * std::numbers::pi * i / around, v = 2 * std::numbers::pi * j / across;
                const double tube = 0.4 + 0.03 * noise(vertex(i, j)), radius = 1 + tube * std::cos(v);
                add_vertex(model, radius * std::cos(u), radius * std::sin(u), tube * std::sin(v));
            }
    }
};

/// A closed chain around the tube.
struct Chain {
    uint32_t column;
    float sharpness;
};

/// Some quads get a smaller one inside, whose corners have valence 3, which makes their own corners valence 5.
template <class HasInset>
Model make_uneven_torus(const Torus& torus, const HasInset& has_inset) {
    Model model;
    torus.add_vertices(model);
    for (uint32_t i = 0; i < torus.around; ++i)
        for (uint32_t j = 0; j < torus.across; ++j) {
            const uint32_t outer[] = {torus.vertex(i, j), torus.vertex(i + 1, j), torus.vertex(i + 1, j + 1),
                                      torus.vertex(i, j + 1)};
            if (!has_inset(i * torus.across + j)) {
                add_face(model, {outer[0], outer[1], outer[2], outer[3]});
                continue;
            }
            uint32_t inner[4];
            for (uint32_t c = 0; c < 4; ++c) {
                double at[3];
                for (size_t axis = 0; axis < 3; ++axis) {
                    double centre = 0;
                    for (const uint32_t v : outer)
                        centre += 0.25 * static_cast<double>(model.positions[3 * v + axis]);
                    at[axis] =
                        0.55 * static_cast<double>(model.positions[3 * outer[c] + axis]) + 0.45 * centre;
                }
                inner[c] = add_vertex(model, at[0], at[1], at[2]);
            }
            add_face(model, {inner[0], inner[1], inner[2], inner[3]});
            for (uint32_t c = 0; c < 4; ++c)
                add_face(model, {outer[c], outer[(c + 1) % 4], inner[(c + 1) % 4], inner[c]});
        }
    return model;
}

template <class HasInset>
Model make_creased_torus(const Torus& torus, const HasInset& has_inset, const std::vector<Chain>& chains) {
    Model model = make_uneven_torus(torus, has_inset);
    for (const Chain& chain : chains) {
        for (uint32_t j = 0; j <= torus.across; ++j)
            model.crease_vertices.push_back(torus.vertex(chain.column, j));
        model.crease_sizes.push_back(torus.across + 1);
        model.crease_sharpness.push_back(chain.sharpness);
    }
    return model;
}

bool is_13th(uint32_t cell) {
    return cell % 13 == 0;
}

/// Every 13th quad has one inside; four chains: semi-sharp, beyond the level that is measured, and infinite.
Model make_creased_torus(const Torus& torus) {
    const float sharpness[] = {1.5f, 2.5f, 6.0f, kInfiniteSharpness};
    std::vector<Chain> chains;
    for (uint32_t c = 0; c < 4; ++c) chains.push_back({c * torus.around / 4, sharpness[c]});
    return make_creased_torus(torus, is_13th, chains);
}

/// A quad, or two triangles instead.
void add_cell(Model& model, const Torus& torus, uint32_t i, uint32_t j) {
    const uint32_t a = torus.vertex(i, j), b = torus.vertex(i + 1, j), c = torus.vertex(i + 1, j + 1),
                   d = torus.vertex(i, j + 1);
    const double choice = noise(a + 1'000'000);
    if (choice >= 0.24) return add_face(model, {a, b, c, d});
    const bool flip = choice < 0.12;
    add_face(model, {a, b, flip ? d : c});
    add_face(model, {flip ? b : a, c, d});
}

/// The vertices around width x height cells.
std::vector<uint32_t> border_of_cells(const Torus& torus, uint32_t i, uint32_t j, uint32_t width,
                                      uint32_t height) {
    std::vector<uint32_t> border;
    for (uint32_t k = 0; k < width; ++k) border.push_back(torus.vertex(i + k, j));
    for (uint32_t k = 0; k < height; ++k) border.push_back(torus.vertex(i + width, j + k));
    for (uint32_t k = 0; k < width; ++k) border.push_back(torus.vertex(i + width - k, j + height));
    for (uint32_t k = 0; k < height; ++k) border.push_back(torus.vertex(i, j + height - k));
    return border;
}

/// Twelve triangles around one vertex, in the place of 3 x 3 cells.
void add_fan(Model& model, const Torus& torus, uint32_t i, uint32_t j) {
    const uint32_t hub = torus.vertex(i + 1, j + 1);
    const uint32_t inner[4] = {hub, torus.vertex(i + 2, j + 1), torus.vertex(i + 2, j + 2),
                               torus.vertex(i + 1, j + 2)};
    for (size_t axis = 0; axis < 3; ++axis) {
        float sum = 0;
        for (const uint32_t v : inner) sum += model.positions[3 * v + axis];
        model.positions[3 * hub + axis] = sum / 4;
    }
    const std::vector<uint32_t> border = border_of_cells(torus, i, j, 3, 3);
    for (size_t k = 0; k < border.size(); ++k)
        add_face(model, {border[k], border[(k + 1) % border.size()], hub});
}

/// Fills 4 x 4 cells: a fan, an octagon, a hexagon or a pentagon, and cells beside it. The last row and
/// column are always cells, so that no vertex is left with two edges.
void add_messy_block(Model& model, const Torus& torus, uint32_t i, uint32_t j) {
    const double choice = noise(torus.vertex(i, j) + 2'000'000);
    uint32_t width = 2, height = 1;  // of what is not cells
    if (choice < 0.2) {
        add_fan(model, torus, i, j);
        width = height = 3;
    } else if (choice < 0.4) {
        add_face(model, border_of_cells(torus, i, j, 2, 2));
        height = 2;
    } else if (choice < 0.7) {
        add_face(model, border_of_cells(torus, i, j, 2, 1));
    } else {
        const uint32_t middle = torus.vertex(i + 1, j + 1), right = torus.vertex(i + 2, j);
        add_face(model, {torus.vertex(i, j), torus.vertex(i + 1, j), right, middle, torus.vertex(i, j + 1)});
        add_face(model, {right, torus.vertex(i + 2, j + 1), middle});
    }
    for (uint32_t k = 0; k < 4; ++k)
        for (uint32_t l = 0; l < 4; ++l)
            if (k >= width || l >= height) add_cell(model, torus, i + k, j + l);
}

void remove_unused_vertices(Model& model) {
    std::vector<uint32_t> next(model.vertex_count(), kInvalidIndex);
    for (const uint32_t v : model.face_vertices) next[v] = 0;
    uint32_t count = 0;
    for (uint32_t v = 0; v < next.size(); ++v) {
        if (next[v] == kInvalidIndex) continue;
        for (size_t axis = 0; axis < 3; ++axis)
            model.positions[3 * count + axis] = model.positions[3 * v + axis];
        next[v] = count++;
    }
    model.positions.resize(size_t{3} * count);
    for (uint32_t& v : model.face_vertices) v = next[v];
}

/// What production meshes can be at their worst: triangles, quads and larger faces, valences 3 to 12, hardly
/// a regular face. `torus`: multiples of 4.
Model make_messy_torus(const Torus& torus) {
    Model model;
    torus.add_vertices(model);
    for (uint32_t i = 0; i < torus.around; i += 4)
        for (uint32_t j = 0; j < torus.across; j += 4) add_messy_block(model, torus, i, j);
    remove_unused_vertices(model);
    return model;
}

BenchModel finish(const Options& options, std::string name, Model model) {
    Result<ControlMesh> mesh = ControlMesh::create(describe(model));
    if (!mesh) {
        Error error = mesh.error();
        error.message = name + ": " + error.message;
        fail(options, error);
    }
    mesh->channels.clear();  // which nothing that is measured evaluates, and which edits would have to be told of
    return {std::move(name), std::move(*mesh), std::move(model.positions)};
}

/// /meshes/rook.obj -> rook
std::string stem(const std::string& path) {
    const size_t slash = path.rfind('/'), begin = slash == std::string::npos ? 0 : slash + 1;
    const size_t dot = path.rfind('.');
    return printable(path.substr(begin, dot == std::string::npos || dot <= begin ? dot : dot - begin));
}

}  // namespace

double noise(uint64_t i) {
    i = (i + 1) * 0x9E3779B97F4A7C15u;
    i = (i ^ i >> 30) * 0xBF58476D1CE4E5B9u;
    i = (i ^ i >> 27) * 0x94D049BB133111EBu;
    return static_cast<double>(i >> 40) / static_cast<double>(1u << 24);
}

std::vector<BenchModel> load_models(const Options& options) {
    std::vector<BenchModel> models;
    for (const std::string& path : options.models) {
        std::string name = stem(path);
        while (std::any_of(models.begin(), models.end(), [&](const BenchModel& m) { return m.name == name; }))
            name += "_";  // names tell rows apart
        models.push_back(finish(options, name, value_or_fail(options, read_obj(path))));
    }
    if (!options.models.empty()) return models;
    models.push_back(finish(options, "torus_1k", make_creased_torus({48, 24})));
    if (options.quick) return models;
    models.push_back(finish(options, "torus_9k", make_creased_torus({120, 58})));
    models.push_back(finish(options, "messy_6k", make_messy_torus({84, 64})));
    return models;
}

BenchModel make_random_torus(uint32_t around, uint32_t across, uint64_t seed) {
    const float sharpness[] = {1, 1.5f, 2, 2.5f, 3, 4, 6, kInfiniteSharpness};
    const auto random = [&](uint64_t i) { return noise((seed << 32) + i); };
    std::vector<Chain> chains;
    for (uint32_t i = 0; i + 8 <= around; i += 8)
        chains.push_back({i + static_cast<uint32_t>(8 * random(2 * i)),
                          sharpness[static_cast<uint32_t>(8 * random(2 * i + 1))]});
    const auto has_inset = [&](uint32_t cell) { return 13 * random(cell + 1'000'000) < 1; };
    return finish({}, "torus", make_creased_torus(Torus{around, across}, has_inset, chains));
}

BenchModel make_quads(std::string name, uint32_t side) {
    Model model;
    for (uint32_t i = 0; i <= side; ++i)
        for (uint32_t j = 0; j <= side; ++j)
            add_vertex(model, i / 1000.0, j / 1000.0, 0.01 * noise(i * (side + 1) + j));
    for (uint32_t i = 0; i < side; ++i)
        for (uint32_t j = 0; j < side; ++j) {
            const uint32_t v = i * (side + 1) + j;
            add_face(model, {v, v + side + 1, v + side + 2, v + 1});
        }
    return finish({}, std::move(name), std::move(model));
}

BenchModel make_cube() {
    Model model;
    for (uint32_t i = 0; i < 8; ++i) add_vertex(model, i & 1, i >> 1 & 1, i >> 2);
    const uint32_t faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                  {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto& face : faces) add_face(model, {face[0], face[1], face[2], face[3]});
    return finish({}, "cube", std::move(model));
}

BenchModel make_smooth_torus(std::string name, uint32_t faces) {
    const double quads = faces * 13.0 / 17;  // every 13th becomes five
    const auto across = static_cast<uint32_t>(std::sqrt(quads / 2));
    const auto around = static_cast<uint32_t>(quads / across);
    return finish({}, std::move(name), make_uneven_torus(Torus{around, across}, is_13th));
}

}  // namespace limn::bench
