#include "report_json.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "limn/file.h"

namespace limn::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "limn bench";
constexpr int kVersion = 1;

void put_timing(Json& json, const Timing& timing) {
    json["count"] = timing.count;
    if (timing.count == 0) return;
    json["median_ms"] = timing.median;
    json["min_ms"] = timing.min;
    json["max_ms"] = timing.max;
}

void put_positive(Json& json, const char* key, double value) {
    if (value > 0) json[key] = value;
}

Json json_of(const Row& row, uint64_t cache_bytes) {
    Json json = {{"name", row_name(row)}, {"scenario", row.scenario}, {"model", row.model}};
    json["parameters"] = {{"faces", row.faces}};
    for (const auto& [key, value] : row.parameters) json["parameters"][key] = value;
    if (!row.task.empty()) json["task"] = row.task;
    json["evaluator"] = row.evaluator;
    json["side"] = to_text(row.side);
    put_timing(json, row.timing);
    if (row.device) put_timing(json["device_ms"], *row.device);
    json["items"] = row.items;
    json["unit"] = row.unit;
    put_positive(json, "bytes", row.bytes);
    put_positive(json, "flops", row.flops);
    put_positive(json, "copy_bytes_per_second", row.copy_rate);
    put_positive(json, "copy_share", copy_share(row));
    if (const CacheClass cache = cache_class(row, cache_bytes); cache != CacheClass::unknown)
        json["cache"] = to_text(cache);
    if (!row.note.empty()) json["note"] = row.note;
    return json;
}

/// Reads members, and remembers the first that is missing or of another type.
struct Reader {
    const Json& json;
    std::string& fault;

    const Json* find(const char* key, bool required) const {
        const auto member = json.is_object() ? json.find(key) : json.end();
        if (json.is_object() && member != json.end()) return &*member;
        if (required) blame(key);
        return nullptr;
    }
    void blame(const char* key) const {
        if (fault.empty()) fault = std::string("no good '") + key + "'";
    }
    std::string text(const char* key, bool required = true) const {
        const Json* member = find(key, required);
        if (member == nullptr) return {};
        if (member->is_string()) return member->get<std::string>();
        blame(key);
        return {};
    }
    double number(const char* key, bool required = false) const {
        const Json* member = find(key, required);
        if (member == nullptr) return 0;
        if (member->is_number() && member->get<double>() >= 0) return member->get<double>();
        blame(key);
        return 0;
    }
    Timing timing() const {
        Timing timing;
        timing.count = static_cast<uint32_t>(std::min(number("count", true), 4e9));
        if (timing.count == 0) return timing;
        timing.median = number("median_ms", true);
        timing.min = number("min_ms", true);
        timing.max = number("max_ms", true);
        return timing;
    }
};

Row read_row(const Json& json, std::string& fault) {
    const Reader reader{json, fault};
    Row row;
    row.scenario = reader.text("scenario");
    row.model = reader.text("model");
    row.task = reader.text("task", false);
    row.evaluator = reader.text("evaluator");
    row.unit = reader.text("unit");
    row.note = reader.text("note", false);
    const std::string side = reader.text("side");
    if (side != "limn" && side != "peer") reader.blame("side");
    row.side = side == "peer" ? Side::peer : Side::limn;
    row.timing = reader.timing();
    if (const Json* device = reader.find("device_ms", false)) row.device = Reader{*device, fault}.timing();
    row.items = reader.number("items");
    row.bytes = reader.number("bytes");
    row.flops = reader.number("flops");
    row.copy_rate = reader.number("copy_bytes_per_second");
    const Json* parameters = reader.find("parameters", true);
    if (parameters == nullptr || !parameters->is_object()) return reader.blame("parameters"), row;
    for (const auto& [key, value] : parameters->items()) {
        const double number = Reader{*parameters, fault}.number(key.c_str(), true);
        if (key == "faces")
            row.faces = static_cast<uint32_t>(std::min(number, 4e9));
        else
            row.parameters.emplace_back(key, number);
    }
    return row;
}

ReportData read_report(const Json& json, std::string& fault) {
    const Reader reader{json, fault};
    ReportData data;
    if (reader.text("format") != kFormat) reader.blame("format");
    if (reader.number("version", true) != kVersion) reader.blame("version");
    data.cache_bytes = static_cast<uint64_t>(std::min(reader.number("cache_bytes"), 1e18));
    data.device_copy_rate = reader.number("device_copy_bytes_per_second");
    const Json *quick = reader.find("quick", true), *rows = reader.find("rows", true),
               *facts = reader.find("facts", true);
    if (quick == nullptr || !quick->is_boolean()) return reader.blame("quick"), data;
    data.quick = quick->get<bool>();
    if (facts == nullptr || !facts->is_object()) return reader.blame("facts"), data;
    for (const auto& [key, value] : facts->items())
        data.facts.emplace_back(key, Reader{*facts, fault}.text(key.c_str()));
    if (rows == nullptr || !rows->is_array()) return reader.blame("rows"), data;
    for (const Json& row : *rows) data.rows.push_back(read_row(row, fault));
    if (const Json* findings = reader.find("findings", false); findings != nullptr && findings->is_array())
        for (const Json& line : *findings)
            if (line.is_string()) data.findings.push_back(line.get<std::string>());
    return data;
}

}  // namespace

std::string to_json(const ReportData& data) {
    Json json = {
        {"format", kFormat}, {"version", kVersion}, {"quick", data.quick}, {"facts", Json::object()}};
    for (const auto& [name, text] : data.facts) json["facts"][name] = text;
    json["cache_bytes"] = data.cache_bytes;
    json["device_copy_bytes_per_second"] = data.device_copy_rate;
    json["findings"] = data.findings;
    json["rows"] = Json::array();
    for (const Row& row : data.rows) json["rows"].push_back(json_of(row, data.cache_bytes));
    return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Result<ReportData> parse_json(std::string_view text, const std::string& name) {
    const auto failed = [&](const std::string& why) {
        return Error{ErrorCode::parse_error,
                     printable(name) + ": not a file of limn bench: " + printable(why)};
    };
    const Json json = Json::parse(text.begin(), text.end(), nullptr, false);
    if (json.is_discarded()) return failed("no JSON");
    std::string fault;
    ReportData data = read_report(json, fault);
    if (!fault.empty()) return failed(fault);
    return data;
}

Result<void> write_text(const std::string& path, std::string_view text) {
    auto writer = FileWriter::create(path);
    if (!writer) return writer.error();
    for (size_t at = 0; at < text.size(); at += FileWriter::kBufferBytes)
        writer->append(text.substr(at, FileWriter::kBufferBytes));
    return writer->commit();
}

}  // namespace limn::bench
