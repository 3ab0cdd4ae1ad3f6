#include "limn/schemes/obj_surfaces.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "limn/file.h"

namespace limn {
namespace {

using Words = std::span<const std::string_view>;

/// A surface between `surf` and `end`.
struct OpenSurface {
    double range[4] = {};  // u0, u1, v0, v1
    std::vector<uint32_t> points;
    std::vector<double> parameters[2];
};

struct Parser {
    std::vector<double> points;  // x, y, z, w
    std::string kind = "none";
    bool rational = false, in_curve = false;
    uint32_t degrees[2] = {0, 0};
    std::optional<OpenSurface> open;
    std::vector<BSplineSurface> surfaces;
    uint64_t line = 1;
};

Error parse_error(const std::string& cause) {
    return {ErrorCode::parse_error, cause};
}
Error unsupported(const std::string& cause) {
    return {ErrorCode::unsupported, cause};
}

template <class Number>
bool read_number(std::string_view text, Number& value) {
    if (text.starts_with('+')) text.remove_prefix(1);
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
    return status == std::errc() && end == text.data() + text.size();
}

Result<void> read_numbers(Words words, std::vector<double>& out) {
    for (const std::string_view word : words) {
        double value = 0;
        if (!read_number(word, value))
            return parse_error("'" + printable(word.substr(0, 40)) + "' is not a number");
        if (!std::isfinite(value)) return Error{ErrorCode::not_finite, "a number is not finite"};
        out.push_back(value);
    }
    return {};
}

Result<void> parse_point(Parser& p, Words words) {
    if (words.size() < 3) return parse_error("a vertex needs 3 coordinates");
    // Of four numbers the last is the weight; more are a colour.
    const bool weighted = words.size() == 4;
    if (auto read = read_numbers(words.first(weighted ? 4 : 3), p.points); !read) return read;
    if (!weighted) p.points.push_back(1);
    if (p.points.size() / 4 > (uint64_t{1} << 31) - 1)
        return Error{ErrorCode::too_large, "2^31 vertices or more"};
    return {};
}

Result<void> parse_kind(Parser& p, Words words) {
    p.rational = !words.empty() && words[0] == "rat";
    if (p.rational) words = words.subspan(1);
    if (words.size() != 1)
        return parse_error("cstype needs one kind of curves, and rat before it where that is meant");
    p.kind = words[0];
    return {};
}

Result<void> parse_degrees(Parser& p, Words words) {
    if (words.empty() || words.size() > 2) return parse_error("deg needs one or two degrees");
    for (size_t i = 0; i < words.size(); ++i)
        if (!read_number(words[i], p.degrees[i])) return parse_error("a degree is not a whole number");
    return {};
}

Result<void> begin_surface(Parser& p, Words words) {
    if (p.open || p.in_curve) return parse_error("surf before the end of what was begun before");
    if (p.kind != "bspline" && p.kind != "bezier")
        return unsupported("surfaces of cstype '" + printable(p.kind) + "' are neither bspline nor bezier");
    if (words.size() < 5) return parse_error("surf needs four parameters and control points");
    std::vector<double> range;
    if (auto read = read_numbers(words.first(4), range); !read) return read;
    OpenSurface& open = p.open.emplace();
    std::copy(range.begin(), range.end(), open.range);
    const auto count = static_cast<int64_t>(p.points.size() / 4);
    for (const std::string_view word : words.subspan(4)) {
        int64_t index = 0;
        if (!read_number(word.substr(0, word.find('/')), index) || index == 0)
            return parse_error("'" + printable(word.substr(0, 40)) + "' is not a control point");
        index = index > 0 ? index - 1 : index + count;
        if (index < 0 || index >= count)
            return Error{ErrorCode::index_out_of_range,
                         "a control point is not among the " + std::to_string(count) + " before"};
        open.points.push_back(static_cast<uint32_t>(index));
    }
    return {};
}

Result<void> parse_parameters(Parser& p, Words words) {
    if (p.in_curve) return {};
    if (!p.open) return parse_error("parm outside of a surface");
    if (words.size() < 3 || (words[0] != "u" && words[0] != "v"))
        return parse_error("parm needs u or v, and two parameters or more");
    return read_numbers(words.subspan(1), p.open->parameters[words[0] == "u" ? 0 : 1]);
}

/// Knots of Bezier patches that meet at these parameters.
std::vector<double> bezier_knots(const std::vector<double>& breaks, uint32_t degree) {
    std::vector<double> knots;
    for (size_t i = 0; i < breaks.size(); ++i)
        knots.insert(knots.end(), degree + (i == 0 || i + 1 == breaks.size() ? 1 : 0), breaks[i]);
    return knots;
}

bool covers(const KnotVector& knots, const double* range) {
    const double tolerance = 1e-5 * (knots.end() - knots.begin());
    return std::abs(range[0] - knots.begin()) <= tolerance && std::abs(range[1] - knots.end()) <= tolerance;
}

Result<void> end_surface(Parser& p) {
    if (p.in_curve || !p.open) {
        p.in_curve = false;
        return {};
    }
    BSplineSurface surface;
    for (size_t i = 0; i < 2; ++i) {
        KnotVector& knots = i == 0 ? surface.u : surface.v;
        knots.degree = p.degrees[i];
        if (knots.degree > kMaxBSplineDegree)
            return Error{ErrorCode::invalid_argument,
                         "degrees are at most " + std::to_string(kMaxBSplineDegree)};
        knots.knots =
            p.kind == "bezier" ? bezier_knots(p.open->parameters[i], knots.degree) : p.open->parameters[i];
        if (auto checked = check_knots(knots); !checked) return checked;
    }
    surface.width = p.rational ? 4 : 3;
    for (const uint32_t point : p.open->points) {
        const double* at = p.points.data() + 4 * size_t{point};
        for (int c = 0; c < 3; ++c) surface.points.push_back(p.rational ? at[c] * at[3] : at[c]);
        if (p.rational) surface.points.push_back(at[3]);
    }
    if (auto checked = check_surface(surface); !checked) return checked;
    if (!covers(surface.u, p.open->range) || !covers(surface.v, p.open->range + 2))
        return unsupported("surf names a part only of what its knots span");
    p.surfaces.push_back(std::move(surface));
    p.open.reset();
    return {};
}

Result<void> parse_statement(Parser& p, std::string_view keyword, Words words) {
    if (keyword == "v") return parse_point(p, words);
    if (keyword == "cstype") return parse_kind(p, words);
    if (keyword == "deg") return parse_degrees(p, words);
    if (keyword == "surf") return begin_surface(p, words);
    if (keyword == "parm") return parse_parameters(p, words);
    if (keyword == "end") return end_surface(p);
    if (keyword == "curv" || keyword == "curv2") p.in_curve = true;
    if (p.open && (keyword == "trim" || keyword == "hole" || keyword == "scrv" || keyword == "sp"))
        return unsupported("'" + std::string(keyword) + "' of a surface: only whole ones can be read");
    return {};
}

std::vector<std::string_view> split_words(std::string_view line) {
    constexpr std::string_view kBlanks = " \t\r\v\f";
    std::vector<std::string_view> words;
    line = line.substr(0, line.find('#'));
    for (size_t begin = line.find_first_not_of(kBlanks); begin != line.npos;
         begin = line.find_first_not_of(kBlanks)) {
        line.remove_prefix(begin);
        words.push_back(line.substr(0, line.find_first_of(kBlanks)));
        line.remove_prefix(words.back().size());
    }
    return words;
}

/// One statement, and how many lines it takes.
struct Statement {
    std::string joined;  // of lines that are continued
    std::string_view text;
    uint64_t lines = 0;
};
Statement next_statement(std::string_view& text) {
    Statement statement;
    for (bool more = true; more;) {
        std::string_view line = text.substr(0, text.find('\n'));
        text.remove_prefix(std::min(text.size(), line.size() + 1));
        ++statement.lines;
        if (line.ends_with('\r')) line.remove_suffix(1);
        more = line.ends_with('\\') && !text.empty();
        if (line.ends_with('\\')) line.remove_suffix(1);
        if (!more && statement.lines == 1) {
            statement.text = line;
        } else {
            statement.joined.append(line).append(" ");
        }
    }
    return statement;
}

char* put_number(char* to, double value) {
    *to++ = ' ';
    return std::to_chars(to, to + 32, value).ptr;
}
void write_numbers(FileWriter& file, std::string_view keyword, std::span<const double> values) {
    file.append(keyword);
    for (const double value : values) file.advance(put_number(file.room(40), value));
    file.append("\n");
}

void write_surface(FileWriter& file, const BSplineSurface& s, size_t first_point) {
    for (size_t i = 0; i < s.points.size(); i += s.width) {
        const double weight = s.width == 4 ? s.points[i + 3] : 1;
        const double point[4] = {s.points[i] / weight, s.points[i + 1] / weight, s.points[i + 2] / weight,
                                 weight};
        write_numbers(file, "v", {point, s.width});
    }
    file.append(s.width == 4 ? "cstype rat bspline\n" : "cstype bspline\n");
    file.append("deg " + std::to_string(s.u.degree) + " " + std::to_string(s.v.degree) + "\nsurf");
    for (const double end : {s.u.begin(), s.u.end(), s.v.begin(), s.v.end()})
        file.advance(put_number(file.room(40), end));
    for (size_t i = 0; i < s.points.size() / s.width; ++i)
        file.append(" " + std::to_string(first_point + i + 1));
    file.append("\n");
    write_numbers(file, "parm u", s.u.knots);
    write_numbers(file, "parm v", s.v.knots);
    file.append("end\n");
}

}  // namespace

Result<std::vector<BSplineSurface>> parse_obj_surfaces(std::string_view text, const std::string& name) {
    Parser parser;
    while (!text.empty()) {
        const Statement statement = next_statement(text);
        const auto words =
            split_words(statement.joined.empty() ? statement.text : std::string_view(statement.joined));
        const auto parsed =
            words.empty() ? Result<void>() : parse_statement(parser, words[0], Words(words).subspan(1));
        if (!parsed)
            return Error{parsed.error().code,
                         printable(name) + ":" + std::to_string(parser.line) + ": " + parsed.error().message,
                         parser.line};
        parser.line += statement.lines;
    }
    if (parser.open) return Error{ErrorCode::parse_error, printable(name) + ": a surface without an end"};
    return std::move(parser.surfaces);
}

Result<std::vector<BSplineSurface>> read_obj_surfaces(const std::string& path) {
    const auto bytes = read_file(path);
    if (!bytes) return bytes.error();
    return parse_obj_surfaces(bytes->text(), path);
}

Result<void> write_obj_surfaces(const std::string& path, std::span<const BSplineSurface> surfaces) {
    for (const BSplineSurface& s : surfaces) {
        if (auto checked = check_surface(s); !checked) return checked;
        if (s.width != 3 && s.width != 4)
            return Error{ErrorCode::invalid_argument, "surfaces in OBJ files have 3 components, or 4"};
        for (size_t i = 3; s.width == 4 && i < s.points.size(); i += 4)
            if (s.points[i] == 0)
                return Error{ErrorCode::invalid_argument, "a control point of weight 0", i / 4};
    }
    auto file = FileWriter::create(path);
    if (!file) return file.error();
    size_t first_point = 0;
    for (const BSplineSurface& s : surfaces) {
        write_surface(*file, s, first_point);
        first_point += s.points.size() / s.width;
    }
    return file->commit();
}

}  // namespace limn
