// Files: read whole, or written so that a half-written one never appears under its final name.
#pragma once

#include <cassert>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>

#include "limn/result.h"

namespace limn {

struct FreeMemory {
    void operator()(char* memory) const { std::free(memory); }
};

/// The bytes of a file: `size` of them at `data`, which is null when there are none.
struct FileBytes {
    std::unique_ptr<char, FreeMemory> data;
    size_t size = 0;
    std::string_view text() const { return {data.get(), size}; }
};

/// `path` as it appears in messages: control characters, which could break a message in two, become '?'.
std::string printable(std::string_view path);

/// Reads a file or a pipe to its end. Errors: cannot_open (missing, a directory, a device, a failing read),
/// out_of_memory. Messages are one line, `PATH: cause`.
Result<FileBytes> read_file(const std::string& path);

/// Writes a file through one buffer into a temporary file beside it, which commit() renames. Until then what
/// stood under the final name is untouched; a writer destroyed without commit() leaves nothing behind. A
/// symbolic link is followed. Pipes and devices (/dev/stdout), which must not be replaced, are written
/// directly. A failing write is remembered for commit(), so that writing loops need no checks of their own.
class FileWriter {
  public:
    static constexpr size_t kBufferBytes = size_t{1} << 20;

    /// Errors: cannot_open (a directory, an unwritable or missing directory), out_of_memory.
    static Result<FileWriter> create(const std::string& path);
    FileWriter(FileWriter&& other) noexcept = default;
    FileWriter& operator=(FileWriter&&) = delete;
    ~FileWriter();

    /// Where to put the next bytes; there is room for `bytes`. Precondition: bytes <= kBufferBytes.
    char* room(size_t bytes) {
        assert(bytes <= kBufferBytes);
        if (bytes > kBufferBytes - used_) flush();
        return buffer_.get() + used_;
    }
    /// Takes what was put from room() up to `end`.
    void advance(const char* end) { used_ = static_cast<size_t>(end - buffer_.get()); }
    /// room() and advance() for bytes that are at hand. Precondition: text.size() <= kBufferBytes.
    void append(std::string_view text);

    /// Writes what is left, closes and renames; call it once, last. Errors: cannot_open (the first failed
    /// write, of a full disk for one, or the rename); the final name is then as it was.
    Result<void> commit();

  private:
    struct CloseFile {
        void operator()(std::FILE* file) const { std::fclose(file); }
    };
    FileWriter() = default;
    void flush();

    std::unique_ptr<std::FILE, CloseFile> file_;
    std::unique_ptr<char, FreeMemory> buffer_;
    size_t used_ = 0;
    int errno_ = 0;               // of the first failure
    std::string path_;            // as the caller named it, for messages
    std::string final_path_;      // links followed
    std::string temporary_path_;  // empty: written directly
};

}  // namespace limn
