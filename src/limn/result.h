// Errors as values. limn throws nothing: functions at a trust boundary (mesh creation, file reading, context,
// allocation) return Result<T>; everything else states its preconditions and asserts them.
#pragma once

#include <cassert>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>

namespace limn {

/// What went wrong. The message says where and why; the code is for programs.
enum class ErrorCode : uint8_t {
    invalid_argument,    ///< array lengths that do not agree, an option outside its range
    index_out_of_range,  ///< a vertex, face or value index past the end
    face_too_small,      ///< a face of fewer than 3 vertices
    invalid_sharpness,   ///< negative or NaN
    missing_edge,        ///< a crease along two vertices that no face joins
    not_a_triangle,      ///< the scheme takes triangles only
    not_finite,          ///< NaN or infinity where a number is needed
    too_large,           ///< a count that does not fit the index type
    out_of_memory,       ///< host or device memory
    cannot_open,         ///< a file that cannot be opened, read or written
    parse_error,         ///< a malformed file
    no_device,           ///< no usable Vulkan device
    vulkan_failure,      ///< a Vulkan call failed; Error::vk_result holds its VkResult
    unsupported,         ///< valid, but not supported here
    cancelled,           ///< a BuildControl stopped the build
};

inline constexpr uint64_t kNoElement = ~uint64_t{0};

/// `element` is the index of the offending element (face, vertex, crease, line ...; the message names the
/// kind) or kNoElement. `vk_result` is a VkResult, 0 unless the error came from Vulkan.
struct Error {
    ErrorCode code = ErrorCode::invalid_argument;
    std::string message;
    uint64_t element = kNoElement;
    int32_t vk_result = 0;
};

/// A value or an Error. Names follow std::expected so that it can become one.
template <class T>
class [[nodiscard]] Result {
  public:
    Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}
    Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}

    bool has_value() const { return state_.index() == 0; }
    explicit operator bool() const { return has_value(); }

    /// Precondition: has_value().
    T& value() & { return assert(has_value()), *std::get_if<0>(&state_); }
    const T& value() const& { return assert(has_value()), *std::get_if<0>(&state_); }
    T&& value() && { return assert(has_value()), std::move(*std::get_if<0>(&state_)); }
    T& operator*() & { return value(); }
    const T& operator*() const& { return value(); }
    T&& operator*() && { return std::move(*this).value(); }
    T* operator->() { return &value(); }
    const T* operator->() const { return &value(); }

    /// Precondition: !has_value().
    const Error& error() const { return assert(!has_value()), *std::get_if<1>(&state_); }

  private:
    std::variant<T, Error> state_;
};

/// Success or an Error, for functions with nothing to return.
template <>
class [[nodiscard]] Result<void> {
  public:
    Result() = default;
    Result(Error error) : error_(std::move(error)) {}
    bool has_value() const { return !error_; }
    explicit operator bool() const { return has_value(); }
    /// Precondition: !has_value().
    const Error& error() const { return assert(error_), *error_; }

  private:
    std::optional<Error> error_;
};

}  // namespace limn
