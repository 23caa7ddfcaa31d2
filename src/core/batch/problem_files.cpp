#include "batch/problem_files.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <unordered_map>

#include "base/csv_record.h"
#include "base/error.h"
#include "base/npy_file.h"
#include "base/read_file.h"
#include "base/text_file.h"
#include "base/wording.h"
#include "batch/arrange.h"

namespace radiafit::batch {
namespace {

using std::filesystem::path;

template <class Number>
ShapedArray<Number> shaped(const NpyReader& file, std::vector<Number>& numbers) {
    numbers = file.read<Number>();
    return {file.file(), file.shape(), numbers};
}

template <class real>
StoredProblems<real> read_folder(const path& folder, const ModelText& model) {
    StoredProblems<real> out;
    const auto file = [&](const char* name) { return NpyReader(folder / fmt::format("{}.npy", name), name); };
    const auto there = [&](const char* name) { return path_exists(folder / fmt::format("{}.npy", name)); };
    ProblemArrays<real> arrays{.terms = shaped(file("terms"), out.terms),
                               .targets = shaped(file("targets"), out.targets)};
    if (there("weights")) arrays.weights = shaped(file("weights"), out.weights);
    if (there("offsets")) arrays.offsets = shaped(file("offsets"), out.offsets);
    if (there("start")) arrays.starts = shaped(file("start"), out.starts);
    const Problems<real> problems = arranged(model, arrays);
    out.count = problems.count;
    out.samples = problems.samples;
    out.start_count = problems.start_count;
    return out;
}

/// Texels as `export problems` writes them: the model's terms are among u_x to v_z, of the directions to lamp and
/// camera.
template <class real>
StoredProblems<real> read_exported(const path& folder, const ModelText& model) {
    static const std::vector<std::string> columns = {"u_x", "u_y", "u_z", "v_x", "v_y", "v_z"};
    const auto file = [&](const std::string& name) {
        return NpyReader(folder / fmt::format("training_{}.npy", name), "array of a texel-local model's problems");
    };
    StoredProblems<real> out;
    const NpyReader u = file("u"), v = file("v"), targets = file("target"), weights = file("weight"),
                    first = file("first");
    const std::vector<real> directions[] = {u.read<real>(), v.read<real>()};
    const size_t samples = directions[0].size() / 3;
    if (directions[1].size() != 3 * samples) throw UserError(fmt::format("{}: not as long as {}", v.file(), u.file()));
    for (const std::string& name : model.terms)
        if (!std::ranges::count(columns, name))
            throw UserError(
                fmt::format("{}: has no term '{}'; there are: {}", folder.string(), name, fmt::join(columns, ", ")));
    for (size_t s = 0; s < samples; ++s)
        for (const std::string& name : model.terms) {
            const size_t column = size_t(std::ranges::find(columns, name) - columns.begin());
            out.terms.push_back(directions[column / 3][3 * s + column % 3]);
        }
    const ProblemArrays<real> arrays{.terms = {u.file(), {samples, model.terms.size()}, out.terms},
                                     .targets = shaped(targets, out.targets),
                                     .weights = shaped(weights, out.weights),
                                     .offsets = shaped(first, out.offsets)};
    out.count = arranged(model, arrays).count;
    return out;
}

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

template <class real>
StoredProblems<real> read_table(const path& file, const ModelText& model) {
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

}  // namespace

template <class real>
StoredProblems<real> read_problems(const path& input, const ModelText& model, const ByName& start) {
    if (!path_exists(input)) throw UserError(input.string() + ": no such file or folder");
    const auto read = !folder_exists(input)                  ? read_table<real>
                      : path_exists(input / "problems.json") ? read_exported<real>
                                                             : read_folder<real>;
    StoredProblems<real> out = read(input, model);
    const size_t parameters = model.parameters.size();
    if (out.starts.empty()) out.starts.assign(parameters, std::numeric_limits<real>::quiet_NaN());
    const std::vector<double> given = of_parameters(model, "start", start, std::numeric_limits<double>::quiet_NaN());
    std::vector<std::string> missing;
    for (size_t i = 0; i < parameters; ++i) {
        for (size_t k = i; !std::isnan(given[i]) && k < out.starts.size(); k += parameters)
            out.starts[k] = real(given[i]);
        if (out.starts.size() == parameters && std::isnan(out.starts[i])) missing.push_back(model.parameters[i]);
    }
    if (!missing.empty()) {
        const std::string names = fmt::format("{}", fmt::join(missing, ", "));
        const std::string values = fmt::format("{}=VALUE", fmt::join(missing, "=VALUE,"));
        throw UserError(fmt::format("{}: says not where fits begin in {}; {}", input.string(), names,
                                    at_command_line("give --start " + values, "give starts")));
    }
    return out;
}

template StoredProblems<float> read_problems(const path&, const ModelText&, const ByName&);
template StoredProblems<double> read_problems(const path&, const ModelText&, const ByName&);

}  // namespace radiafit::batch
