#include "cli/solution_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/json.h"
#include "base/read_file.h"

namespace radiafit::tools {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using batch::BatchStatus;

constexpr const char* solution_format = "radiafit-solution";
constexpr const char* table_name = "solution.csv";

/// As JSON; a model's comments may be in another encoding than UTF-8.
template <class Value>
std::string dumped(const Value& value) {
    return Json(value).dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::vector<std::string> columns_of(const batch::ModelText& model) {
    std::vector<std::string> out = {"problem"};
    for (const std::string& name : model.parameters) out.insert(out.end(), {name, "sigma_" + name});
    out.insert(out.end(), {"error", "samples", "iterations", "status"});
    return out;
}

[[noreturn]] void throw_damaged(const fs::path& file) {
    throw UserError(file.string() + ": damaged; make the shard anew, by its command with --replace");
}

/// The numbers of a shard's array. Throws UserError unless it has this shape.
template <class T, class Stored = T>
std::vector<T> array_of(const fs::path& folder, const char* name, const std::vector<uint64_t>& shape) {
    const NpyReader file(folder / fmt::format("{}.npy", name), name);
    if (file.shape() != shape || file.type() != npy_type<Stored>()) throw_damaged(folder / fmt::format("{}.npy", name));
    return file.read<T>();
}

template <class real>
batch::Solution<real> read_solution(const fs::path& folder, const SolutionNote& note) {
    const uint64_t n = note.problems, p = note.model.parameters.size();
    batch::Solution<real> out{.parameters = array_of<real>(folder, "parameters", {n, p}),
                              .deviations = array_of<real>(folder, "sigma", {n, p}),
                              .covariance = array_of<real>(folder, "covariance", {n, p, p}),
                              .error = array_of<real>(folder, "chi2", {n}),
                              .status = {},
                              .steps = {},
                              .samples = array_of<int64_t>(folder, "samples", {n})};
    for (const int64_t s : array_of<int64_t, int32_t>(folder, "status", {n})) {
        if (s < 0 || s >= int64_t(BatchStatus::count)) throw_damaged(folder / "status.npy");
        out.status.push_back(int32_t(s));
    }
    for (const int64_t s : array_of<int64_t, int32_t>(folder, "iterations", {n})) out.steps.push_back(int32_t(s));
    return out;
}

/// The first field of each row: which problems a table's rows were of.
std::vector<std::string> labels_in(const fs::path& folder, const SolutionNote& note) {
    if (!note.labelled) return {};
    const harness::CsvTable table(folder / table_name);
    std::vector<std::string> out;
    for (size_t i = 0; i < table.row_count(); ++i) out.push_back(table.text(i, "problem"));
    if (out.size() != note.problems) throw_damaged(folder / table_name);
    return out;
}

template <class real>
void merge(const std::map<int, fs::path>& folders, const std::map<fs::path, SolutionNote>& notes,
           const SolutionNote& whole, const fs::path& target, const Record& record) {
    SolutionFolder<real> out(target, whole);
    for (const auto& [index, folder] : folders)
        out.add(read_solution<real>(folder, notes.at(folder)), labels_in(folder, notes.at(folder)));
    out.commit(whole, record);
}

}  // namespace

std::string statuses_json(const std::vector<size_t>& counts) {
    auto json = Json::object();
    for (size_t s = 0; s < counts.size(); ++s) json[batch::name_of(BatchStatus(s))] = counts[s];
    return json.dump();
}

uint64_t solution_bytes(const SolutionNote& note) {
    const uint64_t p = note.model.parameters.size();
    const uint64_t real = note.precision == batch::Precision::double_precision ? 8 : 4;
    return (p * p + 2 * p + 1) * real + 2 * sizeof(int32_t) + sizeof(int64_t);
}

template <class real>
SolutionFolder<real>::SolutionFolder(const fs::path& target, const SolutionNote& note)
    : folder_(target, solution_format),
      parameters_(folder_.open<real>("parameters", {note.problems, note.model.parameters.size()},
                                     "of the best end of each problem, as `parameters` names them")),
      sigma_(folder_.open<real>("sigma", {note.problems, note.model.parameters.size()},
                                "standard deviations; 0: fixed, or at a bound; infinite: not determined")),
      covariance_(folder_.open<real>("covariance",
                                     {note.problems, note.model.parameters.size(), note.model.parameters.size()},
                                     "of the parameters")),
      chi2_(folder_.open<real>("chi2", {note.problems}, "sum of weight times squared residual, or of the loss")),
      status_(folder_.open<int32_t>("status", {note.problems}, "how each ended, as `statuses` names them from 0 on")),
      iterations_(folder_.open<int32_t>("iterations", {note.problems}, "steps tried, of the best start")),
      samples_(folder_.open<int64_t>("samples", {note.problems}, "that are not missing")) {
    if (note.labelled) table_.emplace(folder_.path() / table_name, columns_of(note.model));
}

template <class real>
void SolutionFolder<real>::add(const batch::Solution<real>& solution, const std::vector<std::string>& labels) {
    parameters_.write(solution.parameters);
    sigma_.write(solution.deviations);
    covariance_.write(solution.covariance);
    chi2_.write(solution.error);
    status_.write(solution.status);
    iterations_.write(solution.steps);
    samples_.write(solution.samples);
    if (!table_) return;
    const size_t parameters = solution.parameters.size() / std::max<size_t>(1, labels.size());
    for (size_t i = 0; i < labels.size(); ++i) {
        std::vector<std::string> row = {labels[i]};
        for (size_t k = i * parameters; k < (i + 1) * parameters; ++k)
            for (const real x : {solution.parameters[k], solution.deviations[k]}) row.push_back(fmt::format("{}", x));
        row.insert(row.end(), {fmt::format("{}", solution.error[i]), std::to_string(solution.samples[i]),
                               std::to_string(solution.steps[i]), batch::name_of(BatchStatus(solution.status[i]))});
        table_->row(row);
    }
}

template <class real>
void SolutionFolder<real>::commit(const SolutionNote& note, const Record& record) {
    parameters_.close();
    sigma_.close();
    covariance_.close();
    chi2_.close();
    status_.close();
    iterations_.close();
    samples_.close();
    if (table_) table_->commit();
    folder_.tell("model", dumped(note.model.text));
    folder_.tell("parameters", dumped(note.model.parameters));
    folder_.tell("terms", dumped(note.model.terms));
    folder_.tell("values", dumped(note.model.values));
    folder_.tell("statuses", statuses_json(note.statuses));
    folder_.tell("seconds", dumped(note.seconds));
    folder_.tell("table", dumped(note.labelled));
    if (note.shard) {
        folder_.tell("shard", dumped(std::vector{note.shard->index, note.shard->count}));
        folder_.tell("key", note.key);
    }
    folder_.commit(record);
}

template class SolutionFolder<float>;
template class SolutionFolder<double>;

void print_solution(const SolutionNote& note, bool json) {
    if (json) {
        const Json statuses = Json::parse(statuses_json(note.statuses));
        fmt::print("{}\n", Json{{"problems", note.problems}, {"seconds", note.seconds}, {"statuses", statuses}}.dump());
        return;
    }
    fmt::print("{} problems in {:.3g} s", note.problems, note.seconds);
    if (note.seconds > 0) fmt::print(": {:.3g} a second", double(note.problems) / note.seconds);
    fmt::print("\n");
    for (size_t s = 0; s < note.statuses.size(); ++s)
        if (note.statuses[s] > 0)
            fmt::print("  {} {}: {}\n", note.statuses[s], batch::name_of(BatchStatus(s)),
                       batch::meaning_of(BatchStatus(s)));
}

SolutionNote read_solution_shard(const fs::path& folder) {
    const fs::path file = folder / solution_json_name;
    if (!folder_exists(folder)) throw UserError(folder.string() + ": missing; run its shard's command");
    if (!path_exists(file))
        throw UserError(folder.string() + ": no shard of a solution; give folders that radiafit solve --shard wrote");
    const Json json = parse_json<Json>(read_file(file, "solution's description"));
    SolutionNote out;
    try {
        if (json.at("format") != solution_format || json.at("version") != problem_folder_version) throw_damaged(file);
        if (!json.contains("shard"))
            throw UserError(folder.string() + ": a whole solution; give folders that radiafit solve --shard wrote");
        const auto whole = [&](const Json& number, uint64_t most) {
            if (!number.is_number_unsigned() || number.get<uint64_t>() > most) throw_damaged(file);
            return number.get<uint64_t>();
        };
        const Json& shard = json.at("shard");
        constexpr uint64_t most_shards = std::numeric_limits<int>::max();
        out.shard = Shard{int(whole(shard.at(0), most_shards)), int(whole(shard.at(1), most_shards))};
        if (out.shard->index < 1 || out.shard->index > out.shard->count) throw_damaged(file);
        out.key = json.at("key").dump();
        out.model = batch::read_model(folder.string(), json.at("model").get<std::string>());
        const Json& chi2 = json.at("arrays").at("chi2");
        const bool doubles = chi2.at("dtype") == npy_type<double>();
        if (!doubles && chi2.at("dtype") != npy_type<float>()) throw_damaged(file);
        out.precision = doubles ? batch::Precision::double_precision : batch::Precision::single_precision;
        out.problems = whole(chi2.at("shape").at(0), std::numeric_limits<int64_t>::max());
        out.labelled = json.at("table").get<bool>();
        out.seconds = json.at("seconds").get<double>();
        uint64_t left = out.problems;
        for (const auto& [name, count] : json.at("statuses").items()) {
            out.statuses.push_back(whole(count, left));
            left -= out.statuses.back();
        }
        if (out.statuses.size() != size_t(BatchStatus::count) || left > 0) throw_damaged(file);
    } catch (const Json::exception&) {
        throw_damaged(file);
    }
    return out;
}

SolutionNote merge_solutions(const std::vector<fs::path>& shards, const fs::path& target, const Record& record) {
    std::vector<ShardFolder> folders;
    std::map<fs::path, SolutionNote> notes;
    for (const fs::path& folder : shards) {
        const SolutionNote note = read_solution_shard(folder);
        folders.push_back({folder, *note.shard, note.key});
        notes.emplace(folder, note);
    }
    const auto in_order = whole_of_shards(folders, folders.front().key);
    SolutionNote whole = notes.at(shards.front());
    whole.shard.reset();
    whole.problems = 0;
    whole.seconds = 0;
    whole.statuses.assign(size_t(BatchStatus::count), 0);
    for (const auto& [folder, note] : notes) {
        if (note.precision != whole.precision) throw_damaged(folder / solution_json_name);
        whole.problems += note.problems;
        whole.seconds += note.seconds;
        for (size_t s = 0; s < whole.statuses.size(); ++s) whole.statuses[s] += note.statuses[s];
    }
    if (whole.precision == batch::Precision::double_precision)
        merge<double>(in_order, notes, whole, target, record);
    else
        merge<float>(in_order, notes, whole, target, record);
    return whole;
}

}  // namespace radiafit::tools
