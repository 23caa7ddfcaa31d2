#include "batch/problem_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <unordered_map>

#include "base/csv_record.h"
#include "base/error.h"
#include "base/text_file.h"

namespace radiafit::batch {
namespace {

using std::filesystem::path;

/// Whether a number stays finite, and another than 0, as a real.
template <class real>
bool held_by(double x) {
    return !std::isfinite(x) || (std::isfinite(real(x)) && (real(x) != 0) == (x != 0));
}

/// Fields of a record without the blanks around them.
std::vector<std::string> fields_of(std::string_view line, const TextFile& text) {
    std::optional<std::vector<std::string>> out = take_csv_record(line);
    if (!out) text.fail("a quote is never closed on this line; close it");
    for (std::string& field : *out) {
        field.erase(0, std::min(field.find_first_not_of(" \t"), field.size()));
        field.resize(field.find_last_not_of(" \t") + 1);
    }
    return *std::move(out);
}

}  // namespace

template <class real>
StoredProblems<real> read_problem_table(const path& file, const ModelText& model) {
    TextFile text(file, "table of problems");
    std::string_view line;
    const auto next_row = [&] {
        while (text.next_line(line))
            if (!line.empty()) return true;
        return false;
    };
    if (!next_row()) throw UserError(file.string() + ": empty; its first line names the columns");
    const std::vector<std::string> columns = fields_of(line, text);
    const auto column = [&](const std::string& name) {
        return size_t(std::ranges::find(columns, name) - columns.begin());
    };
    const auto require_columns = [&](const std::vector<std::string>& names) {
        std::vector<size_t> out;
        for (const std::string& name : names) {
            out.push_back(column(name));
            if (out.back() == columns.size())
                text.fail(
                    fmt::format("no column '{}', which the model has; there are: {}", name, fmt::join(columns, ", ")));
        }
        return out;
    };
    const std::vector<size_t> terms = require_columns(model.terms), values = require_columns(model.values);
    // a column that the model names is that alone
    const auto unless_named = [&](const std::string& name) {
        return std::ranges::count(model.terms, name) || std::ranges::count(model.values, name) ? columns.size()
                                                                                               : column(name);
    };
    const size_t weight = unless_named("weight"), problem = unless_named("problem");

    struct Rows {
        std::vector<real> terms, targets, weights;
    };
    std::vector<Rows> rows;
    std::unordered_map<std::string, size_t> place;
    StoredProblems<real> out;
    while (next_row()) {
        const std::vector<std::string> fields = fields_of(line, text);
        if (fields.size() != columns.size())
            text.fail(fmt::format("{} fields, where there are {} columns", fields.size(), columns.size()));
        const auto number = [&](size_t i) {
            const std::string& field = fields[i];
            if (field.empty() || field == "nan" || field == "NaN" || field == "NA")
                return std::numeric_limits<real>::quiet_NaN();
            const double number = text.to_double(field, columns[i].c_str());
            if (!held_by<real>(number))
                text.fail(fmt::format("{} = {} is beyond what floats hold; fit in doubles", columns[i], number));
            return real(number);
        };
        const std::string label = problem < columns.size() ? fields[problem] : "";
        const auto [found, added] = place.try_emplace(label, rows.size());
        if (added) rows.emplace_back(), out.labels.push_back(label);
        Rows& own = rows[found->second];
        for (const size_t i : terms) own.terms.push_back(number(i));
        for (const size_t i : values) own.targets.push_back(number(i));
        if (weight < columns.size()) own.weights.push_back(number(weight));
    }
    if (rows.empty()) throw UserError(file.string() + ": no rows");
    out.count = rows.size();
    out.offsets.push_back(0);
    for (const Rows& own : rows) {
        out.terms.insert(out.terms.end(), own.terms.begin(), own.terms.end());
        out.targets.insert(out.targets.end(), own.targets.begin(), own.targets.end());
        out.weights.insert(out.weights.end(), own.weights.begin(), own.weights.end());
        out.offsets.push_back(out.offsets.back() + int64_t(own.targets.size() / model.values.size()));
    }
    return out;
}

template StoredProblems<float> read_problem_table(const path&, const ModelText&);
template StoredProblems<double> read_problem_table(const path&, const ModelText&);

}  // namespace radiafit::batch
