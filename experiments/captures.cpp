// Real captures: how good fits are on images that were held out, by two rules for holding out, and inside and outside
// the directions of the images that were fitted.
#include <fmt/format.h>

#include <cmath>

#include "app/family.h"
#include "app/limits.h"
#include "base/error.h"
#include "base/log.h"
#include "base/read_file.h"
#include "capture/split.h"
#include "dataset/view_directions.h"
#include "experiment.h"
#include "report/csv.h"
#include "report/table.h"
#include "sg/sg_fit.h"
#include "viewbasis/view_basis_fit.h"

namespace radiafit {
namespace {

constexpr Range<int> nth{2, 1000};

struct Options {
    std::vector<std::string> light_fields = {"cape"}, lit = {"reading"}, few = {"cards"}, models = {"lafortune"};
    std::vector<int> terms = {1, 3}, ranks = {10}, lobes = {4};
    double lambda_surface = 1e-3, lambda_view = 0.1, clip_above = 0, shadow_below = 0;
    int every = 8;

    explicit Options(Config& c) {
        c.read("light_fields", light_fields);
        c.read("terms", terms, limits::terms);
        c.read("ranks", ranks, limits::rank);
        c.read("lobes", lobes, limits::lobes);
        c.read("lambda_surface", lambda_surface, limits::weight);
        c.read("lambda_view", lambda_view, limits::weight);
        c.read("lit", lit);
        c.read("few", few);
        c.read("models", models, valid_option("model"));
        c.read("clip_above", clip_above, limits::share);
        c.read("shadow_below", shadow_below, limits::share);
        c.read("every", every, nth);
        c.finish();
    }
};

struct Method {
    std::string name;
    FitRequest request;
};

/// Light field maps by the number of terms, view bases by their rank, and spherical Gaussians by their number.
std::vector<Method> light_field_methods(const Options& o) {
    std::vector<Method> methods;
    for (const int k : o.terms) {
        Method& m = methods.emplace_back(fmt::format("light field map, K = {}", k));
        m.request.model.terms = k;
        m.request.model.lambda_surface = float(o.lambda_surface);
        m.request.model.lambda_view = float(o.lambda_view);
    }
    for (const int rank : o.ranks) {
        Method& m = methods.emplace_back(fmt::format("view basis, rank {}", rank));
        m.request.set("model", view_basis_name);
        m.request.view_basis.rank = rank;
    }
    for (const int lobes : o.lobes) {
        Method& m = methods.emplace_back(fmt::format("{} spherical Gaussians", lobes));
        m.request.set("model", sg_name);
        m.request.lobes = lobes;
    }
    return methods;
}

std::vector<Method> reflectance_methods(const Options& o, bool select_samples) {
    std::vector<Method> methods;
    for (const std::string& model : o.models) {
        Method& m = methods.emplace_back(model);
        m.request.set("model", model);
        if (!select_samples) continue;
        m.request.clip_above = float(o.clip_above);
        m.request.shadow_below = float(o.shadow_below);
    }
    return methods;
}

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
            judge_capture(name, light_field_methods(o_), [&](const Dataset& d) { return rules_for(d, o_.every); });
        for (const std::string& name : o_.lit)
            judge_capture(name, reflectance_methods(o_, true),
                          [&](const Dataset& d) { return rules_for(d, o_.every); });
        for (const std::string& name : o_.few) judge_capture(name, reflectance_methods(o_, false), each_alone);
        if (rows_.empty())
            log_info("no capture is packed, so there is nothing to judge");
        else
            write();
    }

private:
    template <class Rules>
    void judge_capture(const std::string& name, const std::vector<Method>& methods, const Rules& rules_of) {
        const std::filesystem::path folder = experiment_.root() / "datasets" / "packed" / name;
        if (!folder_stands(folder)) {
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

    /// The baseline is that of the first method: it is fitted to the same samples.
    void add_fits(const Dataset& dataset, const std::string& rule, const std::vector<Method>& methods,
                  std::vector<Row>& rows) {
        const auto row = [&](const std::string& method) -> Row& {
            for (Row& r : rows)
                if (r.method == method) return r;
            return rows.emplace_back(dataset.name, rule, method);
        };
        for (const Method& method : methods) {
            FitRequest request = method.request;
            const Family& family = family_of(request);
            family.settle([](const char*) { return false; }, dataset, request);
            const FinishedFit fit = family.fit(dataset, request);
            if (&method == &methods.front()) {
                const auto baseline = fit.fit->baseline();
                Row& r = row(fit.fit->baseline_name());
                r.add(judge(baseline->contestant(), dataset, Split::test));
                r.training = dataset.split(false).size();
            }
            Row& r = row(method.name);
            r.add(judge(fit.fit->contestant(), dataset, Split::test));
            r.training = dataset.split(false).size();
            r.seconds += fit.run.times.total;
        }
    }

    void write() {
        ResultFolder results = experiment_.open_results(experiment_.cpu_device());
        CsvWriter figures(results.path() / "captures.csv",
                          {"capture", "split", "method", "training", "held_out", "outside", "psnr_db", "ape",
                           "mean_image_psnr_db", "psnr_inside_db", "psnr_outside_db", "seconds"});
        CsvWriter images(results.path() / "images.csv",
                         {"capture", "split", "method", "image", "pixels", "psnr_db", "ape", "degrees_outside"});
        Table table({"capture", "held out", "method", "PSNR", "APE", "mean of images", "amid the training directions",
                     "beyond them"});
        const auto decibels = [](double x) { return std::isfinite(x) ? fmt::format("{:.4f}", x) : std::string(); };
        const auto shown = [](const ErrorSums& e) { return e.values ? fmt::format("{:.2f} dB", e.psnr()) : "none"; };
        for (const Row& r : rows_) {
            figures.row({r.capture, r.rule, r.method, std::to_string(r.training), std::to_string(r.images.size()),
                         std::to_string(r.outside_count), decibels(r.all.psnr()), fmt::format("{:.4f}", r.all.ape()),
                         decibels(r.mean_psnr()), decibels(r.inside.psnr()), decibels(r.outside.psnr()),
                         fmt::format("{:.3f}", r.seconds)});
            table.add({r.capture, fmt::format("{} ({} images)", r.rule, r.images.size()), r.method,
                       fmt::format("{:.2f} dB", r.all.psnr()), fmt::format("{:.2f}", r.all.ape()),
                       fmt::format("{:.2f} dB", r.mean_psnr()), shown(r.inside), shown(r.outside)});
            for (const ImageFigures& image : r.images)
                images.row({r.capture, r.rule, r.method, image.name, std::to_string(image.pixels),
                            decibels(image.stored.psnr()), fmt::format("{:.4f}", image.stored.ape()),
                            fmt::format("{:.2f}", 180 / M_PI * image.outside)});
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
}  // namespace radiafit

int main(int argc, char** argv) {
    return radiafit::run_experiment("captures", argc, argv,
                                    [](radiafit::Experiment& experiment) { radiafit::Captures(experiment).run(); });
}
