#include "finished_run.h"

#include <fmt/format.h>

#include <fstream>

#include "base/error.h"
#include "report/row_files.h"

namespace radiafit {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

FinishedRun::FinishedRun(fs::path folder, const fs::path& checkout)
    : folder_(std::move(folder)), name_(fs::relative(folder_, checkout).generic_string()) {
    std::ifstream file(folder_ / "run.json");
    json_ = Json::parse(file, nullptr, false);
    if (!json_.is_object())
        throw UserError(fmt::format("{}: no JSON object; delete the run", (folder_ / "run.json").string()));
}

std::string FinishedRun::device() const {
    if (json_.contains("gl")) return json_.at("gl").at("renderer").get<std::string>();
    return fmt::format("{}, {} threads", cpu(), threads());
}

double FinishedRun::setting(const char* key) const {
    const Json config = json_.value("config", Json::object());
    if (!config.contains(key) || !config.at(key).is_number())
        throw UserError(fmt::format("{}: config.{} is missing; run the experiment again", name(), key));
    return config.at(key).get<double>();
}

std::string FinishedRun::text(const char* key) const {
    const Json config = json_.value("config", Json::object());
    return config.contains(key) && config.at(key).is_string() ? config.at(key).get<std::string>() : "";
}

CsvTable FinishedRun::table(const std::string& file) const { return read_rows(folder_, file); }

bool FinishedRun::has_table(const std::string& file) const { return has_run_file(folder_, file); }

std::vector<std::string> FinishedRun::tables(const std::string& ending) const {
    std::vector<std::string> names;
    for (const std::string& name : run_files(folder_))
        if (name.ends_with(ending)) names.push_back(name);
    return names;
}

std::vector<double> column(const CsvTable& table, const char* name) {
    std::vector<double> values;
    for (size_t i = 0; i < table.row_count(); ++i) values.push_back(table.number(i, name));
    return values;
}

}  // namespace radiafit
