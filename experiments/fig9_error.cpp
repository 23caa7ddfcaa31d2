// Figure 9 of the paper: error of factorization (PCA) and of nonlinear optimization at the same high resolution, and of
// the CPU in 32-bit and OpenGL in 16-bit floats at a low one, on training and on held-out views.
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "app/fit_options.h"
#include "app/limits.h"
#include "base/atomic_file.h"
#include "base/log.h"
#include "eval/judge.h"
#include "experiment.h"
#include "report/csv.h"
#include "report/table.h"

namespace radiafit {
namespace {

struct Options {
    std::vector<std::string> datasets = {"star", "bust"};
    std::string capture, held_out = "test";
    std::vector<int> terms = {1, 2, 3};
    int high_side = 16, low_side = 8, high_iterations = 40, low_iterations = 15, refills = 10;
    double lambda_surface = 1e-2, lambda_view = 0.1;

    explicit Options(Config& c) {
        c.read("datasets", datasets, check_light_field_shape);
        c.read("capture", capture);
        c.read("terms", terms, limits::terms);
        c.read("high_side", high_side, limits::map_side);
        c.read("low_side", low_side, limits::map_side);
        c.read("high_iterations", high_iterations, limits::iterations);
        c.read("low_iterations", low_iterations, limits::iterations);
        c.read("lambda_surface", lambda_surface, limits::weight);
        c.read("lambda_view", lambda_view, limits::weight);
        c.read("refills", refills, limits::refills);
        c.read("held_out", held_out);
        c.finish();
        if (held_out != "test" && held_out != "validation") c.reject("held_out", "is test or validation");
    }
    FitRequest request(int k, int side, int iterations) const {
        FitRequest r;
        r.model.terms = k;
        r.model.surface_side = r.model.view_side = side;
        r.model.lambda_surface = float(lambda_surface);
        r.model.lambda_view = float(lambda_view);
        r.iterations = iterations;
        r.refills = refills;
        return r;
    }
};

/// Without its held-out views, and with every eighth training view held out in their stead: for choosing options.
Dataset validation_of(Dataset dataset) {
    dataset.name += "-validation";
    std::erase_if(dataset.views, [](const View& view) { return view.held_out; });
    for (size_t i = 0; i < dataset.views.size(); ++i) dataset.views[i].held_out = i % 8 == 4;
    return dataset;
}

struct Row {
    std::string dataset, method, renderer;
    FitRequest request;
    JudgeResult train, held;
    double invented_share = 0, seconds = 0;
};

class Contest {
public:
    Contest(const Options& options, Experiment& experiment) : options_(options), experiment_(experiment) {}

    void run(const Dataset& dataset) {
        const Options& o = options_;
        FitRequest mean = o.request(1, o.high_side, 0);
        mean.solver = "mean";
        add(dataset, "mean", mean);
        for (int k : o.terms) {
            FitRequest pca = o.request(k, o.high_side, 0);
            pca.solver = "pca";
            add(dataset, "pca", pca);
            add(dataset, "cpu-high", o.request(k, o.high_side, o.high_iterations));
            FitRequest low = o.request(k, o.low_side, o.low_iterations);
            add(dataset, "cpu-low", low);
            low.set("engine", "fragment");
            low.set("storage", "fp16");
            add(dataset, "fragment-fp16", low);
        }
    }
    const std::vector<Row>& rows() const { return rows_; }

private:
    void add(const Dataset& dataset, const std::string& method, const FitRequest& request) {
        const FitOutcome out = solve(dataset, request);
        note_gl(out, experiment_.record());
        Row row{.dataset = dataset.name,
                .method = method,
                .renderer = out.gl_renderer.empty() ? experiment_.cpu_name() : out.gl_renderer,
                .request = request,
                .train = judge(contestant_of(out.fit, dataset.mesh), dataset, Split::train),
                .held = judge(contestant_of(out.fit, dataset.mesh), dataset, Split::test),
                .invented_share = out.resampling.invented_share(),
                .seconds = out.times.total};
        log_info(fmt::format("{}, {}, K = {}: PSNR {:.2f} dB in training, {:.2f} dB held out; {:.1f} s", row.dataset,
                             method, request.model.terms, row.train.psnr(), row.held.psnr(), row.seconds));
        rows_.push_back(std::move(row));
    }

    Options options_;
    Experiment& experiment_;
    std::vector<Row> rows_;
};

void write(const std::filesystem::path& folder, const std::vector<Row>& rows) {
    CsvWriter csv(folder / "errors.csv",
                  {"dataset", "method", "terms", "surface_side", "view_side", "storage", "renderer", "train_psnr_db",
                   "train_ape", "held_psnr_db", "held_ape", "invented_share", "lambda_surface", "lambda_view",
                   "iterations", "refills", "seconds"});
    Table table({"method", "training PSNR", "APE", "held-out PSNR", "APE", "invented"});
    for (const Row& r : rows) {
        const LfmOptions& m = r.request.model;
        const uint32_t uses = uses_of(r.request);
        const bool resampled = uses & use::refills, iterated = uses & use::iterations;
        const auto given = [](bool is, const std::string& text) { return is ? text : std::string(); };
        csv.row({r.dataset, r.method, std::to_string(m.terms), std::to_string(m.surface_side),
                 std::to_string(uses & use::maps ? m.view_side : 1), r.request.text("storage"), r.renderer,
                 fmt::format("{:.4f}", r.train.psnr()), fmt::format("{:.4f}", r.train.ape()),
                 fmt::format("{:.4f}", r.held.psnr()), fmt::format("{:.4f}", r.held.ape()),
                 given(resampled, fmt::format("{:.5f}", r.invented_share)),
                 given(iterated, fmt::format("{}", m.lambda_surface)),
                 given(iterated, fmt::format("{}", m.lambda_view)),
                 given(iterated, std::to_string(r.request.iterations)),
                 given(resampled, std::to_string(r.request.refills)), fmt::format("{:.3f}", r.seconds)});
        table.add({fmt::format("{}, {}, K = {}", r.dataset, r.method, m.terms),
                   fmt::format("{:.2f} dB", r.train.psnr()), fmt::format("{:.2f}", r.train.ape()),
                   fmt::format("{:.2f} dB", r.held.psnr()), fmt::format("{:.2f}", r.held.ape()),
                   given(resampled, fmt::format("{:.0f}%", 100 * r.invented_share))});
    }
    csv.commit();
    write_file(folder / "errors.md", table.markdown());
    log_info("what is left of the error\n" + table.text());
}

void fig9(Experiment& experiment) {
    const Options o(experiment.config());
    std::optional<Dataset> capture;
    if (!o.capture.empty()) require_light_field(capture.emplace(experiment.open(o.capture)));
    std::vector<Dataset> datasets;
    for (const std::string& shape : o.datasets) datasets.push_back(experiment.dataset(shape));
    if (capture) datasets.push_back(std::move(*capture));
    Contest contest(o, experiment);
    for (const Dataset& dataset : datasets) contest.run(o.held_out == "validation" ? validation_of(dataset) : dataset);
    std::string renderer;
    for (const Row& row : contest.rows())
        if (row.method == "fragment-fp16") renderer = row.renderer;
    ResultFolder results = experiment.open_results(renderer);
    write(results.path(), contest.rows());
    results.commit();
    experiment.draw(results,
                    fmt::format("{} scale, foreground pixels{}; lambda {} and {}, PCA refilled {} times; {}; {}",
                                experiment.profile(), o.held_out == "test" ? "" : ", VALIDATION views held out",
                                o.lambda_surface, o.lambda_view, o.refills, experiment.cpu_name(), renderer));
}

}  // namespace
}  // namespace radiafit

int main(int argc, char** argv) { return radiafit::run_experiment("fig9_error", argc, argv, radiafit::fig9); }
