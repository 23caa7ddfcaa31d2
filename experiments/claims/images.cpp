#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.h"
#include "rules.h"

namespace radiafit::harness {
namespace {

/// A method of Figure 9 and its weights of smoothness, by the names in errors.csv.
struct Method {
    const char *name, *weights = "";
};
constexpr Method high{"cg-high", "chosen"}, high_weak{"cg-high", "0.0001"}, modern{"cg-modern-high", "chosen"},
    low{"cg-low", "chosen"}, low_brief{"cg-low-brief", "chosen"}, low_fp16{"cg-low-fp16", "chosen"};
constexpr const char *psnr = "train_psnr_db", *ape = "train_ape", *held_psnr = "held_psnr_db";

/// The rows of one term.
class OneTerm {
public:
    explicit OneTerm(const FinishedRun& run) : rows_(run.table("errors.csv")) {
        for (size_t i = 0; i < rows_.row_count(); ++i) {
            const std::string& dataset = rows_.text(i, "dataset");
            if (rows_.text(i, "seed").empty()) continue;  // a capture
            if (std::ranges::find(datasets_, dataset) == datasets_.end()) datasets_.push_back(dataset);
        }
    }
    const std::vector<std::string>& datasets() const { return datasets_; }

    /// The rows of every seed.
    std::vector<size_t> rows(const std::string& dataset, const Method& method) const {
        std::vector<size_t> found;
        for (size_t i = 0; i < rows_.row_count(); ++i)
            if (rows_.text(i, "terms") == "1" && rows_.text(i, "dataset") == dataset &&
                rows_.text(i, "method") == method.name && rows_.text(i, "weights") == method.weights)
                found.push_back(i);
        if (found.empty())
            throw UserError(
                fmt::format("errors.csv: no row of {}, {}, one term; run fig9_error again", dataset, method.name));
        return found;
    }
    /// Method a's figure less method b's, for each seed that both have.
    std::vector<double> differences(const std::string& dataset, const Method& a, const Method& b,
                                    const char* column) const {
        std::vector<double> out;
        for (const size_t i : rows(dataset, a))
            for (const size_t j : rows(dataset, b))
                if (rows_.text(i, "seed") == rows_.text(j, "seed"))
                    out.push_back(rows_.number(i, column) - rows_.number(j, column));
        return out;
    }
    Figure difference(const std::string& dataset, const Method& a, const Method& b, const char* column) const {
        return mean_of_seeds(differences(dataset, a, b, column));
    }
    /// Whether all rows of the method, whatever the dataset, have this text.
    bool all(const Method& method, const char* column, const std::string& text) const {
        return std::ranges::all_of(datasets_, [&](const std::string& dataset) {
            return std::ranges::all_of(rows(dataset, method), [&](size_t i) { return rows_.text(i, column) == text; });
        });
    }
    std::string text(const Method& method, const char* column) const {
        return rows_.text(rows(datasets_.front(), method).front(), column);
    }
    /// "76", or "67 to 76" where rows of the method differ.
    std::string range(const Method& method, const char* column) const {
        double least = INFINITY, most = 0;
        for (const std::string& dataset : datasets_)
            for (const size_t i : rows(dataset, method)) {
                least = std::min(least, rows_.number(i, column));
                most = std::max(most, rows_.number(i, column));
            }
        const std::string low = fmt::format("{:.0f}", least), high = fmt::format("{:.0f}", most);
        return low == high ? low : low + " to " + high;
    }
    size_t seeds() const { return rows(datasets_.front(), high).size(); }

    void demand_star_and_bust(Judgement& j) const {
        for (const char* name : {"star", "bust"})
            j.demand(std::ranges::find(datasets_, name) != datasets_.end(), fmt::format("the {}", name));
    }

private:
    CsvTable rows_;
    std::vector<std::string> datasets_;
};

/// Whether conjugate gradients' weights were taken from several by views that no figure is of.
bool weights_chosen(const FinishedRun& run, const std::string& dataset, const Method& method) {
    if (!run.has_table("choice.csv")) return false;
    const CsvTable trials = run.table("choice.csv");
    size_t count = 0;
    for (size_t i = 0; i < trials.row_count(); ++i)
        count += trials.text(i, "dataset") == dataset && trials.text(i, "method") == method.name;
    return count > 1;
}

void demand_chosen_weights(Judgement& j, const FinishedRun& run, const OneTerm& t,
                           std::initializer_list<Method> methods) {
    bool chosen = true;
    for (const std::string& dataset : t.datasets())
        for (const Method& method : methods) chosen = chosen && weights_chosen(run, dataset, method);
    j.demand(chosen, "weights of smoothness that were chosen on validation views");
}

std::string map_sizes(const OneTerm& t, const Method& method) {
    const int m = std::stoi(t.text(method, "view_side"));
    const std::string density = t.text(method, "texels_per_pixel");  // where each triangle has a separate side
    return fmt::format("{} texels in a surface map{} and {} in a view map", t.range(method, "surface_texels"),
                       density.empty() || std::stod(density) == 0 ? "" : " on average", m * m);
}

std::string signed_text(double value) { return fmt::format("{:+.2f}", value); }

Judgement above_pca(const FinishedRun& run) {
    const OneTerm t(run);
    constexpr Method published{"pca-published"}, refilled{"pca-refilled"};
    const std::pair<Method, const char*> rivals[] = {{published, "PCA as published"}, {refilled, "refilled PCA"}};
    const std::pair<Method, const char*> contenders[] = {
        {high, "chosen weights"}, {high_weak, "weights of 1e-4"}, {modern, "modern CG"}};
    Judgement j;
    std::vector<std::string> told;
    for (const std::string& dataset : t.datasets()) {
        std::vector<std::string> leads;
        for (const auto& [rival, name] : rivals) {
            const Figure lead = t.difference(dataset, high, rival, psnr),
                         less = t.difference(dataset, rival, high, ape);
            j.measures.push_back({fmt::format("{}, PSNR above {}", dataset, name), lead, at_least(0), {}, "dB"});
            j.measures.push_back({fmt::format("{}, APE below {}", dataset, name), less, at_least(0)});
            leads.push_back(fmt::format("{} dB of PSNR against {} (average error {} of 255)", signed_text(lead.value),
                                        name, signed_text(-less.value)));
        }
        for (const auto& [contender, what] : contenders) {
            const auto lead = [&](const Method& rival, const char* column) {
                return signed_text(t.difference(dataset, contender, rival, column).value);
            };
            j.beside.push_back(
                fmt::format("{}, {}: {} dB against PCA as published and {} dB against refilled PCA on training images; "
                            "{} and {} dB on held-out ones",
                            dataset, what, lead(published, psnr), lead(refilled, psnr), lead(published, held_psnr),
                            lead(refilled, held_psnr)));
        }
        told.push_back(fmt::format("on the {} by {}", dataset, fmt::join(leads, " and ")));
    }
    j.sentence = fmt::format(
        "With one term, {}, the paper's conjugate gradients after {} iterations differ from factorization (PCA), in "
        "the images that were fitted, {}; means over {} objects of each shape.",
        map_sizes(t, high), t.text(high, "iterations"), fmt::join(told, "; "), t.seeds());
    j.demand(t.all(high, "mode", "paper"), "the paper's conjugate gradients");
    demand_chosen_weights(j, run, t, {high});
    t.demand_star_and_bust(j);
    return j;
}

/// How the run's OpenGL rounds the 16-bit floats of its fits.
std::string rounding_of(const FinishedRun& run) {
    if (!run.has_table("halves.csv")) return "how its OpenGL rounds them was not measured then";
    const CsvTable rows = run.table("halves.csv");
    std::map<std::string, std::string> rounding;
    for (size_t i = 0; i < rows.row_count(); ++i) rounding[rows.text(i, "of")] = rows.text(i, "values");
    return fmt::format("its OpenGL rounds what it stores {}, and what it sums {}", rounding["storage"],
                       rounding["blended sum"]);
}

Judgement half_as_good(const FinishedRun& run) {
    const OneTerm t(run);
    Judgement j{.renderer = t.text(low_fp16, "renderer")};
    constexpr double tolerance = 0.2;  // dB
    bool settled = true;
    std::vector<std::string> told;
    for (const std::string& dataset : t.datasets()) {
        const Figure difference = t.difference(dataset, low_fp16, low_brief, psnr);
        j.measures.push_back({fmt::format("{}, OpenGL in 16 bits less the CPU in 32", dataset),
                              difference,
                              between(-tolerance, tolerance),
                              {},
                              "dB"});
        told.push_back(fmt::format("{:+.3f} dB of PSNR on the {}", difference.value, dataset));
        const double ahead = t.difference(dataset, low, low_brief, psnr).value;
        settled = settled && ahead <= tolerance;
        j.beside.push_back(
            fmt::format("{}: APE differs by {:+.3f}; the CPU's PSNR after {} iterations is {} dB of that after {}",
                        dataset, t.difference(dataset, low_fp16, low_brief, ape).value, t.text(low, "iterations"),
                        signed_text(ahead), t.text(low_brief, "iterations")));
    }
    j.sentence = fmt::format(
        "Conjugate gradients by the paper's passes, parameters and sums in 16-bit floats, differ from the CPU's in 32 "
        "bits by {} after {} iterations with one term, {}; {}; means over {} objects of each shape.",
        fmt::join(told, " and "), t.text(low_fp16, "iterations"), map_sizes(t, low_fp16), rounding_of(run), t.seeds());
    j.demand(
        t.all(low_fp16, "passes", "paper") && t.all(low_fp16, "mode", "paper") && t.all(low_brief, "mode", "paper"),
        "the paper's passes and conjugate gradients");
    j.demand(t.all(low_fp16, "storage", "fp16") && t.all(low_fp16, "sums", "fp16"), "16-bit floats throughout");
    j.demand(t.all(low_fp16, "iterations", t.text(low_brief, "iterations")), "as many iterations on both sides");
    j.demand(settled, fmt::format("fits that have settled: further iterations gain at most {} dB", tolerance));
    t.demand_star_and_bust(j);
    return j;
}

Judgement resolution_matters(const FinishedRun& run) {
    const OneTerm t(run);
    Judgement j;
    std::vector<std::string> told;
    for (const std::string& dataset : t.datasets()) {
        const Figure gain = t.difference(dataset, high, low, psnr);
        j.measures.push_back({fmt::format("{}, high less low resolution", dataset), gain, at_least(1), {}, "dB"});
        told.push_back(fmt::format("{:.2f} dB of PSNR on the {}", gain.value, dataset));
        j.beside.push_back(fmt::format("{}: {} dB on held-out images", dataset,
                                       signed_text(t.difference(dataset, high, low, held_psnr).value)));
    }
    j.sentence = fmt::format(
        "With one term and the images that were fitted, {} instead of {} gain {}; means over {} objects of each shape.",
        map_sizes(t, high), map_sizes(t, low), fmt::join(told, " and "), t.seeds());
    j.demand(t.all(high, "mode", "paper") && t.all(low, "mode", "paper"), "the paper's conjugate gradients");
    demand_chosen_weights(j, run, t, {high, low});
    t.demand_star_and_bust(j);
    return j;
}

}  // namespace

std::span<const Claim> images_claims() {
    static constexpr Claim table[] = {
        {"C8", "6.4, Fig. 9", "nonlinear optimization beats PCA at the same high resolution",
         "PSNR higher and APE lower, one term, training images, the paper's mode, weights chosen on validation views, "
         "than PCA as published and than PCA refilled; means over at least 3 seeds, on star and bust",
         "fig9_error", above_pca},
        {"C9", "6.4, Fig. 9", "the GPU at 16-bit floats about equals the CPU at low resolution",
         "one term, training images, the paper's mode and passes, 16-bit storage and sums: PSNR differs by at most "
         "0.2 dB after equally many iterations, past which the CPU's gains no more than that; means as for C8",
         "fig9_error", half_as_good},
        {"C21", "6.4", "errors at low resolution are much higher than at high",
         "at least 1 dB of PSNR, one term, training images, the paper's mode, weights chosen for each resolution; "
         "means as for C8",
         "fig9_error", resolution_matters},
    };
    return table;
}

}  // namespace radiafit::harness
