#include "base/record.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/parallel.h"
#include "base/revision.h"  // made by CMake

namespace radiafit {
namespace {

std::string cpu_model() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);)
        if (line.starts_with("model name"))
            if (const size_t colon = line.find(": "); colon != std::string::npos) return line.substr(colon + 2);
    return "unknown";
}

std::tm utc_fields() {
    const std::time_t now = std::time(nullptr);
    std::tm fields{};
    gmtime_r(&now, &fields);
    return fields;
}

nlohmann::ordered_json object_of(const JsonFields& fields) {
    auto object = nlohmann::ordered_json::object();
    for (const auto& [key, text] : fields) object[key] = nlohmann::ordered_json::parse(text);
    return object;
}

}  // namespace

std::string git_revision() { return RADIAFIT_GIT_REVISION; }
std::string utc_now() { return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", utc_fields()); }
std::string utc_now_compact() { return fmt::format("{:%Y%m%dT%H%M%SZ}", utc_fields()); }

Record make_record(int argc, const char* const* argv) {
    Record record;
    if (argc > 0) record.program = std::filesystem::path(argv[0]).filename().string();
    for (int i = 1; i < argc; i++) record.arguments.emplace_back(argv[i]);
    record.utc = utc_now();
    record.git_revision = git_revision();
    record.version = RADIAFIT_VERSION;
    record.compiler = RADIAFIT_COMPILER;
    record.cpu = cpu_model();
    record.cores = core_count();
    record.threads = thread_count();
    return record;
}

std::string json_string(const std::string& text) {
    return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string record_json(const Record& record) {
    nlohmann::ordered_json json = {
        {"program", record.program},
        {"arguments", record.arguments},
        {"utc", record.utc},
        {"version", record.version},
        {"git_revision", record.git_revision},
        {"compiler", record.compiler},
        {"cpu", record.cpu},
        {"cores", record.cores},
        {"threads", record.threads},
    };
    if (!record.gl_renderer.empty() || !record.gl_vendor.empty() || !record.gl_version.empty())
        json["gl"] = {{"vendor", record.gl_vendor}, {"renderer", record.gl_renderer}, {"version", record.gl_version}};
    json["config"] = object_of(record.config);
    for (const auto& [key, text] : record.more) json[key] = nlohmann::ordered_json::parse(text);
    return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace radiafit
