// What ControlMesh::create accepts, copies and refuses.
#include "limn/control_mesh.h"

#include <gtest/gtest.h>

#include <limits>

#include "shapes/shapes.h"

namespace limn::test {
namespace {

// Two quads side by side.
struct Input {
    std::vector<uint32_t> face_sizes = {4, 4}, face_vertices = {0, 1, 4, 3, 1, 2, 5, 4};
    std::vector<uint32_t> crease_sizes, crease_vertices, corner_vertices, holes;
    std::vector<float> crease_sharpness, corner_sharpness, positions;
    std::vector<FaceVaryingDescription> channels;
    ControlMeshDescription description;

    ControlMeshDescription& fill() {
        description.vertex_count = 6;
        description.face_sizes = face_sizes;
        description.face_vertices = face_vertices;
        description.crease_sizes = crease_sizes;
        description.crease_vertices = crease_vertices;
        description.crease_sharpness = crease_sharpness;
        description.corner_vertices = corner_vertices;
        description.corner_sharpness = corner_sharpness;
        description.holes = holes;
        description.channels = channels;
        description.positions = positions;
        return description;
    }
};

// The message must name the kind of element and its index, for a person to find it.
void expect_refusal(const ControlMeshDescription& description, ErrorCode code, uint64_t element,
                    const std::string& words) {
    const auto result = ControlMesh::create(description);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, code) << result.error().message;
    EXPECT_EQ(result.error().element, element) << result.error().message;
    EXPECT_NE(result.error().message.find(words), std::string::npos) << result.error().message;
    EXPECT_EQ(result.error().vk_result, 0);
}

TEST(ControlMesh, copies_what_it_is_given) {
    Input input;
    input.crease_sizes = {3, 2};
    input.crease_vertices = {0, 1, 2, 4, 5};
    input.crease_sharpness = {1.5f, 20.0f};
    input.corner_vertices = {3};
    input.corner_sharpness = {0.5f};
    input.holes = {1};
    const std::vector<uint32_t> values = {0, 1, 2, 3, 4, 5, 6, 7};
    input.channels = {{8, values, FaceVaryingInterpolation::corners_plus1}};
    const auto mesh = ControlMesh::create(input.fill());
    ASSERT_TRUE(mesh) << mesh.error().message;
    EXPECT_EQ(mesh->vertex_count, 6u);
    EXPECT_EQ(mesh->face_count(), 2u);
    EXPECT_EQ(mesh->face_offsets, (std::vector<uint32_t>{0, 4, 8}));
    EXPECT_EQ(mesh->face_vertices, input.face_vertices);
    EXPECT_EQ(mesh->crease_edges, (std::vector<uint32_t>{0, 1, 1, 2, 4, 5}));
    ASSERT_EQ(mesh->crease_sharpness.size(), 3u);
    EXPECT_EQ(mesh->crease_sharpness[0], 1.5f);
    EXPECT_EQ(mesh->crease_sharpness[1], 1.5f);
    EXPECT_TRUE(is_infinite(mesh->crease_sharpness[2]));
    EXPECT_EQ(mesh->corner_vertices, input.corner_vertices);
    EXPECT_EQ(mesh->corner_sharpness, input.corner_sharpness);
    EXPECT_EQ(mesh->holes, input.holes);
    ASSERT_EQ(mesh->channels.size(), 1u);
    EXPECT_EQ(mesh->channels[0].value_count, 8u);
    EXPECT_EQ(mesh->channels[0].face_values, values);
    EXPECT_EQ(mesh->channels[0].interpolation, FaceVaryingInterpolation::corners_plus1);
}

TEST(ControlMesh, accepts_every_shape) {
    for (const TestMesh& mesh : all_shapes()) {
        const auto result = ControlMesh::create(mesh.description());
        EXPECT_TRUE(result) << mesh.name << ": " << (result ? "" : result.error().message);
    }
}

TEST(ControlMesh, reverses_left_handed_faces_keeping_first_vertices) {
    Input input;
    const std::vector<uint32_t> values = {0, 1, 2, 3, 4, 5, 6, 7};
    input.channels = {{8, values, FaceVaryingInterpolation::all}};
    input.fill().left_handed = true;
    const auto mesh = ControlMesh::create(input.description);
    ASSERT_TRUE(mesh);
    EXPECT_EQ(mesh->face_vertices, (std::vector<uint32_t>{0, 3, 4, 1, 1, 4, 5, 2}));
    EXPECT_EQ(mesh->channels[0].face_values, (std::vector<uint32_t>{0, 3, 2, 1, 4, 7, 6, 5}));
}

TEST(ControlMesh, a_later_crease_replaces_an_earlier_one) {
    TestMesh mesh = make_grid(2, 2), other = mesh;
    mesh.add_crease(3, 4, 2);
    mesh.add_crease(4, 3, 0.5);
    other.add_crease(3, 4, 0.5);
    // Both are the same surface: what counts is the topology that comes of it.
    const auto a = ControlMesh::create(mesh.description()), b = ControlMesh::create(other.description());
    ASSERT_TRUE(a && b);
    EXPECT_EQ(a->crease_sharpness.back(), 0.5f);
    EXPECT_EQ(b->crease_sharpness.back(), 0.5f);
}

TEST(ControlMesh, refuses_indices_out_of_range) {
    Input input;
    input.face_vertices[6] = 6;
    expect_refusal(input.fill(), ErrorCode::index_out_of_range, 1, "face 1");
    input = {};
    input.crease_vertices = {0, 1, 4, 6};
    input.crease_sharpness = {1, 1};
    expect_refusal(input.fill(), ErrorCode::index_out_of_range, 1, "crease 1");
    input = {};
    input.corner_vertices = {0, 1, ~0u};
    input.corner_sharpness = {1, 1, 1};
    expect_refusal(input.fill(), ErrorCode::index_out_of_range, 2, "corner 2");
    input = {};
    input.holes = {0, 2};
    expect_refusal(input.fill(), ErrorCode::index_out_of_range, 1, "hole 1");
    input = {};
    const std::vector<uint32_t> values = {0, 1, 2, 3, 4, 5, 6, 7};
    input.channels = {{8, values, FaceVaryingInterpolation::all}, {7, values, FaceVaryingInterpolation::all}};
    expect_refusal(input.fill(), ErrorCode::index_out_of_range, 1, "channel 1");
}

TEST(ControlMesh, refuses_faces_of_the_wrong_size) {
    Input input;
    input.face_sizes = {4, 2, 2};
    expect_refusal(input.fill(), ErrorCode::face_too_small, 1, "face 1");
    input.face_sizes = {0, 4, 4};
    expect_refusal(input.fill(), ErrorCode::face_too_small, 0, "face 0");
    input = {};
    input.face_sizes = {3, 4};
    input.face_vertices = {0, 1, 4, 1, 2, 5, 4};
    input.fill().options.scheme = Scheme::loop;
    expect_refusal(input.description, ErrorCode::not_a_triangle, 1, "face 1");
}

TEST(ControlMesh, refuses_sharpness_that_is_negative_or_not_a_number) {
    for (float wrong :
         {-0.5f, std::numeric_limits<float>::quiet_NaN(), -std::numeric_limits<float>::infinity()}) {
        Input input;
        input.crease_vertices = {0, 1, 1, 2};
        input.crease_sharpness = {1, wrong};
        expect_refusal(input.fill(), ErrorCode::invalid_sharpness, 1, "crease 1");
        input = {};
        input.corner_vertices = {3, 4};
        input.corner_sharpness = {0, wrong};
        expect_refusal(input.fill(), ErrorCode::invalid_sharpness, 1, "corner 1");
    }
    Input input;  // and takes positive infinity for what it says
    input.crease_vertices = {0, 1};
    input.crease_sharpness = {std::numeric_limits<float>::infinity()};
    EXPECT_TRUE(ControlMesh::create(input.fill()));
}

TEST(ControlMesh, refuses_creases_that_follow_no_edge) {
    Input input;
    input.crease_vertices = {0, 1, 0, 4};
    input.crease_sharpness = {1, 1};
    expect_refusal(input.fill(), ErrorCode::missing_edge, 1, "crease 1");
    input.crease_sizes = {4};
    input.crease_vertices = {0, 1, 4, 2};  // the last step is a diagonal
    input.crease_sharpness = {1};
    expect_refusal(input.fill(), ErrorCode::missing_edge, 0, "crease 0");
    input = {};
    input.crease_vertices = {2, 2};
    input.crease_sharpness = {1};
    expect_refusal(input.fill(), ErrorCode::missing_edge, 0, "crease 0");
}

TEST(ControlMesh, refuses_positions_that_are_not_finite) {
    for (float wrong : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        Input input;
        input.positions.assign(18, 0.5f);
        EXPECT_TRUE(ControlMesh::create(input.fill()));
        input.positions[13] = wrong;
        expect_refusal(input.fill(), ErrorCode::not_finite, 4, "vertex 4");
    }
}

TEST(ControlMesh, refuses_arrays_that_disagree) {
    Input input;
    input.face_vertices.pop_back();
    EXPECT_EQ(ControlMesh::create(input.fill()).error().code, ErrorCode::invalid_argument);
    input = {};
    input.face_vertices.push_back(0);
    EXPECT_EQ(ControlMesh::create(input.fill()).error().code, ErrorCode::invalid_argument);
    input = {};
    input.face_sizes.clear();
    input.face_vertices.clear();
    EXPECT_EQ(ControlMesh::create(input.fill()).error().code, ErrorCode::invalid_argument);
    input = {};
    input.crease_vertices = {0, 1, 2};
    input.crease_sharpness = {1};
    EXPECT_EQ(ControlMesh::create(input.fill()).error().code, ErrorCode::invalid_argument);
    input.crease_vertices = {0, 1};
    input.crease_sharpness = {1, 2};
    EXPECT_EQ(ControlMesh::create(input.fill()).error().code, ErrorCode::invalid_argument);
    input.crease_sizes = {1, 1};
    EXPECT_EQ(ControlMesh::create(input.fill()).error().code, ErrorCode::invalid_argument);
    input.crease_sizes = {3};
    input.crease_sharpness = {1};
    EXPECT_EQ(ControlMesh::create(input.fill()).error().code, ErrorCode::invalid_argument);
    input = {};
    input.corner_vertices = {0};
    EXPECT_EQ(ControlMesh::create(input.fill()).error().code, ErrorCode::invalid_argument);
    input = {};
    input.positions.assign(17, 0.0f);
    EXPECT_EQ(ControlMesh::create(input.fill()).error().code, ErrorCode::invalid_argument);
    input = {};
    const std::vector<uint32_t> values = {0, 0, 0};
    input.channels = {{1, values, FaceVaryingInterpolation::all}};
    EXPECT_EQ(ControlMesh::create(input.fill()).error().code, ErrorCode::invalid_argument);
}

TEST(ControlMesh, refuses_counts_that_do_not_fit) {
    Input input;
    input.fill().vertex_count = 0x80000000u;
    EXPECT_EQ(ControlMesh::create(input.description).error().code, ErrorCode::too_large);
    input = {};
    // Sizes that add up to more than 2^32: no product or sum may wrap around and look right again.
    input.face_sizes = {0xfffffffcu, 0xfffffffcu, 0x10u};
    const auto result = ControlMesh::create(input.fill());
    ASSERT_FALSE(result);
    EXPECT_TRUE(result.error().code == ErrorCode::too_large ||
                result.error().code == ErrorCode::invalid_argument);
    input = {};
    input.crease_sizes = {0xffffffffu, 3};
    input.crease_vertices = {0, 1};
    input.crease_sharpness = {1, 1};
    EXPECT_FALSE(ControlMesh::create(input.fill()));
}

}  // namespace
}  // namespace limn::test
