// The SPIR-V that was built lays shared structs out as C++ does.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "limn/shared/stencil_eval_params.h"

namespace {

/// The layout decorations of a SPIR-V module (SPIR-V 1.5, section 2.3: a header of 5 words, then instructions
/// whose first word holds their length and opcode).
struct Module {
    struct Member {
        std::string name;
        uint32_t offset = ~0u;
        uint32_t type = 0;
    };
    std::map<std::string, uint32_t> structs;                 // by name
    std::map<uint32_t, std::map<uint32_t, Member>> members;  // by struct, by index
    std::map<uint32_t, uint32_t> array_strides;              // by type
    std::map<uint32_t, std::string> names;
    uint32_t workgroup_size[3] = {};
    std::vector<uint32_t> bindings;  // of all variables
};

std::string read_string(const uint32_t* words, uint32_t count) {
    const char* const text = reinterpret_cast<const char*>(words);
    return {text, strnlen(text, count * 4)};
}

void read_instruction(Module& module, const uint32_t* words) {
    constexpr uint32_t kOpName = 5, kOpMemberName = 6, kOpExecutionMode = 16, kOpTypeStruct = 30,
                       kOpDecorate = 71, kOpMemberDecorate = 72, kLocalSize = 17, kArrayStride = 6,
                       kBinding = 33, kOffset = 35;
    const uint32_t count = words[0] >> 16;
    switch (words[0] & 0xffff) {
        case kOpName:
            module.names[words[1]] = read_string(words + 2, count - 2);
            break;
        case kOpMemberName:
            module.members[words[1]][words[2]].name = read_string(words + 3, count - 3);
            break;
        case kOpExecutionMode:
            if (words[2] == kLocalSize) std::copy(words + 3, words + 6, module.workgroup_size);
            break;
        case kOpTypeStruct:
            module.structs[module.names[words[1]]] = words[1];
            for (uint32_t i = 2; i < count; ++i) module.members[words[1]][i - 2].type = words[i];
            break;
        case kOpDecorate:
            if (words[2] == kArrayStride) module.array_strides[words[1]] = words[3];
            if (words[2] == kBinding) module.bindings.push_back(words[3]);
            break;
        case kOpMemberDecorate:
            if (words[3] == kOffset) module.members[words[1]][words[2]].offset = words[4];
            break;
        default:
            break;
    }
}

Module read_module(const std::string& kernel) {
    Module module;
    const std::string path = std::string(LIMN_SPIRV_DIR) + "/" + kernel + ".spv";
    std::ifstream file(path, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)), {});
    std::vector<uint32_t> words(bytes.size() / 4);
    std::memcpy(words.data(), bytes.data(), words.size() * 4);
    if (words.size() < 5 || words[0] != 0x07230203) {
        ADD_FAILURE() << path << " is not SPIR-V";
        return module;
    }
    EXPECT_EQ(words[1], 0x00010500u) << "not SPIR-V 1.5";
    for (size_t i = 5; i < words.size(); i += words[i] >> 16) {
        if (words[i] >> 16 == 0 || i + (words[i] >> 16) > words.size()) {
            ADD_FAILURE() << path << " is cut short";
            break;
        }
        read_instruction(module, words.data() + i);
    }
    return module;
}

struct Field {
    const char* name;
    size_t offset;
};

/// The members of a struct are `fields`, in this order and at these offsets.
void expect_layout(Module& module, const std::string& name, const std::vector<Field>& fields) {
    ASSERT_TRUE(module.structs.count(name)) << name << " is not in the module";
    const auto& members = module.members[module.structs[name]];
    ASSERT_EQ(members.size(), fields.size()) << name;
    for (uint32_t i = 0; i < fields.size(); ++i) {
        EXPECT_EQ(members.at(i).name, fields[i].name);
        EXPECT_EQ(members.at(i).offset, fields[i].offset) << name << "." << fields[i].name;
    }
}

class StencilEvalLayout : public testing::TestWithParam<const char*> {};

TEST_P(StencilEvalLayout, ParamsAreThoseOfCpp) {
    using limn::shared::StencilEvalParams;
    Module module = read_module(GetParam());
#define LIMN_FIELD(name) {#name, offsetof(StencilEvalParams, name)}
    expect_layout(
        module, "StencilEvalParams",
        {LIMN_FIELD(index_base), LIMN_FIELD(weight_base), LIMN_FIELD(row_base), LIMN_FIELD(pitch),
         LIMN_FIELD(pair_count), LIMN_FIELD(first_item), LIMN_FIELD(item_count), LIMN_FIELD(first_row),
         LIMN_FIELD(row_begin), LIMN_FIELD(row_end), LIMN_FIELD(source_base), LIMN_FIELD(source_stride),
         LIMN_FIELD(destination_base), LIMN_FIELD(destination_stride), LIMN_FIELD(weights)});
#undef LIMN_FIELD
    const uint32_t weights_type = module.members[module.structs["StencilEvalParams"]][14].type;
    EXPECT_EQ(module.array_strides[weights_type], sizeof(float));
    EXPECT_EQ(
        offsetof(StencilEvalParams, weights) + limn::shared::kStencilEvalMaxSharedWeights * sizeof(float),
        sizeof(StencilEvalParams));
    EXPECT_LE(sizeof(StencilEvalParams), 128u);
}

TEST_P(StencilEvalLayout, WorkgroupsAndBindingsAreThoseOfCpp) {
    Module module = read_module(GetParam());
    EXPECT_EQ(module.workgroup_size[0], limn::shared::kStencilEvalWorkgroupSize);
    EXPECT_EQ(module.workgroup_size[1], 1u);
    EXPECT_EQ(module.workgroup_size[2], 1u);
    std::sort(module.bindings.begin(), module.bindings.end());
    EXPECT_EQ(module.bindings, (std::vector<uint32_t>{limn::shared::kStencilEvalTableBinding,
                                                      limn::shared::kStencilEvalSourceBinding,
                                                      limn::shared::kStencilEvalDestinationBinding}));
}

INSTANTIATE_TEST_SUITE_P(Kernels, StencilEvalLayout,
                         testing::Values("stencil_eval", "stencil_eval_texel", "stencil_eval_texel_point"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
