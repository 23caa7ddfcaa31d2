#include "finished_run.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/error.h"

namespace radiafit::harness {
namespace {

/// Null if there is none.
nlohmann::json config_value(const RunRecord& record, const char* key) {
    const auto found = record.config.find(key);
    return found == record.config.end() ? nlohmann::json() : nlohmann::json::parse(found->second);
}

}  // namespace

FinishedRun::FinishedRun(RunRecord record, const std::filesystem::path& checkout) : record_(std::move(record)) {
    namespace fs = std::filesystem;
    fs::path name = fs::relative(record_.folder, checkout);
    if (*name.begin() == "..") {  // from elsewhere, such as an archive: RESULTS/EXPERIMENT/DEVICE/RUN
        name.clear();
        fs::path rest = record_.folder;
        for (int level = 0; level < 4; ++level, rest = rest.parent_path()) name = rest.filename() / name;
        name = name.parent_path();  // without the separator at its end
    }
    name_ = name.generic_string();
}

std::string FinishedRun::device() const {
    if (!record_.renderer.empty()) return record_.renderer;
    return fmt::format("{}, {} threads", record_.cpu, record_.threads);
}

double FinishedRun::setting(const char* key) const {
    const nlohmann::json value = config_value(record_, key);
    if (!value.is_number())
        throw UserError(fmt::format("{}: config.{} is missing; run the experiment again", name(), key));
    return value.get<double>();
}

std::string FinishedRun::text(const char* key) const {
    const nlohmann::json value = config_value(record_, key);
    return value.is_string() ? value.get<std::string>() : "";
}

std::vector<double> column(const CsvTable& table, const char* name) {
    std::vector<double> values;
    for (size_t i = 0; i < table.row_count(); ++i) values.push_back(table.number(i, name));
    return values;
}

}  // namespace radiafit::harness
