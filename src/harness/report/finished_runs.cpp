#include "report/finished_runs.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/error.h"
#include "base/json.h"
#include "base/machine.h"
#include "base/read_file.h"
#include "report/result_folder.h"
#include "report/row_files.h"

namespace radiafit::harness {
namespace fs = std::filesystem;
using nlohmann::json;
namespace {

constexpr int levels = 3;  // EXPERIMENT/DEVICE/RUN

/// What a field of run.json says. Throws UserError for one that is missing, or of another type.
template <class T>
T field(const json& object, const char* name, const fs::path& file) {
    const auto found = object.find(name);
    if (found != object.end()) {
        if constexpr (std::is_integral_v<T>) {
            if (found->is_number_integer()) return found->get<T>();
        } else if (found->is_string()) {
            return found->get<T>();
        }
    }
    throw UserError(fmt::format("{}: '{}' is missing or no {}; run the experiment again", file.string(), name,
                                std::is_integral_v<T> ? "whole number" : "text"));
}

bool holds_rows(const fs::path& folder) {
    return std::ranges::any_of(run_files(folder), [](const std::string& name) { return name.ends_with(".csv"); });
}

/// None where the folder holds no run, another profile's, or one of the checkout's settings where others are asked for,
/// and the other way round.
std::optional<RunRecord> run_of(const fs::path& folder, const std::string& profile, bool standard = true) {
    try {
        RunRecord run = read_run(folder);
        if (run.standard == standard && run.profile == profile) return run;
    } catch (const UserError&) {  // of an older version, or damaged
    }
    return std::nullopt;
}

void collect(const fs::path& folder, int below, std::vector<RunRecord>& runs) {
    if (path_exists(folder / run_record_name)) {
        runs.push_back(read_run(folder));
        return;
    }
    if (holds_rows(folder))
        throw UserError(
            fmt::format("{}: rows without their {}; run the experiment again", folder.string(), run_record_name));
    if (below == 0) return;
    for (const fs::path& inner : folders_in(folder)) collect(inner, below - 1, runs);
}

}  // namespace

std::string RunRecord::device() const {
    return fmt::format("{}, {} cores, {} threads{}", cpu, cores, threads, renderer.empty() ? "" : "; " + renderer);
}

RunRecord read_run(const fs::path& folder) {
    const fs::path file = folder / run_record_name;
    const std::string text = read_file(file, "record of a run");
    const json object = parse_json<json>(text, 64);
    if (!object.is_object())
        throw UserError(fmt::format("{}: no JSON object; run the experiment again", file.string()));
    RunRecord run{.folder = folder,
                  .experiment = field<std::string>(object, "program", file),
                  .utc = field<std::string>(object, "utc_start", file),
                  .revision = field<std::string>(object, "git_revision", file),
                  .profile = field<std::string>(object, "profile", file),
                  .compiler = field<std::string>(object, "compiler", file),
                  .cpu = field<std::string>(object, "cpu", file)};
    if (const auto machine = object.find("machine"); machine != object.end() && machine->is_object())
        run.cpu =
            processor_name(run.cpu, field<std::string>(*machine, "cpu_id", file));  // older runs have the bare name
    run.cores = field<int>(object, "cores", file);
    run.threads = field<int>(object, "threads", file);
    if (object.contains("caption")) run.caption = field<std::string>(object, "caption", file);
    run.standard = object.value("standard", json(true)) != json(false);
    run.rounds_left_out = object.value("rounds_left_out", json(false)) == json(true);
    const auto gl = object.find("gl");
    if (gl != object.end() && gl->is_object()) run.renderer = field<std::string>(*gl, "renderer", file);
    const auto take = [&](const char* name, std::map<std::string, std::string>& texts) {
        const auto found = object.find(name);
        if (found == object.end() || !found->is_object())
            throw UserError(
                fmt::format("{}: '{}' is missing or no object; run the experiment again", file.string(), name));
        for (const auto& [key, value] : found->items()) texts[key] = json_text(value, -1, NotUtf8::replace);
    };
    take("config", run.config);
    if (object.contains("files")) take("files", run.files);
    return run;
}

std::vector<RunRecord> find_runs(const fs::path& folder) {
    if (!folder_exists(folder)) throw UserError(fmt::format("{}: no such folder; check the path", folder.string()));
    std::vector<RunRecord> runs;
    collect(folder, levels, runs);
    if (!path_exists(folder / run_record_name)) std::erase_if(runs, [](const RunRecord& run) { return !run.standard; });
    if (runs.empty())
        throw UserError(fmt::format(
            "{}: no run in it or up to three folders down; name a folder with a {}, or one that holds such folders",
            folder.string(), run_record_name));
    std::ranges::sort(runs, std::ranges::greater(),
                      [](const RunRecord& run) { return std::pair(run.utc, run.folder); });
    return runs;
}

std::vector<RunRecord> newest_runs(const fs::path& root, const std::string& experiment, const std::string& profile) {
    std::vector<RunRecord> result;
    for (const fs::path& device : folders_in(root / experiment)) {
        std::vector<fs::path> runs = folders_in(device);
        std::ranges::reverse(runs);  // names start with the time in a form that sorts
        std::optional<RunRecord> newest;
        for (const fs::path& folder : runs) {
            auto run = run_of(folder, profile);
            if (!run || (newest && run->rounds_left_out)) continue;
            newest = std::move(run);
            if (!newest->rounds_left_out) break;
        }
        if (newest) result.push_back(*std::move(newest));
    }
    return result;
}

std::vector<RunRecord> varied_runs(const fs::path& root, const std::string& experiment, const std::string& profile) {
    std::vector<RunRecord> result;
    for (const fs::path& device : folders_in(root / experiment)) {
        std::vector<fs::path> runs = folders_in(device);
        std::ranges::reverse(runs);
        for (const fs::path& folder : runs) {
            auto run = run_of(folder, profile, false);
            if (run && std::ranges::none_of(result, [&](const RunRecord& other) { return other.alike(*run); }))
                result.push_back(*std::move(run));
        }
    }
    return result;
}

}  // namespace radiafit::harness
