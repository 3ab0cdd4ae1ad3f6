// Structs of the C interface, field by field: nothing of them may move, nor be left out here.
#pragma once

#include <cstddef>
#include <initializer_list>

namespace limn::test {

struct Pin {
    size_t pinned, offset, size;
};

/// Fields where they were pinned, each where the one before it ends, and the last at the end of the struct: one that is not
/// in the list leaves a gap, since the structs have no padding that is not a field.
consteval bool is_laid_out(size_t size, size_t pinned_size, std::initializer_list<Pin> pins) {
    size_t end = 0;
    for (const Pin& pin : pins) {
        if (pin.offset != pin.pinned || pin.offset != end) return false;
        end += pin.size;
    }
    return end == size && size == pinned_size;
}
static_assert(is_laid_out(8, 8, {{0, 0, 4}, {4, 4, 4}}));
static_assert(!is_laid_out(8, 8, {{0, 0, 4}}) && !is_laid_out(8, 8, {{4, 4, 4}}) && !is_laid_out(8, 4, {{0, 0, 8}}));
static_assert(!is_laid_out(8, 8, {{4, 0, 4}, {0, 4, 4}}));

}  // namespace limn::test

#define LIMN_PIN_STRUCT(type, size, ...)                                                \
    namespace pins_of_##type {                                                          \
        using Pinned = type;                                                            \
        static_assert(limn::test::is_laid_out(sizeof(Pinned), size, {__VA_ARGS__}));    \
    }
#define LIMN_AT(member, at) {at, offsetof(Pinned, member), sizeof(Pinned::member)}
