// What implementations of the C interface share: objects, errors, structs that may grow. Not part of the
// public interface.
#pragma once

#include <algorithm>
#include <cstring>
#include <new>
#include <span>
#include <type_traits>
#include <vector>

#include "limn/c/limn.h"
#include "limn/grid_table.h"
#include "limn/patch_tree.h"
#include "limn/refined_grid.h"
#include "limn/tessellate.h"

struct limn_control_mesh {
    limn::ControlMesh value;
};
struct limn_plan_cache {
    limn::PlanCache value;
};
struct limn_build_control {
    limn::BuildControl value;
};
struct limn_patch_table {
    limn::PatchTable value;
};
struct limn_patch_trees {
    limn::PatchTreeTable value;
};
struct limn_tessellation_table {
    limn::TessellationTable value;
};
struct limn_grid_table {
    limn::GridTable value;
};
struct limn_stencil_table {
    limn::StencilTable value;
};
struct limn_refined_grid_table {
    limn::RefinedGridTable value;
};

namespace limn::c {

/// The code, and the rest where the caller wants to know.
limn_result report(const Error& error, limn_error* out);
inline limn_result report(const Result<void>& done, limn_error* out) {
    return done ? LIMN_SUCCESS : report(done.error(), out);
}

inline Error bad_argument(std::string message) {
    return {ErrorCode::invalid_argument, std::move(message)};
}

inline Error out_of_memory() {
    return {ErrorCode::out_of_memory, "memory is exhausted"};
}

/// A struct of the caller's, who may know less or more of it than this library: what he has no room for is
/// zero, what is not known here has to be. `first_bytes`: what the struct had to begin with.
template <class T>
Result<T> read_struct(const T* given, uint32_t first_bytes = sizeof(T)) {
    constexpr uint32_t kMost = 4096;  // a size beyond that was never set
    if (given == nullptr) return bad_argument("a struct is null");
    const uint32_t size = given->struct_size;
    if (size < first_bytes || size > kMost) return bad_argument("struct_size is not the size of the struct");
    T known = {};
    std::memcpy(&known, given, std::min<size_t>(size, sizeof(T)));
    const auto* bytes = reinterpret_cast<const unsigned char*>(given);
    if (size > sizeof(T) &&
        std::any_of(bytes + sizeof(T), bytes + size, [](unsigned char b) { return b != 0; }))
        return Error{ErrorCode::unsupported, "a struct asks for what this version of limn does not know"};
    return known;
}

/// The options given, or all zero where there are none.
template <class T>
Result<T> read_optional(const T* given) {
    return given != nullptr ? read_struct(given) : Result<T>(T{});
}

/// Whether there is room for all that is known.
template <class T>
Result<void> check_room(const T* info) {
    if (info == nullptr) return bad_argument("info is null");
    if (info->struct_size < sizeof(T) || info->struct_size > 4096)
        return bad_argument("struct_size is not the size of the struct");
    return {};
}

/// Fills as much of `info` as its struct_size says.
template <class T>
limn_result write_struct(T known, T* info, limn_error* error) {
    if (const auto room = check_room(info); !room) return report(room.error(), error);
    known.struct_size = info->struct_size;
    std::memcpy(info, &known, sizeof(known));
    return LIMN_SUCCESS;
}

/// Arrays and options as they are read; the first thing wrong stays.
struct Reader {
    Result<void> state = {};

    void fail(std::string message) {
        if (state) state = bad_argument(std::move(message));
    }
    template <class T>
    std::span<T> array(T* data, uint64_t count, const char* name) {
        if (count != 0 && data == nullptr) fail(std::string(name) + " is null");
        if (count > static_cast<size_t>(-1) / sizeof(T)) fail(std::string(name) + " is longer than memory");
        return state ? std::span<T>(data, static_cast<size_t>(count)) : std::span<T>();
    }
    /// At least `count` elements of `width`.
    template <class T>
    std::span<T> array(T* data, uint64_t given, uint64_t count, uint32_t width, const char* name) {
        if (given / width < count) fail(std::string(name) + " is too short");
        return array(data, given, name);
    }
    /// values[index]: C's numbers begin with the default.
    template <class Enum, size_t n>
    Enum choice(uint32_t index, const Enum (&values)[n], const char* name) {
        if (index >= n) fail(std::string("there is no such ") + name);
        return index < n ? values[index] : values[0];
    }
    void flags(uint32_t given, uint32_t known) {
        if ((given & ~known) != 0) fail("a flag is not known");
    }
};

/// What the object holds, or null where there is none.
template <class Object>
auto value_of(const Object* object) -> decltype(&object->value) {
    return object != nullptr ? &object->value : nullptr;
}

/// A part of something else as the object that holds such a part and nothing beside it.
template <class Object>
const Object* as_object(const decltype(Object::value)* part) {
    static_assert(std::is_standard_layout_v<Object> && sizeof(Object) == sizeof(*part));
    return reinterpret_cast<const Object*>(part);
}

/// Hands a result out as a new object.
template <class T, class Object>
limn_result give(Result<T> result, Object** out, limn_error* error) {
    if (!result) return report(result.error(), error);
    *out = new (std::nothrow) Object{std::move(*result)};
    return *out != nullptr ? LIMN_SUCCESS : report(out_of_memory(), error);
}

/// `make()` makes what the object holds.
template <class Object, class Make>
limn_result create(Object** out, limn_error* error, const Make& make) {
    if (out == nullptr) return report(bad_argument("there is no room for what is created: null"), error);
    *out = nullptr;
    return give(make(), out, error);
}

/// `out` refers to `channels`, and to arrays of the caller's.
Result<void> read_description(const limn_control_mesh_description* given, ControlMeshDescription& out,
                              std::vector<FaceVaryingDescription>& channels);
/// The defaults where there are none.
Result<PatchTableOptions> read_patch_table_options(const limn_patch_table_options* given);

inline constexpr RateMode kRateModes[] = {RateMode::uniform,     RateMode::per_edge,    RateMode::screen_length,
                                          RateMode::pixel_error, RateMode::chord_error, RateMode::distance};
inline constexpr TessellationSpacing kSpacings[] = {TessellationSpacing::integer, TessellationSpacing::power_of_two,
                                                    TessellationSpacing::fractional};

inline BuildControl* control_of(limn_build_control* control) {
    return control != nullptr ? &control->value : nullptr;
}

}  // namespace limn::c
