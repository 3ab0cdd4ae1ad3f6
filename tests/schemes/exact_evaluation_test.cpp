// Plans of the library against Stam's exact evaluation, which shares nothing with them, and both against
// values of record.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include "limn/evaluate.h"
#include "limn/patch_table.h"
#include "schemes/stam.h"
#include "shapes/random_mesh.h"

namespace limn::test {
namespace {

using Points = std::map<StarLabel, std::array<double, 3>>;
using Values = Eigen::Matrix<double, 6, 3>;

struct Place {
    double u, v;
};

/// Two rings around a vertex: face 0 is that between rays 0 and 1, its first corner the vertex.
struct Star {
    bool triangles;
    int valence;
    std::vector<StarLabel> labels;
    std::vector<uint32_t> face_sizes, face_vertices;

    Star(bool triangular, int n) : triangles(triangular), valence(n) {
        labels.push_back({0, 0, 0});
        for (int s = 0; s < n; ++s) {
            const int next = (s + 1) % n;
            if (triangles) {
                add_face({{0, 0, 0}, {s, 1, 0}, {next, 1, 0}});
                add_face({{s, 1, 0}, {s, 2, 0}, {s, 1, 1}});
                add_face({{s, 1, 0}, {s, 1, 1}, {next, 1, 0}});
                add_face({{next, 1, 0}, {s, 1, 1}, {next, 2, 0}});
            } else {
                add_face({{0, 0, 0}, {s, 1, 0}, {s, 1, 1}, {next, 1, 0}});
                add_face({{s, 1, 0}, {s, 2, 0}, {s, 2, 1}, {s, 1, 1}});
                add_face({{s, 1, 1}, {s, 2, 1}, {s, 2, 2}, {s, 1, 2}});
                add_face({{next, 1, 0}, {s, 1, 1}, {s, 1, 2}, {next, 2, 0}});
            }
        }
    }
    void add_face(std::initializer_list<StarLabel> corners) {
        for (const StarLabel& label : corners) {
            const auto found = std::find(labels.begin(), labels.end(), label);
            face_vertices.push_back(static_cast<uint32_t>(found - labels.begin()));
            if (found == labels.end()) labels.push_back(label);
        }
        face_sizes.push_back(static_cast<uint32_t>(corners.size()));
    }
    ControlMesh control_mesh() const {
        ControlMeshDescription description;
        description.options.scheme = triangles ? Scheme::loop : Scheme::catmull_clark;
        description.vertex_count = static_cast<uint32_t>(labels.size());
        description.face_sizes = face_sizes;
        description.face_vertices = face_vertices;
        auto control = ControlMesh::create(description);
        EXPECT_TRUE(control);
        return std::move(control).value();
    }
};

/// By the library.
std::vector<Values> evaluate_plans(const Star& star, const Points& points, const std::vector<Place>& places) {
    const auto table = build_patch_table<double>(star.control_mesh(), {});
    EXPECT_TRUE(table);
    std::vector<double> control;
    for (const StarLabel& label : star.labels)
        control.insert(control.end(), points.at(label).begin(), points.at(label).end());
    std::vector<double> all(size_t{table->point_count()} * 3), values(places.size() * 18);
    build_patch_points(*table, control, 3, all);
    std::vector<PatchSample> samples;
    for (const auto& [u, v] : places) samples.push_back({0, u, v});
    std::vector<SampleStatus> statuses(places.size());
    evaluate_patches(*table, samples, all, 3, Derivatives::second, values, statuses);
    std::vector<Values> out(places.size());
    for (size_t s = 0; s < places.size(); ++s) {
        EXPECT_EQ(statuses[s], SampleStatus::valid);
        for (int k = 0; k < 18; ++k) out[s](k / 3, k % 3) = values[s * 18 + static_cast<size_t>(k)];
    }
    return out;
}

Eigen::MatrixXd matrix_of(const StamEvaluator& stam, const Points& points) {
    Eigen::MatrixXd matrix(static_cast<Eigen::Index>(stam.labels().size()), 3);
    for (size_t k = 0; k < stam.labels().size(); ++k)
        for (size_t c = 0; c < 3; ++c)
            matrix(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(c)) =
                points.at(stam.labels()[k])[c];
    return matrix;
}

/// The largest difference of values, first and second derivatives.
std::array<double, 3> differences(const Values& a, const Values& b) {
    const Values d = (a - b).cwiseAbs();
    return {d.row(0).maxCoeff(), d.middleRows(1, 2).maxCoeff(), d.bottomRows(3).maxCoeff()};
}

Points random_points(const Star& star, uint64_t seed) {
    RandomNumbers random(seed);
    Points points;
    for (const StarLabel& label : star.labels)
        points[label] = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    return points;
}

/// Places of a face, edges, the far corner and places at which patches meet included.
std::vector<Place> places_of(bool triangles, double scale, uint64_t seed) {
    RandomNumbers random(seed);
    std::vector<Place> places = {{1, 0},     {0, 1},        {0.5, 0}, {0, 0.5},
                                 {0.5, 0.5}, {0.25, 0.125}, {0.3, 0}, {0, 0.7}};
    if (!triangles) places.insert(places.end(), {{1, 1}, {1, 0.37}, {0.5, 0.75}});
    for (int i = 0; i < 60; ++i) {
        double u = random.uniform(0, 1), v = random.uniform(0, 1);
        if (triangles && u + v > 1) {
            u = 1 - u;
            v = 1 - v;
        }
        places.push_back({u, v});
    }
    for (Place& place : places) {
        place.u *= scale;
        place.v *= scale;
    }
    return places;
}

TEST(ExactEvaluation, plans_equal_stams_evaluation) {
    for (const bool triangles : {false, true})
        for (int valence = 3; valence <= 12; ++valence) {
            const Star star(triangles, valence);
            const StamEvaluator stam(triangles, valence);
            ASSERT_EQ(stam.labels().size(), static_cast<size_t>(triangles ? valence + 6 : 2 * valence + 8));
            const Points points = random_points(star, static_cast<uint64_t>(valence));
            const Eigen::MatrixXd matrix = matrix_of(stam, points);
            for (const int depth : {0, 2, 5, 12}) {
                const double scale = std::exp2(-depth);
                const std::vector<Place> places =
                    places_of(triangles, scale, static_cast<uint64_t>(valence + depth));
                const std::vector<Values> ours = evaluate_plans(star, points, places);
                for (size_t s = 0; s < places.size(); ++s) {
                    const auto d = differences(ours[s], stam.evaluate(matrix, places[s].u, places[s].v));
                    // Rounding of refined points weighs 2^level times as much in each derivative.
                    const auto& [u, v] = places[s];
                    const double nearest = std::min(1.0, triangles ? u + v : std::max(u, v));
                    EXPECT_LE(d[0], 1e-12) << "valence " << valence << " at " << u << ", " << v;
                    EXPECT_LE(d[1], 1e-12 / nearest) << "valence " << valence << " at " << u << ", " << v;
                    EXPECT_LE(d[2], 1e-12 / (nearest * nearest))
                        << "valence " << valence << " at " << u << ", " << v;
                }
            }
        }
}

TEST(ExactEvaluation, eigenvectors_equal_powers) {
    for (const bool triangles : {false, true})
        for (int valence = 3; valence <= 12; ++valence) {
            const StamEvaluator stam(triangles, valence);
            if (triangles && valence == 3) {  // 1/16 is an eigenvalue of three, with two vectors
                EXPECT_GT(stam.condition(), 1e6);
                continue;
            }
            EXPECT_LT(stam.condition(), 1e4) << valence;
            const Eigen::MatrixXd matrix = matrix_of(stam, random_points(Star(triangles, valence), 5));
            for (const auto& [u, v] : places_of(triangles, 0.125, 3)) {
                const auto d = differences(stam.evaluate(matrix, u, v),
                                           stam.evaluate(matrix, u, v, StamMethod::eigenvectors));
                EXPECT_LE(d[0], 1e-12);
                EXPECT_LE(d[1], 1e-11);
                EXPECT_LE(d[2], 1e-10);
            }
        }
}

struct Record {
    bool triangles = false;
    int valence = 0;
    Points points;
    std::vector<Place> places;
    std::vector<Values> values;
};

std::vector<Record> read_records() {
    std::ifstream file(LIMN_EXACT_EVALUATION);
    EXPECT_TRUE(file) << LIMN_EXACT_EVALUATION;
    std::vector<Record> records;
    for (std::string word, rest; file >> word;) {
        if (word == "#") {
            std::getline(file, rest);
        } else if (word == "point") {
            StarLabel label;
            for (int& x : label) file >> x;
            for (double& x : records.back().points[label]) file >> x;
        } else if (word == "sample") {
            Record& record = records.back();
            file >> record.places.emplace_back().u >> record.places.back().v;
            record.values.emplace_back();
            for (int k = 0; k < 18; ++k) file >> record.values.back()(k / 3, k % 3);
        } else {
            records.emplace_back().triangles = word == "loop";
            file >> records.back().valence;
        }
    }
    return records;
}

TEST(ExactEvaluation, values_of_record) {
    const std::vector<Record> records = read_records();
    ASSERT_EQ(records.size(), 10u);
    for (const Record& record : records) {
        const StamEvaluator stam(record.triangles, record.valence);
        const Eigen::MatrixXd matrix = matrix_of(stam, record.points);
        const std::vector<Values> ours =
            evaluate_plans(Star(record.triangles, record.valence), record.points, record.places);
        ASSERT_GE(record.places.size(), 7u);
        for (size_t s = 0; s < record.places.size(); ++s) {
            for (const Values& values :
                 {ours[s], stam.evaluate(matrix, record.places[s].u, record.places[s].v)}) {
                const auto d = differences(values, record.values[s]);
                EXPECT_LE(d[0], 1e-14) << "valence " << record.valence << " sample " << s;
                EXPECT_LE(d[1], 2e-14) << "valence " << record.valence << " sample " << s;
                EXPECT_LE(d[2], 4e-13) << "valence " << record.valence << " sample " << s;
            }
        }
    }
}

}  // namespace
}  // namespace limn::test
