// Why not tinyobjloader (2.0 rc10): of 17 malformed files it accepted 15. `v 0 abc 0` became 0 0 0, NaN 0,
// `f 1 2x 3` a face; indices past the end, 1e999, tags with fewer values than announced and a binary file
// passed as well. A `\` continuation failed, a byte order mark cost a vertex, and faces of two vertices were
// dropped. Its messages name no file, its tags keep no line to report. On one core a million quads took it
// 0.7 s and 221 MB; here they take 0.3 s and 94 MB, the text included.
#include "limn/obj.h"

#include <charconv>
#include <climits>
#include <cmath>
#include <cstring>
#include <system_error>

#include "limn/file.h"

namespace limn {
namespace {

constexpr uint64_t kMaxCount = 0x7fffffff;
constexpr uint64_t kUnknownCount = ~uint64_t{0};

/// One number per kind of element that an index can refer to.
struct Counts {
    uint64_t vertices = 0;
    uint64_t texture_coordinates = 0;
    uint64_t normals = 0;
    uint64_t faces = 0;
};

/// A pass over the text. Functions that take one return false after fail().
struct Parser {
    const char* at = nullptr;
    const char* end = nullptr;
    uint64_t line = 1;       // where the statement at hand begins
    uint64_t continued = 0;  // `\` line ends in it so far
    Model model;
    uint64_t normal_count = 0;
    bool all_corners_textured = true;
    // Indices may point forward, so the first pass knows no limit and notes the largest index of each kind,
    // plus one. Only if that proves too large does a second pass, which knows the counts, look for the line
    // to blame.
    Counts limits{kUnknownCount, kUnknownCount, kUnknownCount, kUnknownCount};
    Counts needed;
    // The values of the tag at hand, kept for their memory.
    std::vector<int64_t> integers;
    std::vector<float> floats;
    std::vector<std::string_view> strings;
    Error error;
};

bool fail(Parser& p, ErrorCode code, std::string cause) {
    p.error = {code, std::move(cause), p.line};
    return false;
}

// Characters and words.

bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

bool ends_word(const Parser& p, const char* at) {
    return at == p.end || is_blank(*at) || *at == '\n' || *at == '\\';
}

/// The byte after the line end that the `\` at `at` continues, or null.
const char* after_continuation(const Parser& p, const char* at) {
    for (++at; at != p.end && *at == '\r';) ++at;
    return at != p.end && *at == '\n' ? at + 1 : nullptr;
}

void skip_blanks(Parser& p) {
    while (p.at != p.end) {
        if (is_blank(*p.at)) {
            ++p.at;
            continue;
        }
        const char* next = *p.at == '\\' ? after_continuation(p, p.at) : nullptr;
        if (next == nullptr) return;
        p.at = next;
        ++p.continued;
    }
}

bool at_line_end(const Parser& p) {
    return p.at == p.end || *p.at == '\n' || *p.at == '#';
}

/// The word at `p.at`, which is left behind.
std::string_view read_word(Parser& p) {
    const char* first = p.at;
    // A `\` that continues no line is part of a word, but of none that means anything.
    while (p.at != p.end && !is_blank(*p.at) && *p.at != '\n') {
        if (*p.at == '\\' && after_continuation(p, p.at) != nullptr) break;
        ++p.at;
    }
    return {first, static_cast<size_t>(p.at - first)};
}

/// A word of the file for a message.
std::string quoted(std::string_view word) {
    constexpr size_t kLongest = 40;
    std::string text = "'" + printable(word.substr(0, kLongest)) + (word.size() > kLongest ? "...'" : "'");
    for (char& c : text)
        if (static_cast<unsigned char>(c) >= 0x80) c = '?';
    return text;
}

void skip_comment(Parser& p) {
    const void* found = std::memchr(p.at, '\n', static_cast<size_t>(p.end - p.at));
    p.at = found == nullptr ? p.end : static_cast<const char*>(found);
}

/// A statement that is none of ours, continuations included.
void skip_statement(Parser& p) {
    for (skip_blanks(p); !at_line_end(p); skip_blanks(p)) (void)read_word(p);
}

// Numbers.

/// Whether a number too large or too small for double is too small. Only its form tells.
bool is_tiny(std::string_view number) {
    if (const size_t exponent = number.find_first_of("eE"); exponent != number.npos)
        return number.substr(exponent + 1).starts_with('-');
    return number.find_first_of("123456789") > number.find('.');
}

/// A number, NaN and infinity among them. Too small for float: rounded, as any other; too large: infinity.
bool read_number(Parser& p, float& value) {
    const char* first = p.at;
    if (first != p.end && *first == '+' && first + 1 != p.end && first[1] != '-') ++first;
    auto [last, status] = std::from_chars(first, p.end, value);
    if (status == std::errc::invalid_argument || !ends_word(p, last)) {
        const std::string_view word = read_word(p);
        return fail(
            p, ErrorCode::parse_error,
            word.empty() || word[0] == '#' ? "a number is missing" : "malformed number " + quoted(word));
    }
    if (status == std::errc::result_out_of_range) {
        double wide = 0;
        const std::string_view number(first, static_cast<size_t>(last - first));
        if (std::from_chars(first, last, wide).ec == std::errc::result_out_of_range)
            wide = is_tiny(number) ? 0.0 : HUGE_VAL;
        value = std::abs(wide) > 1 ? HUGE_VALF : static_cast<float>(wide);
    }
    p.at = last;
    return true;
}

/// The numbers up to the line end: `least` to `most`, the first `kept`, which must be finite, into `values`.
bool read_numbers(Parser& p, const char* keyword, int least, int most, int kept, float* values) {
    int count = 0;
    for (skip_blanks(p); !at_line_end(p) && count <= most; skip_blanks(p), ++count) {
        float value = 0;
        if (!read_number(p, value)) return false;
        if (count >= kept) continue;
        values[count] = value;
        if (!std::isfinite(value))
            return fail(p, ErrorCode::not_finite, std::string(keyword) + " number is not finite");
    }
    if (count >= least && count <= most) return true;
    return fail(p, ErrorCode::parse_error,
                std::string(keyword) + (count < least ? " needs at least " : " takes at most ") +
                    std::to_string(count < least ? least : most) + " numbers");
}

/// An integer; saturates, so that one of any length is merely out of range.
bool read_integer(Parser& p, int64_t& value) {
    auto [last, status] = std::from_chars(p.at, p.end, value);
    if (status == std::errc::invalid_argument) return false;
    if (status == std::errc::result_out_of_range) value = *p.at == '-' ? INT64_MIN : INT64_MAX;
    p.at = last;
    return true;
}

// Elements.

bool check_count(Parser& p, uint64_t count, const char* what) {
    if (count <= kMaxCount) return true;
    return fail(p, ErrorCode::too_large, std::string("more than 2^31 - 1 ") + what);
}

bool parse_vertex(Parser& p) {
    float values[3];
    if (!read_numbers(p, "v", 3, INT_MAX - 1, 3, values)) return false;
    p.model.positions.insert(p.model.positions.end(), values, values + 3);
    return check_count(p, p.model.vertex_count(), "vertices");
}

bool parse_texture_coordinate(Parser& p) {
    float values[3] = {0, 0, 0};
    if (!read_numbers(p, "vt", 1, 3, 2, values)) return false;
    p.model.texture_coordinates.insert(p.model.texture_coordinates.end(), values, values + 2);
    return check_count(p, p.model.texture_coordinates.size() / 2, "texture coordinates");
}

/// Exporters write NaN normals for degenerate faces. They are dropped with the rest.
bool parse_normal(Parser& p) {
    if (!read_numbers(p, "vn", 3, 3, 0, nullptr)) return false;
    return check_count(p, ++p.normal_count, "normals");
}

bool out_of_range(Parser& p, const char* what, int64_t index, uint64_t count, const char* where) {
    return fail(p, ErrorCode::index_out_of_range,
                std::string(what) + " index " + std::to_string(index) +
                    " is out of range: " + std::to_string(count) + where);
}

/// One of the numbers of a face corner, as an index that counts from 0.
bool read_corner_index(Parser& p, const char* what, uint64_t count, uint64_t limit, uint64_t& needed,
                       uint32_t& index) {
    const char* first = p.at;
    int64_t value = 0;
    if (!read_integer(p, value) || !(ends_word(p, p.at) || *p.at == '/')) {
        p.at = first;
        return fail(p, ErrorCode::parse_error, "malformed face corner " + quoted(read_word(p)));
    }
    if (value == 0)
        return fail(p, ErrorCode::index_out_of_range, std::string(what) + " index 0: they count from 1");
    if (value < 0 && static_cast<uint64_t>(-(value + 1)) >= count)
        return out_of_range(p, what, value, count, " so far");
    const uint64_t from_zero =
        value > 0 ? static_cast<uint64_t>(value) - 1 : count - static_cast<uint64_t>(-value);
    if (from_zero >= limit) return out_of_range(p, what, value, limit, " in the file");
    if (from_zero >= needed) needed = from_zero + 1;
    index = static_cast<uint32_t>(from_zero);  // what does not fit is past every limit of the second pass
    return true;
}

bool parse_corner(Parser& p) {
    Model& model = p.model;
    uint32_t index = 0;
    if (!read_corner_index(p, "vertex", model.vertex_count(), p.limits.vertices, p.needed.vertices, index))
        return false;
    model.face_vertices.push_back(index);

    bool textured = false;
    if (p.at != p.end && *p.at == '/') {
        ++p.at;
        textured = !ends_word(p, p.at) && *p.at != '/';
        if (textured && !read_corner_index(p, "texture coordinate", model.texture_coordinates.size() / 2,
                                           p.limits.texture_coordinates, p.needed.texture_coordinates, index))
            return false;
        uint32_t normal = 0;
        if (p.at != p.end && *p.at == '/' && !ends_word(p, ++p.at) &&
            !read_corner_index(p, "normal", p.normal_count, p.limits.normals, p.needed.normals, normal))
            return false;
        if (!ends_word(p, p.at))
            return fail(p, ErrorCode::parse_error, "a face corner of more than three indices");
    }
    if (textured && p.all_corners_textured) {
        model.face_texture_coordinates.push_back(index);
    } else if (p.all_corners_textured) {
        p.all_corners_textured = false;
        model.face_texture_coordinates = {};
    }
    return true;
}

bool parse_face(Parser& p) {
    const size_t first = p.model.face_vertices.size();
    for (skip_blanks(p); !at_line_end(p); skip_blanks(p))
        if (!parse_corner(p)) return false;
    const size_t size = p.model.face_vertices.size() - first;
    if (size < 3)
        return fail(p, ErrorCode::face_too_small, "a face of " + std::to_string(size) + " vertices");
    p.model.face_sizes.push_back(static_cast<uint32_t>(size));
    return check_count(p, p.model.face_vertices.size(), "face corners");
}

// Tags.

bool tag_error(Parser& p, std::string_view tag, const std::string& cause) {
    return fail(p, ErrorCode::parse_error, "tag " + std::string(tag) + " " + cause);
}

/// `N/M/K` and as many integers, floats and strings.
bool read_tag_values(Parser& p, std::string_view tag) {
    int64_t counts[3] = {0, 0, 0};
    skip_blanks(p);
    bool counted = true;
    for (int i = 0; i < 3 && counted; ++i) {
        if (i > 0) counted = p.at != p.end && *p.at++ == '/';
        counted = counted && read_integer(p, counts[i]) && counts[i] >= 0;
    }
    if (!counted || !ends_word(p, p.at)) return tag_error(p, tag, "needs counts such as 2/1/0");

    const auto more = [&] { return skip_blanks(p), !at_line_end(p); };
    const auto left = [](int64_t count, size_t have) { return static_cast<uint64_t>(count) > have; };
    p.integers.clear();
    p.floats.clear();
    p.strings.clear();
    while (left(counts[0], p.integers.size()) && more()) {
        int64_t value = 0;
        if (!read_integer(p, value) || !ends_word(p, p.at))
            return tag_error(p, tag, "has a malformed integer");
        p.integers.push_back(value);
    }
    while (left(counts[1], p.floats.size()) && more()) {
        p.floats.push_back(0);
        if (!read_number(p, p.floats.back())) return false;
    }
    while (left(counts[2], p.strings.size()) && more()) p.strings.push_back(read_word(p));
    if (left(counts[0], p.integers.size()) || left(counts[1], p.floats.size()) ||
        left(counts[2], p.strings.size()))
        return tag_error(p, tag, "has fewer values than it announces");
    return !more() || tag_error(p, tag, "has more values than it announces");
}

/// Checks the integers of the tag as indices that count from 0 and appends them.
bool take_indices(Parser& p, const char* what, uint64_t limit, uint64_t& needed, std::vector<uint32_t>& to) {
    for (const int64_t value : p.integers) {
        if (value < 0)
            return fail(p, ErrorCode::index_out_of_range, std::string(what) + " index is negative");
        if (static_cast<uint64_t>(value) >= limit) return out_of_range(p, what, value, limit, " in the file");
        if (static_cast<uint64_t>(value) >= needed) needed = static_cast<uint64_t>(value) + 1;
        to.push_back(static_cast<uint32_t>(value));
    }
    return true;
}

bool check_sharpness(Parser& p, std::string_view tag, size_t values) {
    if (p.floats.size() != 1 && p.floats.size() != values)
        return tag_error(p, tag, "needs 1 sharpness value, or one for each of " + std::to_string(values));
    for (const float sharpness : p.floats)
        if (!(sharpness >= 0))
            return fail(p, ErrorCode::invalid_sharpness, "sharpness is negative or not a number");
    return true;
}

bool apply_crease(Parser& p, std::string_view tag) {
    if (p.integers.size() < 2) return tag_error(p, tag, "needs at least 2 vertices");
    const size_t edge_count = p.integers.size() - 1;
    if (!check_sharpness(p, tag, edge_count)) return false;
    std::vector<uint32_t>& sizes = p.model.crease_sizes;
    if (p.floats.size() == 1) {
        sizes.push_back(static_cast<uint32_t>(p.integers.size()));
    } else {  // every edge becomes a chain of its own
        std::vector<int64_t> pairs;
        for (size_t edge = 0; edge < edge_count; ++edge)
            pairs.insert(pairs.end(), {p.integers[edge], p.integers[edge + 1]});
        p.integers.swap(pairs);
        sizes.insert(sizes.end(), edge_count, 2);
    }
    p.model.crease_sharpness.insert(p.model.crease_sharpness.end(), p.floats.begin(), p.floats.end());
    return take_indices(p, "crease vertex", p.limits.vertices, p.needed.vertices, p.model.crease_vertices);
}

bool apply_interval(Parser& p, std::string_view tag) {
    if (p.integers.size() < 2) return tag_error(p, tag, "needs at least 2 vertices");
    const size_t edge_count = p.integers.size() - 1;
    if (p.floats.size() != 1 && p.floats.size() != edge_count)
        return tag_error(p, tag, "needs 1 interval, or one for each of " + std::to_string(edge_count));
    std::vector<int64_t> pairs;
    for (size_t edge = 0; edge < edge_count; ++edge) {
        const float interval = p.floats[p.floats.size() == 1 ? 0 : edge];
        if (!(interval >= 0) || std::isinf(interval))
            return fail(p, ErrorCode::invalid_argument, "an interval is negative or no number");
        p.model.intervals.push_back(interval);
        pairs.insert(pairs.end(), {p.integers[edge], p.integers[edge + 1]});
    }
    p.integers.swap(pairs);
    return take_indices(p, "interval vertex", p.limits.vertices, p.needed.vertices, p.model.interval_edges);
}

bool apply_corner(Parser& p, std::string_view tag) {
    if (p.integers.empty()) return tag_error(p, tag, "needs at least 1 vertex");
    if (!check_sharpness(p, tag, p.integers.size())) return false;
    for (size_t i = 0; i < p.integers.size(); ++i)
        p.model.corner_sharpness.push_back(p.floats[p.floats.size() == 1 ? 0 : i]);
    return take_indices(p, "corner vertex", p.limits.vertices, p.needed.vertices, p.model.corner_vertices);
}

bool apply_hole(Parser& p, std::string_view tag) {
    if (p.integers.empty()) return tag_error(p, tag, "needs at least 1 face");
    return take_indices(p, "hole face", p.limits.faces, p.needed.faces, p.model.holes);
}

bool apply_boundary(Parser& p, std::string_view tag) {
    using enum BoundaryInterpolation;
    constexpr BoundaryInterpolation kValues[] = {none, edge_and_corner, edge_only};
    if (p.integers.size() != 1 || p.integers[0] < 0 || p.integers[0] > 2)
        return tag_error(p, tag, "needs 0, 1 or 2");
    p.model.boundary = kValues[p.integers[0]];
    return true;
}

bool apply_face_varying(Parser& p, std::string_view tag) {
    using enum FaceVaryingInterpolation;
    constexpr FaceVaryingInterpolation kValues[] = {none,          corners_only, corners_plus1,
                                                    corners_plus2, boundaries,   all};
    if (p.integers.size() != 1 || p.integers[0] < 0 || p.integers[0] > 5)
        return tag_error(p, tag, "needs 0 to 5");
    p.model.face_varying = kValues[p.integers[0]];
    return true;
}

bool is_word(const Parser& p, std::string_view word) {
    return p.strings.size() == 1 && p.strings[0] == word;
}

bool apply_creasing(Parser& p, std::string_view tag) {
    if (!is_word(p, "normal") && !is_word(p, "chaikin")) return tag_error(p, tag, "needs normal or chaikin");
    p.model.creasing = is_word(p, "normal") ? CreasingMethod::uniform : CreasingMethod::chaikin;
    return true;
}

bool apply_triangles(Parser& p, std::string_view tag) {
    if (!is_word(p, "catmark") && !is_word(p, "smooth")) return tag_error(p, tag, "needs catmark or smooth");
    p.model.triangles = is_word(p, "catmark") ? TriangleSubdivision::catmark : TriangleSubdivision::smooth;
    return true;
}

struct Tag {
    std::string_view name;
    bool (*apply)(Parser& p, std::string_view tag);
};
constexpr Tag kTags[] = {{"crease", apply_crease},
                         {"interval", apply_interval},
                         {"corner", apply_corner},
                         {"hole", apply_hole},
                         {"interpolateboundary", apply_boundary},
                         {"facevaryinginterpolateboundary", apply_face_varying},
                         {"creasemethod", apply_creasing},
                         {"smoothtriangles", apply_triangles}};

bool parse_tag(Parser& p) {
    skip_blanks(p);
    if (at_line_end(p)) return fail(p, ErrorCode::parse_error, "a tag without a name");
    const std::string_view name = read_word(p);
    for (const Tag& tag : kTags)
        if (tag.name == name) return read_tag_values(p, name) && tag.apply(p, name);
    skip_statement(p);
    return true;
}

// Statements.

bool parse_statement(Parser& p) {
    const std::string_view keyword = read_word(p);
    if (keyword == "v") return parse_vertex(p);
    if (keyword == "f") return parse_face(p);
    if (keyword == "vt") return parse_texture_coordinate(p);
    if (keyword == "vn") return parse_normal(p);
    if (keyword == "t") return parse_tag(p);
    for (const char c : keyword) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 0x20 || byte >= 0x7f)
            return fail(p, ErrorCode::parse_error, "not an OBJ file: a line begins with " + quoted(keyword));
    }
    skip_statement(p);
    return true;
}

/// A zero byte is the sign of a binary file, UTF-16, or a disk that lost the end of a file.
bool check_text(Parser& p) {
    const auto size = static_cast<size_t>(p.end - p.at);
    const void* zero = size == 0 ? nullptr : std::memchr(p.at, 0, size);
    if (zero == nullptr) return true;
    for (const char* c = p.at; c != zero; ++c) p.line += *c == '\n';
    return fail(p, ErrorCode::parse_error, "not a text file: it holds a zero byte");
}

bool parse_text(Parser& p, std::string_view text) {
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
    p.at = text.data();
    p.end = text.data() + text.size();
    if (!check_text(p)) return false;
    while (p.at != p.end) {
        skip_blanks(p);
        if (!at_line_end(p) && !parse_statement(p)) return false;
        if (p.at != p.end && *p.at == '#') skip_comment(p);
        if (p.at != p.end) ++p.at, ++p.line;
        p.line += p.continued;
        p.continued = 0;
    }
    return !p.model.face_sizes.empty() || fail(p, ErrorCode::parse_error, "no faces");
}

Counts counts_of(const Parser& p) {
    return {p.model.vertex_count(), p.model.texture_coordinates.size() / 2, p.normal_count,
            p.model.face_count()};
}

bool in_range(const Counts& needed, const Counts& counts) {
    return needed.vertices <= counts.vertices && needed.texture_coordinates <= counts.texture_coordinates &&
           needed.normals <= counts.normals && needed.faces <= counts.faces;
}

}  // namespace

ControlMeshDescription describe(Model& model, const SchemeOptions& defaults) {
    ControlMeshDescription description;
    description.options = defaults;
    description.options.boundary = model.boundary.value_or(defaults.boundary);
    description.options.creasing = model.creasing.value_or(defaults.creasing);
    description.options.triangles = model.triangles.value_or(defaults.triangles);
    description.vertex_count = static_cast<uint32_t>(model.vertex_count());
    description.face_sizes = model.face_sizes;
    description.face_vertices = model.face_vertices;
    description.crease_sizes = model.crease_sizes;
    description.crease_vertices = model.crease_vertices;
    description.crease_sharpness = model.crease_sharpness;
    description.corner_vertices = model.corner_vertices;
    description.corner_sharpness = model.corner_sharpness;
    description.holes = model.holes;
    description.positions = model.positions;
    if (!model.face_texture_coordinates.empty()) {
        model.channel.value_count = static_cast<uint32_t>(model.texture_coordinates.size() / 2);
        model.channel.face_values = model.face_texture_coordinates;
        model.channel.interpolation = model.face_varying.value_or(FaceVaryingInterpolation::all);
        description.channels = {&model.channel, 1};
    }
    return description;
}

Result<Model> parse_obj(std::string_view text, const std::string& name) {
    Parser parser;
    bool parsed = parse_text(parser, text);
    if (parsed && !in_range(parser.needed, counts_of(parser))) {
        const Counts counts = counts_of(parser);
        parser = {};
        parser.limits = counts;
        parsed = parse_text(parser, text);
        assert(!parsed);
    }
    if (parsed) return std::move(parser.model);
    parser.error.message = printable(name) + ":" + std::to_string(parser.line) + ": " + parser.error.message;
    return std::move(parser.error);
}

Result<Model> read_obj(const std::string& path) {
    const auto bytes = read_file(path);
    if (!bytes) return bytes.error();
    return parse_obj(bytes->text(), path);
}

}  // namespace limn
