#include "limn/file.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

namespace limn {
namespace {

namespace fs = std::filesystem;

constexpr size_t kFirstRead = 64 << 10;
constexpr int kTemporaryNames = 10000;  // left over by killed programs, or in use by others

Error file_error(const std::string& path, const char* what, int code) {
    const std::string cause = std::generic_category().message(code);
    return {code == ENOMEM ? ErrorCode::out_of_memory : ErrorCode::cannot_open,
            printable(path) + ": " + what + ": " + cause};
}

/// Gives `bytes` room for `capacity`; false when there is no memory.
bool reallocate(FileBytes& bytes, size_t capacity) {
    auto* memory = static_cast<char*>(std::realloc(bytes.data.get(), capacity));
    if (memory == nullptr) return false;
    (void)bytes.data.release();  // realloc owns the old block now
    bytes.data.reset(memory);
    return true;
}

/// Reads to the end into `bytes`, `capacity` bytes at first; 0 or an errno.
int read_to_end(std::FILE* file, size_t capacity, FileBytes& bytes) {
    if (!reallocate(bytes, capacity)) return ENOMEM;
    for (;;) {
        errno = 0;
        const size_t count = std::fread(bytes.data.get() + bytes.size, 1, capacity - bytes.size, file);
        bytes.size += count;
        if (std::ferror(file) != 0) return errno != 0 ? errno : EIO;
        if (bytes.size < capacity) return 0;
        if (capacity > static_cast<size_t>(-1) / 2) return ENOMEM;
        capacity *= 2;
        if (!reallocate(bytes, capacity)) return ENOMEM;
    }
}

}  // namespace

std::string printable(std::string_view path) {
    std::string text(path);
    for (char& c : text)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
    return text;
}

Result<FileBytes> read_file(const std::string& path) {
    std::error_code ignored;
    const fs::file_status status = fs::status(path, ignored);
    if (fs::is_directory(status)) return file_error(path, "cannot read", EISDIR);
    // A device such as /dev/zero has no end.
    if (fs::is_character_file(status)) return file_error(path, "cannot read", EINVAL);
    errno = 0;
    std::FILE* file = std::fopen(path.c_str(), "rb");
    if (file == nullptr) return file_error(path, "cannot open", errno);
    std::setvbuf(file, nullptr, _IONBF, 0);

    // One byte more than it has, so that the first read meets the end.
    const uintmax_t expected = fs::is_regular_file(status) ? fs::file_size(path, ignored) : 0;
    const bool known = expected > 0 && expected < static_cast<size_t>(-1) / 2;
    FileBytes bytes;
    const int failure = read_to_end(file, known ? static_cast<size_t>(expected) + 1 : kFirstRead, bytes);
    std::fclose(file);
    if (failure != 0) return file_error(path, "cannot read", failure);
    return bytes;
}

Result<FileWriter> FileWriter::create(const std::string& path) {
    FileWriter writer;
    writer.path_ = path;
    writer.final_path_ = path;
    std::error_code ignored;
    if (fs::is_symlink(fs::symlink_status(path, ignored))) {
        const fs::path followed = fs::weakly_canonical(path, ignored);
        if (!ignored) writer.final_path_ = followed.string();
    }
    writer.buffer_.reset(static_cast<char*>(std::malloc(kBufferBytes)));
    if (writer.buffer_ == nullptr) return file_error(path, "cannot write", ENOMEM);

    const fs::file_status status = fs::status(path, ignored);
    if (fs::is_directory(status)) return file_error(path, "cannot write", EISDIR);
    errno = 0;
    if (fs::exists(status) && !fs::is_regular_file(status)) {
        writer.file_.reset(std::fopen(path.c_str(), "wb"));
    } else {
        for (int i = 0; i < kTemporaryNames && writer.file_ == nullptr; ++i) {
            writer.temporary_path_ = writer.final_path_ + ".tmp" + std::to_string(i);
            writer.file_.reset(std::fopen(writer.temporary_path_.c_str(), "wbx"));
            if (writer.file_ == nullptr && errno != EEXIST) break;
        }
    }
    if (writer.file_ == nullptr) {
        writer.temporary_path_.clear();  // not ours to remove
        return file_error(path, "cannot write", errno);
    }
    std::setvbuf(writer.file_.get(), nullptr, _IONBF, 0);
    return writer;
}

FileWriter::~FileWriter() {
    if (file_ == nullptr) return;
    file_.reset();
    if (!temporary_path_.empty()) std::remove(temporary_path_.c_str());
}

void FileWriter::append(std::string_view text) {
    char* to = room(text.size());
    if (!text.empty()) std::memcpy(to, text.data(), text.size());
    advance(to + text.size());
}

void FileWriter::flush() {
    errno = 0;
    if (errno_ == 0 && std::fwrite(buffer_.get(), 1, used_, file_.get()) != used_) {
        errno_ = errno != 0 ? errno : EIO;
    }
    used_ = 0;
}

Result<void> FileWriter::commit() {
    assert(file_ != nullptr);
    flush();
    errno = 0;
    if (std::fclose(file_.release()) != 0 && errno_ == 0) errno_ = errno != 0 ? errno : EIO;
    if (errno_ == 0 && !temporary_path_.empty()) {
        std::error_code failure;
        fs::rename(temporary_path_, final_path_, failure);
        errno_ = failure.value();
    }
    if (errno_ == 0) return {};
    if (!temporary_path_.empty()) std::remove(temporary_path_.c_str());
    return file_error(path_, "cannot write", errno_);
}

}  // namespace limn
