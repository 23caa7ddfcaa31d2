#include "base/record.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/instructions.h"
#include "base/json.h"
#include "base/libraries.h"  // made by CMake
#include "base/parallel.h"
#include "base/revision.h"  // made by CMake

namespace radiafit {
namespace {

using Json = nlohmann::ordered_json;

/// Instruction sets that make a difference to our loops and that the compiler may use.
std::vector<std::string> instructions() {
    return {
#ifdef __SSE4_2__
        "sse4.2",
#endif
#ifdef __AVX__
        "avx",
#endif
#ifdef __AVX2__
        "avx2",
#endif
#ifdef __FMA__
        "fma",
#endif
#ifdef __F16C__
        "f16c",
#endif
#ifdef __AVX512F__
        "avx512f",
#endif
#ifdef __AVX512VL__
        "avx512vl",
#endif
#ifdef __ARM_NEON
        "neon",
#endif
#ifdef __ARM_FEATURE_SVE
        "sve",
#endif
    };
}

std::tm utc_fields() {
    const std::time_t now = std::time(nullptr);
    std::tm fields{};
    gmtime_r(&now, &fields);
    return fields;
}

template <class T>
Json number_or_null(const std::optional<T>& value) {
    return value ? Json(*value) : Json();
}

Json machine_json(const Machine& m) {
    return {
        {"kernel", m.kernel},
        {"distribution", m.distribution},
        {"cpu_id", m.cpu_id},
        {"mhz", number_or_null(m.mhz)},
        {"mhz_max", number_or_null(m.mhz_max)},
        {"governor", m.governor},
        {"memory_bytes", number_or_null(m.memory_bytes)},
        {"hypervisor", m.hypervisor},
        {"dmi", m.dmi},
        {"container", m.container},
        {"load", m.load.empty() ? Json() : Json(m.load)},
    };
}

Json built_json() {
    Json built = Json::object();
    for (const auto& [name, version] : std::initializer_list<std::pair<const char*, const char*>>{RADIAFIT_LIBRARIES})
        built[name] = version;
    return built;
}

Json object_of(const JsonFields& fields) {
    Json object = Json::object();
    for (const auto& [key, text] : fields) object[key] = Json::parse(text);
    return object;
}

}  // namespace

std::string git_revision() { return RADIAFIT_GIT_REVISION; }
std::string project_version() { return RADIAFIT_VERSION; }
std::string utc_now() { return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", utc_fields()); }
std::string compact_utc(const std::string& utc) {
    std::string name = utc;
    std::erase_if(name, [](char c) { return c == '-' || c == ':'; });
    return name;
}

Record make_record(int argc, const char* const* argv) {
    Record record;
    if (argc > 0) record.program = std::filesystem::path(argv[0]).filename().string();
    for (int i = 1; i < argc; i++) record.arguments.emplace_back(argv[i]);
    record.utc_start = utc_now();
    record.git_revision = git_revision();
    record.version = project_version();
    record.compiler = RADIAFIT_COMPILER;
    record.machine = read_machine();
    record.cpu = record.machine.cpu.empty() ? "unknown" : processor_name(record.machine.cpu, record.machine.cpu_id);
    record.cores = core_count();
    record.threads = thread_count();
    return record;
}

std::string json_string(const std::string& text) { return json_text(nlohmann::json(text), -1, NotUtf8::replace); }

std::string record_json(const Record& record) {
    Json json = {
        {"program", record.program},
        {"arguments", record.arguments},
        {"utc_start", record.utc_start},
        {"utc_end", utc_now()},
        {"version", record.version},
        {"git_revision", record.git_revision},
        {"compiler", record.compiler},
        {"march",
         {{"asked", RADIAFIT_MARCH_ASKED},
          {"resolved", RADIAFIT_MARCH},
          {"instructions", instructions()},
          {"avx512", run_avx512()}}},
        {"libraries", {{"built", built_json()}, {"loaded", loaded_libraries()}}},
        {"cpu", record.cpu},
        {"cores", record.cores},
        {"threads", record.threads},
        {"machine", machine_json(record.machine)},
    };
    if (!record.gl_renderer.empty() || !record.gl_vendor.empty() || !record.gl_version.empty())
        json["gl"] = {{"vendor", record.gl_vendor}, {"renderer", record.gl_renderer}, {"version", record.gl_version}};
    json["datasets"] = Json::array();
    for (const std::string& dataset : *record.datasets) json["datasets"].push_back(Json::parse(dataset));
    json["config"] = object_of(record.config);
    for (const auto& [key, text] : record.more) json[key] = Json::parse(text);
    return json_text(json, 2, NotUtf8::replace) + "\n";
}

}  // namespace radiafit
