#include "cli/samples_csv.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <system_error>

namespace limn::cli {
namespace {

constexpr size_t kBlockBytes = size_t{1} << 20;
constexpr size_t kQuotedBytes = 40;
constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";

Error file_error(const std::string& name, const char* what, int code) {
    return {ErrorCode::cannot_open, name + ": " + what + ": " + std::generic_category().message(code)};
}

/// The lines of a file, through one block of memory.
class LineReader {
  public:
    explicit LineReader(std::FILE* file) : file_(file), block_(kBlockBytes) {}

    /// False at the end, after a failed read, and at a line that the block has no room for. A line is valid
    /// until the next one is asked for.
    bool next(std::string_view& line) {
        for (size_t searched = begin_;;) {
            const auto* found =
                static_cast<const char*>(std::memchr(block_.data() + searched, '\n', end_ - searched));
            if (found != nullptr) {
                line = take(static_cast<size_t>(found - block_.data()));
                ++begin_;
                return true;
            }
            searched = end_ - begin_;
            if (!fill()) break;
        }
        if (failure_ != 0 || is_too_long() || begin_ == end_) return false;
        line = take(end_);
        return true;
    }
    int failure() const { return failure_; }  ///< an errno
    bool is_too_long() const { return end_ - begin_ == block_.size(); }

  private:
    std::string_view take(size_t end) {
        const std::string_view text(block_.data() + begin_, end - begin_);
        begin_ = end;
        return text;
    }
    /// Moves what is left to the front and reads on behind it; false where there is nothing more, or no room.
    bool fill() {
        std::memmove(block_.data(), block_.data() + begin_, end_ - begin_);
        end_ -= begin_;
        begin_ = 0;
        errno = 0;
        const size_t count = std::fread(block_.data() + end_, 1, block_.size() - end_, file_);
        end_ += count;
        if (std::ferror(file_) != 0) failure_ = errno != 0 ? errno : EIO;
        return count > 0 && failure_ == 0;
    }

    std::FILE* file_;
    std::vector<char> block_;
    size_t begin_ = 0, end_ = 0;
    int failure_ = 0;
};

std::string_view trim(std::string_view text) {
    constexpr std::string_view kBlanks = " \t\r";
    const size_t first = text.find_first_not_of(kBlanks);
    if (first == text.npos) return {};
    return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::string quoted(std::string_view text) {
    return "'" + printable(text.substr(0, kQuotedBytes)) + (text.size() > kQuotedBytes ? "..." : "") + "'";
}

std::string_view skip_plus(std::string_view text) {
    return text.size() > 1 && text[0] == '+' && text[1] != '-' ? text.substr(1) : text;
}

/// Whether all of `text` is a number. One that is too large or small saturates.
bool parse_number(std::string_view text, double& value) {
    text = skip_plus(text);
    const char* end = text.data() + text.size();
    const auto [last, status] = std::from_chars(text.data(), end, value);
    if (status == std::errc::result_out_of_range) value = std::strtod(std::string(text).c_str(), nullptr);
    return status != std::errc::invalid_argument && last == end;
}
bool parse_number(std::string_view text, int64_t& value) {
    text = skip_plus(text);
    const char* end = text.data() + text.size();
    const auto [last, status] = std::from_chars(text.data(), end, value);
    if (status == std::errc::result_out_of_range) value = text[0] == '-' ? INT64_MIN : INT64_MAX;
    return status != std::errc::invalid_argument && last == end;
}

bool is_header(std::string_view line) {
    std::string name;
    for (const char c : line)
        if (c != ' ' && c != '\t') name += static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
    return name == "face,u,v";
}

/// The row of a line, or what is wrong with it.
std::optional<std::string> parse_row(std::string_view line, SampleRow& row) {
    const auto commas = std::count(line.begin(), line.end(), ',');
    if (commas != 2)
        return "a row is face,u,v: three values, not " + std::to_string(commas + 1) + " as in " +
               quoted(line);
    const size_t first = line.find(','), second = line.find(',', first + 1);
    const std::string_view face = trim(line.substr(0, first));
    const std::string_view u = trim(line.substr(first + 1, second - first - 1)),
                           v = trim(line.substr(second + 1));
    double numbers[2];
    if (!parse_number(face, row.face)) return "face " + quoted(face) + " is not a whole number";
    if (!parse_number(u, numbers[0])) return "u " + quoted(u) + " is not a number";
    if (!parse_number(v, numbers[1])) return "v " + quoted(v) + " is not a number";
    row.u = static_cast<float>(numbers[0]);
    row.v = static_cast<float>(numbers[1]);
    return {};
}

Result<std::vector<SampleRow>> read_rows(std::FILE* file, const std::string& name) {
    LineReader reader(file);
    std::vector<SampleRow> rows;
    std::string_view line;
    uint64_t number = 1;
    auto fail_here = [&](const std::string& cause) {
        return Error{ErrorCode::parse_error, name + ":" + std::to_string(number) + ": " + cause, number};
    };
    for (; reader.next(line); ++number) {
        if (number == 1 && line.starts_with(kByteOrderMark)) line.remove_prefix(kByteOrderMark.size());
        line = trim(line);
        if (line.empty() || (number == 1 && is_header(line))) continue;
        SampleRow row;
        if (const auto cause = parse_row(line, row)) return fail_here(*cause);
        rows.push_back(row);
    }
    if (reader.failure() != 0) return file_error(name, "cannot read", reader.failure());
    if (reader.is_too_long()) return fail_here("the line is too long for a row");
    return rows;
}

}  // namespace

Result<std::vector<SampleRow>> read_samples(const std::string& path) {
    if (path == "-") return read_rows(stdin, "standard input");
    errno = 0;
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), std::fclose);
    if (file == nullptr) return file_error(printable(path), "cannot open", errno);
    return read_rows(file.get(), printable(path));
}

Result<TextOutput> TextOutput::create(const std::string& path) {
    TextOutput output;
    if (path == "-") return output;
    Result<FileWriter> file = FileWriter::create(path);
    if (!file) return file.error();
    output.file_.emplace(std::move(*file));
    return output;
}

void TextOutput::append(std::string_view text) {
    if (file_)
        file_->append(text);
    else
        std::fwrite(text.data(), 1, text.size(), stdout);
}

Result<void> TextOutput::commit() {
    if (file_) return file_->commit();
    errno = 0;
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return {};
    return file_error("standard output", "cannot write", errno != 0 ? errno : EIO);
}

}  // namespace limn::cli
