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

    void need_star_and_bust(Evidence& e) const {
        for (const std::string name : {"star", "bust"})
            e.premise("the " + name, std::ranges::find(datasets_, name) != datasets_.end(), "the " + name);
    }

private:
    CsvTable rows_;
    std::vector<std::string> datasets_;
};

/// Whether a method's weights or refills were taken from several by views that no figure is of.
bool chosen(const FinishedRun& run, const std::string& dataset, const char* method) {
    if (!run.has_table("choice.csv")) return false;
    const CsvTable trials = run.table("choice.csv");
    size_t count = 0;
    for (size_t i = 0; i < trials.row_count(); ++i)
        count += trials.text(i, "dataset") == dataset && trials.text(i, "method") == method;
    return count > 1;
}

bool all_chosen(const FinishedRun& run, const OneTerm& t, std::initializer_list<const char*> methods) {
    return std::ranges::all_of(t.datasets(), [&](const std::string& dataset) {
        return std::ranges::all_of(methods, [&](const char* method) { return chosen(run, dataset, method); });
    });
}

void need_chosen_weights(Evidence& e, const FinishedRun& run, const OneTerm& t,
                         std::initializer_list<const char*> methods) {
    e.premise("weights chosen", all_chosen(run, t, methods),
              "weights of smoothness that were chosen on validation views");
}

std::string map_sizes(const OneTerm& t, const Method& method) {
    const int m = std::stoi(t.text(method, "view_side"));
    const std::string density = t.text(method, "texels_per_pixel");  // where each triangle has a separate side
    return fmt::format("{} texels in a surface map{} and {} in a view map", t.range(method, "surface_texels"),
                       density.empty() || std::stod(density) == 0 ? "" : " on average", m * m);
}

std::string signed_text(double value) { return fmt::format("{:+.2f}", value); }

Evidence above_pca(const FinishedRun& run) {
    const OneTerm t(run);
    constexpr Method published{"pca-published"}, refilled{"pca-refilled"};
    const std::pair<Method, const char*> rivals[] = {{published, "PCA as published"}, {refilled, "refilled PCA"}};
    const std::pair<Method, const char*> contenders[] = {
        {high, "chosen weights"}, {high_weak, "weights of 1e-4"}, {modern, "modern CG"}};
    Evidence e;
    std::vector<std::string> told, weakly;
    for (const std::string& dataset : t.datasets()) {
        std::vector<std::string> leads;
        for (const auto& [rival, name] : rivals) {
            const Figure lead = t.difference(dataset, high, rival, psnr),
                         less = t.difference(dataset, rival, high, ape);
            const Figure held = t.difference(dataset, high, rival, held_psnr);
            e.measure("training PSNR", fmt::format("{}, PSNR above {}", dataset, name), lead, "dB");
            e.measure("training APE", fmt::format("{}, APE below {}", dataset, name), less, "of 255");
            e.measure("held-out PSNR", fmt::format("{}, held-out images, PSNR above {}", dataset, name), held, "dB");
            leads.push_back(fmt::format("{} dB of PSNR against {} (average error {} of 255; held-out images {} dB)",
                                        signed_text(lead.value), name, signed_text(-less.value),
                                        signed_text(held.value)));
        }
        for (const auto& [contender, what] : contenders) {
            const auto lead = [&](const Method& rival, const char* column) {
                return signed_text(t.difference(dataset, contender, rival, column).value);
            };
            e.beside.push_back(
                fmt::format("{}, {}: {} dB against PCA as published and {} dB against refilled PCA on training images; "
                            "{} and {} dB on held-out ones",
                            dataset, what, lead(published, psnr), lead(refilled, psnr), lead(published, held_psnr),
                            lead(refilled, held_psnr)));
        }
        told.push_back(fmt::format("on the {} by {}", dataset, fmt::join(leads, " and ")));
        weakly.push_back(fmt::format(
            "{} dB on the {}", signed_text(t.difference(dataset, high_weak, refilled, held_psnr).value), dataset));
    }
    e.sentence = fmt::format(
        "With one term, {}, the paper's conjugate gradients after {} iterations differ from factorization (PCA), in "
        "the images that were fitted, {}; with weights of 1e-4 in place of chosen ones, in held-out images by {} of "
        "PSNR "
        "against refilled PCA; means over {} objects of each shape.",
        map_sizes(t, high), t.text(high, "iterations"), fmt::join(told, "; "), fmt::join(weakly, " and "), t.seeds());
    e.premise("the paper's mode", t.all(high, "mode", "paper"), "the paper's conjugate gradients");
    need_chosen_weights(e, run, t, {high.name});
    e.premise("refills chosen", all_chosen(run, t, {"pca-refilled"}),
              "refills of PCA that were chosen on validation views");
    t.need_star_and_bust(e);
    return e;
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

Evidence half_as_good(const FinishedRun& run) {
    const OneTerm t(run);
    Evidence e{.renderer = t.text(low_fp16, "renderer")};
    constexpr double tolerance = 0.2;  // dB
    bool settled = true;
    std::vector<std::string> told;
    for (const std::string& dataset : t.datasets()) {
        const Figure difference = t.difference(dataset, low_fp16, low_brief, psnr);
        e.measure("PSNR, 16 bits less 32", fmt::format("{}, OpenGL in 16 bits less the CPU in 32", dataset), difference,
                  "dB");
        told.push_back(fmt::format("{:+.3f} dB of PSNR on the {}", difference.value, dataset));
        const double ahead = t.difference(dataset, low, low_brief, psnr).value;
        settled = settled && ahead <= tolerance;
        e.beside.push_back(
            fmt::format("{}: APE differs by {:+.3f}; the CPU's PSNR after {} iterations is {} dB of that after {}",
                        dataset, t.difference(dataset, low_fp16, low_brief, ape).value, t.text(low, "iterations"),
                        signed_text(ahead), t.text(low_brief, "iterations")));
    }
    e.sentence = fmt::format(
        "Conjugate gradients by the paper's passes, parameters and sums in 16-bit floats, differ from the CPU's in 32 "
        "bits by {} after {} iterations with one term, {}; {}; means over {} objects of each shape.",
        fmt::join(told, " and "), t.text(low_fp16, "iterations"), map_sizes(t, low_fp16), rounding_of(run), t.seeds());
    e.premise(
        "the paper's passes",
        t.all(low_fp16, "passes", "paper") && t.all(low_fp16, "mode", "paper") && t.all(low_brief, "mode", "paper"),
        "the paper's passes and conjugate gradients");
    e.premise("16 bits", t.all(low_fp16, "storage", "fp16") && t.all(low_fp16, "sums", "fp16"),
              "16-bit floats throughout");
    e.premise("as many iterations", t.all(low_fp16, "iterations", t.text(low_brief, "iterations")),
              "as many iterations on both sides");
    e.premise("settled", settled,
              fmt::format("fits that have settled: further iterations gain at most {} dB", tolerance));
    t.need_star_and_bust(e);
    return e;
}

Evidence resolution_matters(const FinishedRun& run) {
    const OneTerm t(run);
    Evidence e;
    std::vector<std::string> told;
    for (const std::string& dataset : t.datasets()) {
        const Figure gain = t.difference(dataset, high, low, psnr);
        e.measure("high less low", fmt::format("{}, high less low resolution", dataset), gain, "dB");
        told.push_back(fmt::format("{:.2f} dB of PSNR on the {}", gain.value, dataset));
        e.beside.push_back(fmt::format("{}: {} dB on held-out images", dataset,
                                       signed_text(t.difference(dataset, high, low, held_psnr).value)));
    }
    e.sentence = fmt::format(
        "With one term and the images that were fitted, {} instead of {} gain {}; means over {} objects of each shape.",
        map_sizes(t, high), map_sizes(t, low), fmt::join(told, " and "), t.seeds());
    e.premise("the paper's mode", t.all(high, "mode", "paper") && t.all(low, "mode", "paper"),
              "the paper's conjugate gradients");
    need_chosen_weights(e, run, t, {high.name, low.name});
    t.need_star_and_bust(e);
    return e;
}

}  // namespace

std::span<const ClaimCode> images_claims() {
    static constexpr ClaimCode table[] = {{"C8", above_pca}, {"C9", half_as_good}, {"C21", resolution_matters}};
    return table;
}

}  // namespace radiafit::harness
