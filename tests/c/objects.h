// What tests of the C interface share: objects that go by themselves, and calls with everything wrong that can be.
#pragma once

#include <gtest/gtest.h>

#include <tuple>
#include <type_traits>
#include <vector>

#include "limn/c/limn.h"

namespace limn::test {

/// Objects of the C interface, destroyed in reverse.
struct Objects {
    std::vector<std::pair<void*, void (*)(void*)>> all;

    template <auto destroy, class Object, class... Parameters, class... Args>
    Object* add(limn_result (*create)(Parameters...) noexcept, Args... args) {
        Object* object = nullptr;
        limn_error error = {};
        EXPECT_EQ(std::apply(create, std::tuple<Parameters...>(args..., &object, &error)), LIMN_SUCCESS)
            << error.message;
        all.push_back({object, [](void* o) { destroy(static_cast<Object*>(o)); }});
        return object;
    }
    void clear() {
        for (; !all.empty(); all.pop_back()) all.back().second(all.back().first);
    }
    ~Objects() { clear(); }
};
#define LIMN_NEW(objects, type, create, ...) (objects).add<type##_destroy, type>(create __VA_OPT__(, ) __VA_ARGS__)

template <class Info>
Info sized() {
    Info info = {};
    info.struct_size = sizeof(info);
    return info;
}

/// Calls `f` with null in place of each pointer that is not `optional` (a bit for each argument) but the last
/// one, and with wrong sizes of each struct. None of these succeeds, nor crashes.
template <class Before, class... Parameters, class... Args>
void sweep_after(const Before& before, limn_result (*f)(Parameters...) noexcept, uint32_t optional, Args... args) {
    const std::tuple<Parameters...> good(args...);
    const auto refused = [&](const std::tuple<Parameters...>& bad, size_t argument) {
        before();
        EXPECT_EQ(std::apply(f, bad), LIMN_ERROR_INVALID_ARGUMENT) << "argument " << argument;
    };
    const auto sweep_one = [&]<size_t i>(std::integral_constant<size_t, i>) {
        using Parameter = std::tuple_element_t<i, std::tuple<Parameters...>>;
        if constexpr (std::is_pointer_v<Parameter> && i + 1 < sizeof...(Parameters)) {
            auto bad = good;
            std::get<i>(bad) = nullptr;
            if ((optional >> i & 1) == 0) refused(bad, i);
            if constexpr (requires { std::get<i>(good)->struct_size; }) {
                auto changed = *std::get<i>(good);
                std::get<i>(bad) = &changed;
                for (const uint32_t size : {0u, 4u, static_cast<uint32_t>(sizeof(changed)) - 1, 4097u, ~0u}) {
                    changed.struct_size = size;
                    refused(bad, i);
                }
            }
        }
    };
    [&]<size_t... i>(std::index_sequence<i...>) {
        (sweep_one(std::integral_constant<size_t, i>()), ...);
    }
    (std::index_sequence_for<Parameters...>());
}

template <class... Parameters, class... Args>
void sweep(limn_result (*f)(Parameters...) noexcept, uint32_t optional, Args... args) {
    sweep_after([] {}, f, optional, args...);
}

/// Sweeps a function that creates an object; its arguments but for the object and the error.
#define LIMN_SWEEP(f, optional, type, ...)                              \
    {                                                                   \
        type* object_ = nullptr;                                        \
        limn_error error_ = {};                                         \
        limn::test::sweep(f, optional, __VA_ARGS__, &object_, &error_); \
        EXPECT_EQ(object_, nullptr);                                    \
    }

}  // namespace limn::test
