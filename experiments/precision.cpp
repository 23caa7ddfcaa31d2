// What 16-bit floats cost: the fragment engine with parameters and sums over samples in 32 and 16 bits, conjugate
// gradients and steepest descent in the paper's mode (Sections 6.3 and 6.4; behind claim C9).
#include "rows/precision.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/log.h"
#include "eval/judge.h"
#include "experiment.h"
#include "fitting/limits.h"
#include "report/csv.h"
#include "report/csv_file.h"
#include "report/table.h"

namespace radiafit::harness {
namespace {

namespace rows = rows_of::precision;

struct Options {
    std::string dataset = "star";
    std::vector<std::string> storage = {"fp32", "fp16", "fp16-truncate"}, sums = {"fp32", "fp16"};
    int images = 0;
    FitRequest request;

    explicit Options(Config& c) {
        request.set("engine", "fragment");
        request.set("mode", "paper");
        c.read("dataset", dataset, check_light_field_shape);
        read_option(c, request, "passes");
        c.read("storage", storage, valid_option("storage"));
        c.read("sums", sums, valid_option("sums"));
        read_maps(c, request.model);
        c.read("iterations", request.iterations, limits::some_iterations);
        c.read("images", images, limits::images);
        c.finish();
        // The others are measured against 32 bits throughout.
        if (storage[0] != "fp32") c.reject("storage", "begin with fp32");
        if (sums[0] != "fp32") c.reject("sums", "begin with fp32");
    }
};

struct Run {
    std::string optimizer, storage, sums, renderer;
    Trace trace;
    JudgeResult judged;
    size_t not_finite = 0;
    double seconds = 0;
};

void precision(Experiment& experiment) {
    const Options o(experiment.config());
    const Dataset dataset = experiment.dataset(o.dataset);
    const std::vector<uint32_t> views = spread_views(dataset.split(false), o.images);
    std::vector<Run> runs;
    for (const char* optimizer : {"cg", "sd"})
        for (const std::string& storage : o.storage)
            for (const std::string& sums : o.sums) {
                FitRequest request = o.request;
                request.set("optimizer", optimizer);
                request.set("storage", storage);
                request.set("sums", sums);
                FitOutcome out = solve(dataset, request, nullptr, {}, &views);
                note_gl(out, experiment.record());
                runs.push_back(
                    {.optimizer = optimizer,
                     .storage = storage,
                     .sums = sums,
                     .renderer = out.gl_renderer,
                     .trace = out.trace,
                     .judged = judge(contestant_of(out.fit, dataset.mesh), dataset, Split::train, at_pixel_centres),
                     .not_finite = out.fit.status_counts()[size_t(Status::not_finite)],
                     .seconds = out.times.total});
                log_info(fmt::format("{}, parameters {}, sums {}: {:.2f} dB", optimizer, storage, sums,
                                     runs.back().judged.psnr()));
            }

    ResultFolder results = experiment.open_results(runs[0].renderer);
    CsvFile curves(results.path(), rows::curves);
    CsvFile finals(results.path(), rows::finals);
    Table table({"optimizer", "parameters", "sums", "error / fp32's", "PSNR", "less fp32's", "not finite"});
    const Run* single = nullptr;
    for (const Run& r : runs) {
        if (r.storage == "fp32" && r.sums == "fp32") single = &r;
        for (size_t i = 0; i < r.trace.rows.size(); ++i) {
            const TraceRow& row = r.trace.rows[i];
            const size_t same = std::min(i, single->trace.rows.size() - 1);
            curves.add({r.optimizer, r.storage, r.sums, row.iteration, row.error,
                        row.error / single->trace.rows[same].error, row.active});
        }
        const double error = r.trace.rows.back().error, ratio = error / single->trace.rows.back().error;
        const double psnr = r.judged.psnr(), less = psnr - single->judged.psnr();
        finals.add({r.optimizer, r.storage, r.sums, o.request.iterations, views.size(), error, ratio, psnr,
                    r.judged.ape(), less, r.not_finite, r.seconds, r.renderer});
        table.add({r.optimizer, r.storage, r.sums, fmt::format("{:.4f}", ratio), fmt::format("{:.2f} dB", psnr),
                   fmt::format("{:+.3f} dB", less), std::to_string(r.not_finite)});
    }
    curves.commit();
    finals.commit();
    write_halves(results, o.request.context);
    log_info("what 16-bit floats cost\n" + table.text());
    experiment.finish(
        results, fmt::format("{} ({} scale), {} training images, {} passes; {}", dataset.name, experiment.profile(),
                             views.size(), o.request.text("passes"), runs[0].renderer));
}

}  // namespace
}  // namespace radiafit::harness

int main(int argc, char** argv) {
    return radiafit::harness::run_experiment("precision", argc, argv, radiafit::harness::precision);
}
