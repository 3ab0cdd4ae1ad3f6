// An array of plain values that, unlike std::vector, leaves new elements uninitialised: tables of hundreds of
// megabytes are written once, by many threads, and must not be touched before that. And one that may borrow its
// elements, so that tables can lie in a mapped file.
#pragma once

#include <cassert>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <span>
#include <type_traits>
#include <utility>
#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace limn {

template <class T>
class Array {
    static_assert(std::is_trivially_copyable_v<T>);

  public:
    Array() = default;
    Array(Array&& other) noexcept
        : data_(std::exchange(other.data_, nullptr)),
          size_(std::exchange(other.size_, 0)),
          capacity_(std::exchange(other.capacity_, 0)) {}
    Array& operator=(Array&& other) noexcept {
        std::swap(data_, other.data_);
        std::swap(size_, other.size_);
        std::swap(capacity_, other.capacity_);
        return *this;
    }
    Array(const Array& other) {
        allocate(other.size_);
        if (size_ != 0) std::memcpy(data_, other.data_, size_ * sizeof(T));
    }
    Array& operator=(const Array& other) {
        if (this != &other) *this = Array(other);
        return *this;
    }
    ~Array() { release(); }

    /// An array over memory that someone else keeps alive and that must not be written to. A copy of it owns its
    /// elements.
    static Array borrow(const T* data, size_t size) {
        Array out;
        if (size == 0) return out;
        out.data_ = const_cast<T*>(data);
        out.size_ = size;
        return out;
    }
    bool is_borrowed() const { return data_ != nullptr && capacity_ == 0; }

    /// Replaces the contents by `size` uninitialised elements; aborts when memory is exhausted, as operator
    /// new would in a build without exceptions. A small block is used again where it is large enough.
    void allocate(size_t size) {
        if (size <= capacity_ && capacity_ * sizeof(T) <= kReusedBytes) {
            size_ = size;
            return;
        }
        release();
        data_ = nullptr;
        size_ = capacity_ = 0;
        if (size == 0) return;
        if (size > static_cast<size_t>(-1) / sizeof(T)) std::abort();
        data_ = static_cast<T*>(allocate_bytes(size * sizeof(T)));
        if (data_ == nullptr) std::abort();
        size_ = capacity_ = size;
    }
    /// As allocate, but a block of any size is used again where it is large enough: true, with what it held. A larger one has room
    /// for a sixteenth more.
    bool reuse(size_t size) {
        const bool fits = size <= capacity_;
        if (!fits) allocate(capacity_ == 0 ? size : size + size / 16);
        size_ = size;
        return fits;
    }
    void assign(size_t size, T value) {
        allocate(size);
        for (size_t i = 0; i < size; ++i) data_[i] = value;
    }
    void push_back(T value) {
        if (size_ >= capacity_) reserve(size_ < 8 ? 16 : 2 * size_);
        data_[size_++] = value;
    }
    /// Room for so many elements, the contents among them.
    void reserve(size_t capacity) {
        if (capacity <= capacity_) return;
        Array larger;
        larger.allocate(capacity);
        if (size_ != 0) std::memcpy(larger.data_, data_, bytes());
        larger.size_ = size_;
        *this = std::move(larger);
    }
    /// Keeps the contents up to `size`; elements behind them are uninitialised. A block that grows has room for half more.
    void resize(size_t size) {
        if (size > capacity_) reserve(size_ == 0 ? size : size + size / 2);
        size_ = size;
    }

    T& operator[](size_t i) { return assert(i < size_), data_[i]; }
    const T& operator[](size_t i) const { return assert(i < size_), data_[i]; }
    T* data() { return data_; }
    const T* data() const { return data_; }
    size_t size() const { return size_; }
    bool empty() const { return size_ == 0; }
    T* begin() { return data_; }
    T* end() { return data_ + size_; }
    const T* begin() const { return data_; }
    const T* end() const { return data_ + size_; }
    T& back() { return (*this)[size_ - 1]; }
    const T& back() const { return (*this)[size_ - 1]; }
    size_t bytes() const { return size_ * sizeof(T); }

  private:
    static constexpr size_t kReusedBytes = size_t{1} << 16;

    void release() {
        if (capacity_ != 0) std::free(data_);
    }
    /// Large arrays ask for huge pages where the system grants them on request: a quarter of the time that
    /// building a table took went into page faults. The last page is a huge one if most of it is used.
    static void* allocate_bytes(size_t bytes) {
#if defined(__linux__)
        constexpr size_t kHugePage = size_t{2} << 20;
        if (bytes >= kHugePage) {
            void* data = std::aligned_alloc(kHugePage, (bytes + kHugePage - 1) / kHugePage * kHugePage);
            if (data != nullptr) madvise(data, (bytes + kHugePage / 2) / kHugePage * kHugePage, MADV_HUGEPAGE);
            return data;
        }
#endif
        return std::malloc(bytes);
    }

    T* data_ = nullptr;
    size_t size_ = 0, capacity_ = 0;  // a capacity of none: borrowed
};

}  // namespace limn
