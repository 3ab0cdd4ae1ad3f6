// The files of `limn eval`: samples in, values out.
#pragma once

#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "limn/file.h"

namespace limn::cli {

/// A request as it was read: also one that is nowhere on the surface, for its row is written all the same.
struct SampleRow {
    int64_t face;
    float u, v;
};

/// Reads rows `face,u,v`, from standard input where the path is "-". A first line with these names is passed
/// over, and so are empty lines. NaN and numbers of any size are let pass. Lines are parsed as they are read.
/// Errors: cannot_open, parse_error; messages are one line, `PATH:LINE: cause`.
Result<std::vector<SampleRow>> read_samples(const std::string& path);

/// A text file that appears under its name at commit(), or standard output for "-".
class TextOutput {
  public:
    static Result<TextOutput> create(const std::string& path);
    void append(std::string_view text);
    /// The last call. Errors: cannot_open (a failed write).
    Result<void> commit();

  private:
    std::optional<FileWriter> file_;  ///< nothing: standard output
};

}  // namespace limn::cli
