#include "environment_part.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/read_file.h"
#include "page/html_table.h"
#include "pieces.h"

namespace radiafit::harness {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// read_run() has found an object in it.
json record_of(const RunRecord& run) {
    return json::parse(read_file(run.folder / "run.json", "record of a run"), nullptr, false);
}

/// A field within objects, as a person would write it; empty if it isn't there.
std::string text_at(const json& record, const char* pointer) {
    const json::json_pointer at(pointer);
    if (!record.is_object() || !record.contains(at)) return "";
    const json& value = record.at(at);
    return value.is_string() ? value.get<std::string>() : value.is_null() ? "" : value.dump();
}

double number_at(const json& record, const char* pointer) {
    const json::json_pointer at(pointer);
    return record.is_object() && record.contains(at) && record.at(at).is_number() ? record.at(at).get<double>() : 0;
}

std::string seconds_text(double seconds) {
    return seconds < 60     ? fmt::format("{:.0f} s", seconds)
           : seconds < 3600 ? fmt::format("{:.0f} min", seconds / 60)
                            : fmt::format("{:.1f} h", seconds / 3600);
}

std::string libraries_of(const json& record) {
    const json::json_pointer at("/libraries/built");
    if (!record.is_object() || !record.contains(at) || !record.at(at).is_object()) return "";
    std::vector<std::string> names;
    for (const auto& [name, version] : record.at(at).items())
        names.push_back(fmt::format("{} {}", name, version.is_string() ? version.get<std::string>() : version.dump()));
    return fmt::format("{}", fmt::join(names, ", "));
}

/// What runs of one build on one machine share.
using Environment = std::vector<std::pair<const char*, std::string>>;

Environment environment_of(const RunRecord& run, const json& record) {
    const double memory = number_at(record, "/machine/memory_bytes");
    Environment all = {{"Processor", fmt::format("{}, {} cores", run.cpu, run.cores)},
                       {"Memory", memory > 0 ? fmt::format("{:.1f} GB", memory / 1e9) : ""},
                       {"System", text_at(record, "/machine/distribution")},
                       {"Kernel", text_at(record, "/machine/kernel")},
                       {"Virtual machine", text_at(record, "/machine/hypervisor")},
                       {"Container", text_at(record, "/machine/container")},
                       {"Compiler", run.compiler},
                       {"Libraries", libraries_of(record)}};
    std::erase_if(all, [](const auto& one) { return one.second.empty(); });
    return all;
}

std::string command_of(const json& record) {
    std::string command = text_at(record, "/program");
    if (record.is_object() && record.contains("arguments") && record["arguments"].is_array())
        for (const json& argument : record["arguments"])
            if (argument.is_string()) command += " " + argument.get<std::string>();
    return command;
}

}  // namespace

Html environment_part(std::span<const RunRecord> runs, const fs::path& checkout) {
    if (runs.empty()) return not_run("no run to tell the environment of; make experiments");
    std::vector<Environment> environments;
    std::vector<HtmlRow> rows;
    for (const RunRecord& run : runs) {
        const json record = record_of(run);
        const Environment environment = environment_of(run, record);
        const auto found = std::ranges::find(environments, environment);
        const auto place = size_t(found - environments.begin()) + 1;
        if (found == environments.end()) environments.push_back(environment);
        std::string gl = text_at(record, "/gl/renderer");
        if (const std::string version = text_at(record, "/gl/version"); !version.empty()) gl += "; OpenGL " + version;
        const std::vector<Html> fields = {run.experiment,
                                          run.profile,
                                          run.utc,
                                          seconds_text(number_at(record, "/wall_s")),
                                          link(fmt::format("#environment-{}", place), std::to_string(place)),
                                          gl,
                                          std::to_string(run.threads),
                                          run.revision,
                                          element("code", command_of(record)),
                                          element("code", fs::relative(run.folder, checkout).generic_string())};
        rows.push_back({{fields.begin(), fields.end()}});
    }
    Html part;
    for (size_t i = 0; i < environments.size(); ++i) {
        Html list;
        for (const auto& [name, text] : environments[i]) list << element("dt", name) << element("dd", text);
        part << element("h3", {{"id", fmt::format("environment-{}", i + 1)}}, fmt::format("Environment {}", i + 1))
             << element("dl", list);
    }
    part << element("h3", "The runs shown");
    return part << scroll_box(
               "the runs shown",
               html_table("Everything else that a run was made with is in its run.json (docs/formats.md).",
                          {"experiment", "profile", "begun", "took", "environment", "renderer", "threads", "revision",
                           "command", "folder"},
                          rows, {}, {{"class", "sortable"}}));
}

}  // namespace radiafit::harness
