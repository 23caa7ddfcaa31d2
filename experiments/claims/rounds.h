#pragma once
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <map>

#include "base/error.h"
#include "rules.h"

/// Timed rows, round by round: what is compared is taken within one round.
namespace radiafit::harness {

inline constexpr const char* optimizers[] = {"sd", "cg"};
inline constexpr const char* problems[] = {"light field map", "Lafortune"};

inline bool is_descent(const std::string& optimizer) { return optimizer == optimizers[0]; }
inline std::string upper(const std::string& optimizer) { return is_descent(optimizer) ? "SD" : "CG"; }

/// Texts that columns hold.
using Where = std::vector<std::pair<const char*, std::string>>;

inline bool has_rows_where(const CsvTable& t, const Where& where) {
    for (size_t i = 0; i < t.row_count(); ++i)
        if (std::ranges::all_of(where, [&](const auto& pair) { return t.text(i, pair.first) == pair.second; }))
            return true;
    return false;
}

/// Rows where they do. Throws UserError if there are none.
inline std::vector<size_t> rows_where(const CsvTable& t, const Where& where) {
    std::vector<size_t> rows;
    for (size_t i = 0; i < t.row_count(); ++i)
        if (std::ranges::all_of(where, [&](const auto& pair) { return t.text(i, pair.first) == pair.second; }))
            rows.push_back(i);
    if (!rows.empty()) return rows;
    std::vector<std::string> texts;
    for (const auto& [column, text] : where) texts.push_back(text);
    throw UserError(fmt::format("no row of {}; run the experiment again", fmt::join(texts, ", ")));
}

/// The paper's ornament has 0.98 GB of images; what costs once an iteration is spread over them.
inline void need_all_images(Evidence& e, const FinishedRun& run) {
    constexpr double least = 350;
    const double images = run.setting("reflectance_images");
    e.premise("350 images", images == 0 || images >= least,
              fmt::format("{:g} images of the ornament at least, not {:g}", least, images));
}

/// A figure by repetition: what is compared is taken within one round.
using Rounds = std::map<int, double>;
using RowValue = std::function<double(size_t row)>;

inline Rounds rounds(const CsvTable& t, const Where& where, const RowValue& value) {
    Rounds out;
    for (const size_t row : rows_where(t, where)) out[int(t.number(row, "repetition"))] = value(row);
    return out;
}
inline Rounds rounds(const CsvTable& t, const Where& where, const char* column) {
    return rounds(t, where, [&](size_t row) { return t.number(row, column); });
}

inline std::vector<double> values(const Rounds& rounds) {
    std::vector<double> out;
    for (const auto& [round, value] : rounds) out.push_back(value);
    return out;
}
inline double median_of(const Rounds& rounds) { return median(values(rounds)); }

/// operation(a, b) for each of the rounds that both have.
template <class Operation>
inline std::vector<double> each(const Rounds& a, const Rounds& b, const Operation& operation) {
    std::vector<double> out;
    for (const auto& [round, value] : a)
        if (const auto other = b.find(round); other != b.end()) out.push_back(operation(value, other->second));
    return out;
}
/// Those of a's rounds that b has, too.
inline Rounds shared(const Rounds& a, const Rounds& b) {
    Rounds out = a;
    std::erase_if(out, [&](const auto& one) { return !b.contains(one.first); });
    return out;
}
inline std::vector<double> ratios(const Rounds& a, const Rounds& b) { return each(a, b, std::divides()); }

}  // namespace radiafit::harness
