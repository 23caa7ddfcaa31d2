// Real captures: how good fits are on images that were held out, by two rules for holding out, and inside and outside
// the directions of the images that were fitted.
#include "rows/captures.h"

#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "base/log.h"
#include "base/read_file.h"
#include "dataset/split.h"
#include "dataset/view_directions.h"
#include "experiment.h"
#include "fitting/family.h"
#include "fitting/resolve_options.h"
#include "reachable/reachable.h"
#include "report/csv_file.h"
#include "report/table.h"

namespace radiafit::harness {
namespace {

namespace rows = rows_of::captures;

constexpr Range<int> nth{2, 1000};

/// A fit by its name in tables and its options.
struct Method {
    std::string name;
    FitSetting setting;
};

/// Parses "name: --model lfm --terms 3". Throws UserError.
Method parse_method(const std::string& text) {
    const size_t colon = text.find(": ");
    if (colon == std::string::npos || colon == 0)
        throw UserError(fmt::format("'{}': write a name, a colon, and options of radiafit fit", text));
    Method method{text.substr(0, colon), parse_setting(text.substr(colon + 2))};
    if (!given_by(method.setting)("--model")) throw UserError(fmt::format("'{}' names no --model", text));
    FitRequest request;
    for (const auto& [option, value] : method.setting) request.set(option, value);
    return method;
}

struct Options {
    std::vector<std::string> light_fields = {"cape"}, lit = {"reading"}, few = {"cards"};
    std::vector<Method> light_field_fits, lit_fits, few_fits;
    bool reachable = true;
    int every = 8;

    explicit Options(Config& c) {
        c.read("light_fields", light_fields);
        c.read("lit", lit);
        c.read("few", few);
        for (const auto& [key, methods] :
             {std::pair("light_field_fits", &light_field_fits), {"lit_fits", &lit_fits}, {"few_fits", &few_fits}}) {
            std::vector<std::string> texts;
            c.read(key, texts, parse_method);
            for (const std::string& text : texts) methods->push_back(parse_method(text));
        }
        c.read("reachable", reachable);
        c.read("every", every, nth);
        c.finish();
    }
};

/// One way to hold out images: its name, and for each fit that it takes, what is held out.
struct SplitRule {
    std::string name;
    std::vector<std::vector<uint8_t>> held_out;
};

std::vector<SplitRule> rules_for(const Dataset& dataset, int every) {
    const Vec3d centre = surface_centre(dataset.mesh, dataset.grid);
    std::vector<std::string> names;
    std::vector<Vec3d> directions;
    for (const View& view : dataset.views) {
        names.push_back(view.name);
        directions.push_back(dataset.light_moves() ? view.light->direction_from(centre)
                                                   : view.direction_to_camera(centre));
    }
    const size_t count = (names.size() + size_t(every) - 1) / size_t(every);
    std::vector<SplitRule> rules;
    for (const std::string& rule : {fmt::format("every:{}", every), fmt::format("spread:{}", count)})
        rules.push_back({rule, {choose_held_out(names, directions, rule)}});
    return rules;
}

std::vector<SplitRule> each_alone(const Dataset& dataset) {
    SplitRule rule{"each alone", {}};
    for (size_t i = 0; i < dataset.views.size(); ++i) {
        rule.held_out.emplace_back(dataset.views.size(), 0);
        rule.held_out.back()[i] = 1;
    }
    return {rule};
}

/// All held-out images of one method under one rule, over all its fits.
struct Row {
    std::string capture, rule, method;
    std::vector<ImageFigures> images = {};
    ErrorSums all = {}, inside = {}, outside = {};
    size_t outside_count = 0, training = 0;
    double seconds = 0;

    void add(const JudgeResult& result) {
        images.insert(images.end(), result.images.begin(), result.images.end());
        all.add(result.stored);
        inside.add(result.inside);
        outside.add(result.outside);
        outside_count += result.outside_count;
    }
    double mean_psnr() const {
        double sum = 0;
        for (const ImageFigures& image : images) sum += image.stored.psnr();
        return sum / double(images.size());
    }
};

class Captures {
public:
    explicit Captures(Experiment& experiment) : experiment_(experiment), o_(experiment.config()) {}

    void run() {
        for (const std::string& name : o_.light_fields)
            judge_capture(name, o_.light_field_fits, [&](const Dataset& d) { return rules_for(d, o_.every); });
        for (const std::string& name : o_.lit)
            judge_capture(name, o_.lit_fits, [&](const Dataset& d) { return rules_for(d, o_.every); });
        for (const std::string& name : o_.few) judge_capture(name, o_.few_fits, each_alone);
        if (rows_.empty())
            log_info("no capture is packed, so there is nothing to judge");
        else
            write();
    }

private:
    template <class Rules>
    void judge_capture(const std::string& name, const std::vector<Method>& methods, const Rules& rules_of) {
        const std::filesystem::path folder = experiment_.root() / "datasets" / "packed" / name;
        if (!folder_exists(folder)) {
            log_info(fmt::format("{}: not packed in datasets/packed; datasets/captures.md says how to", name));
            return;
        }
        Dataset dataset = experiment_.open(folder);
        for (const SplitRule& rule : rules_of(dataset)) {
            std::vector<Row> rows;
            for (const std::vector<uint8_t>& held_out : rule.held_out) {
                for (size_t i = 0; i < held_out.size(); ++i) dataset.views[i].held_out = held_out[i];
                add_fits(dataset, rule.name, methods, rows);
            }
            for (Row& row : rows) {
                log_info(fmt::format("{}, {}, {}: PSNR {:.2f} dB on {} held-out images; {:.1f} s", row.capture,
                                     row.rule, row.method, row.all.psnr(), row.images.size(), row.seconds));
                rows_.push_back(std::move(row));
            }
        }
    }

    /// The baseline is that of the first method: it is fitted to the same samples. Models that keep every photograph
    /// show light that stays.
    void add_fits(const Dataset& dataset, const std::string& rule, const std::vector<Method>& methods,
                  std::vector<Row>& rows) {
        const auto row = [&](const std::string& method) -> Row& {
            for (Row& r : rows)
                if (r.method == method) return r;
            return rows.emplace_back(dataset.name, rule, method);
        };
        for (const Method& method : methods) {
            const FitRequest request = resolved_request(method.setting, dataset);
            FinishedFit fit = family_of(request).fit(dataset, request);
            if (&method == &methods.front()) {
                Fitted baseline = baseline_of(fit.fit);
                add_judged(row(baseline_name(fit.fit)), contestant_of(baseline), dataset);
            }
            Row& r = row(method.name);
            add_judged(r, contestant_of(fit.fit), dataset);
            r.seconds += fit.run.times.total;
        }
        if (!o_.reachable || dataset.light_moves()) return;
        for (const ReachableModel& model : reachable_models())
            add_judged(row(model.words), model.of(dataset, dataset.split(false), TargetSpace::stored), dataset);
    }

    static void add_judged(Row& row, const Contestant& contestant, const Dataset& dataset) {
        row.add(judge(contestant, dataset, Split::test));
        row.training = dataset.split(false).size();
    }

    void write() {
        ResultFolder results = experiment_.open_results(experiment_.cpu_device());
        CsvFile figures(results.path(), rows::figures);
        CsvFile images(results.path(), rows::images);
        Table table({"capture", "held out", "method", "PSNR", "APE", "mean of images", "amid the training directions",
                     "beyond them"});
        const auto finite = [](double x) { return std::isfinite(x) ? std::optional(x) : std::nullopt; };
        const auto shown = [](const ErrorSums& e) { return e.values ? fmt::format("{:.2f} dB", e.psnr()) : "none"; };
        for (const Row& r : rows_) {
            figures.add({r.capture, r.rule, r.method, r.training, r.images.size(), r.outside_count,
                         finite(r.all.psnr()), r.all.ape(), finite(r.mean_psnr()), finite(r.inside.psnr()),
                         finite(r.outside.psnr()), r.seconds});
            table.add({r.capture, fmt::format("{} ({} images)", r.rule, r.images.size()), r.method,
                       fmt::format("{:.2f} dB", r.all.psnr()), fmt::format("{:.2f}", r.all.ape()),
                       fmt::format("{:.2f} dB", r.mean_psnr()), shown(r.inside), shown(r.outside)});
            for (const ImageFigures& image : r.images)
                images.add({r.capture, r.rule, r.method, image.name, image.pixels, finite(image.stored.psnr()),
                            image.stored.ape(), 180 / M_PI * image.outside});
        }
        figures.commit();
        images.commit();
        const std::string caption = "held-out images of real captures; " + experiment_.cpu_device();
        log_info(caption + "\n" + table.text());
        write_file(
            results.path() / "captures.md",
            fmt::format("# {}\n\nPSNR and APE (0 to 255) pooled over the foreground of all held-out images. Amid: "
                        "images whose lamp or camera lies inside the cone of the training images' directions, or "
                        "less than a degree beyond it.\n\n{}",
                        caption, table.markdown()));
        experiment_.finish(results, caption);
    }

    Experiment& experiment_;
    Options o_;
    std::vector<Row> rows_;
};

}  // namespace
}  // namespace radiafit::harness

int main(int argc, char** argv) {
    return radiafit::harness::run_experiment("captures", argc, argv, [](radiafit::harness::Experiment& experiment) {
        radiafit::harness::Captures(experiment).run();
    });
}
