#include "host.h"

#include <cctype>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>

namespace limn::bench {
namespace {

std::string first_line(const std::string& path) {
    std::ifstream file(path);
    std::string line;
    std::getline(file, line);
    return line;
}

}  // namespace

uint64_t parse_cache_size(const std::string& text) {
    char* end = nullptr;
    if (text.empty() || std::isdigit(static_cast<unsigned char>(text[0])) == 0) return 0;
    const uint64_t number = std::strtoull(text.c_str(), &end, 10);
    const std::string unit = end;
    if (unit.empty()) return number;
    return unit == "K" ? number << 10 : unit == "M" ? number << 20 : unit == "G" ? number << 30 : 0;
}

uint64_t last_level_cache_bytes() {
    int last_level = 0;
    uint64_t bytes = 0;
    for (int i = 0; i < 16; ++i) {
        const std::string folder = "/sys/devices/system/cpu/cpu0/cache/index" + std::to_string(i) + "/";
        const std::string level = first_line(folder + "level"), type = first_line(folder + "type");
        if (level.empty()) break;
        if (type == "Instruction" || std::atoi(level.c_str()) <= last_level) continue;
        last_level = std::atoi(level.c_str());
        bytes = parse_cache_size(first_line(folder + "size"));
    }
    return bytes;
}

std::string processor_name() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);) {
        const size_t colon = line.find(": ");
        if (line.rfind("model name", 0) == 0 && colon != std::string::npos) return line.substr(colon + 2);
    }
    return "unknown processor";
}

std::string compiler_name() {
#if defined(__clang__)
    std::string name = "clang " __clang_version__;
#elif defined(__GNUC__)
    std::string name = "g++ " __VERSION__;
#else
    std::string name = "unknown compiler";
#endif
#if !defined(NDEBUG)
    name += ", with assertions: not for timing";
#endif
    return name;
}

std::string commit_name() {
    const char* commit = std::getenv("LIMN_COMMIT");
    return commit != nullptr && *commit != '\0' ? commit : "unknown";
}

std::string date_text() {
    const std::time_t now = std::time(nullptr);
    std::tm parts = {};
    gmtime_r(&now, &parts);
    char text[32];
    std::strftime(text, sizeof text, "%Y-%m-%d %H:%M UTC", &parts);
    return text;
}

}  // namespace limn::bench
