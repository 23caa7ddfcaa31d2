// publish: a fit as a page that browsers open.
#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "base/log.h"
#include "cli/commands.h"
#include "exchange/surface_normals.h"
#include "fit/error_bar_maps.h"
#include "fitting/family.h"
#include "fitting/limits.h"
#include "publish/pages.h"
#include "publish/publish.h"
#include "publish/uncertainty.h"

namespace radiafit::tools {
namespace {

struct PublishCommand {
    std::string fit, output, dataset;
    bool single_file = false;
    PublishOptions page;
};

std::string text_of(const PublishOutcome& o) {
    const std::string kept = std::isfinite(o.fidelity) ? fmt::format("{:.1f} dB", o.fidelity) : "no loss";
    return fmt::format(
        "the page's pictures against the fit's: {}; PSNR of {} {} photographs: {:.2f} dB by the page, {:.2f} dB by the "
        "fit",
        kept, o.photographs, o.split == Split::test ? "held-out" : "training", o.shown_psnr, o.psnr);
}

void publish_fit(const PublishCommand& o) {
    auto fitted = open_fit(o.fit, o.dataset);
    const Dataset& dataset = fitted.dataset();
    require_viewer();
    auto baseline = baseline_of(fitted);
    const std::vector<uint32_t> training = fitted_views(dataset, fitted.record());
    if (has_error_bars(o.fit)) {
        std::vector<View> asked;
        for (const uint32_t v : uncertainty_views(training)) asked.push_back(dataset.views[v]);
        find_error_bars(fitted, asked);
    }
    const Contestant fit = contestant_of(fitted);
    PageModel model = page_model_of(fitted);
    std::vector<Vec3f> fit_normals;
    if (takes_light(fitted)) {
        SurfaceNormals finest = finest_normals(fit, *model.atlas, dataset, training);
        if (finest.lamps > 0) fit_normals = std::move(finest.normals);
    }
    const PublishOutcome outcome = publish({.dataset = dataset,
                                            .record = fitted.record(),
                                            .description = description_of(fitted),
                                            .fit = fit,
                                            .baseline = contestant_of(baseline),
                                            .baseline_name = baseline_name(fitted),
                                            .takes_light = takes_light(fitted),
                                            .training = training,
                                            .model = std::move(model),
                                            .fit_normals = std::move(fit_normals)},
                                           o.page);
    write_page(o.output, o.single_file, outcome.page);
    log_info(text_of(outcome));
    const double megabytes = double(outcome.page.written_bytes()) / 1e6;
    log_info(o.single_file ? fmt::format("{}: {:.1f} MB; open it in a browser", o.output, megabytes)
                           : fmt::format("{}: a folder of {:.1f} MB; open {}/index.html in a browser", o.output,
                                         megabytes, o.output));
}

}  // namespace

void add_publish(CommandLine& program) {
    auto o = std::make_shared<PublishCommand>();
    CommandLine& command =
        program.add_command("publish", "a page for browsers: the fit from any direction, beside its photographs");
    command.add_text("fit", o->fit, "folder of the fit").required().input();
    command.add_flag("--single-file", o->single_file, "one HTML file with everything in it, in place of a folder");
    command.add_number("--megabytes", o->page.megabytes, limits::page_megabytes,
                       "of the page, at most: maps are coarsened to fit");
    command.add_number("--fidelity", o->page.fidelity, limits::page_fidelity,
                       "dB: PSNR of the page's pictures against the fit's own, where megabytes allow");
    command.add_number("--views", o->page.views, limits::page_views,
                       "photographs of each kind, held-out and training, at most");
    command.add_text("--title", o->page.words.title, "of the page, in place of the dataset's name");
    command.add_text("--caption", o->page.words.caption, "below the title: what is to be seen, in a sentence or two");
    command.add_text("--credit", o->page.words.credit, "who is to be named: photographer, collection");
    command.add_text("--licence", o->page.words.licence, "terms under which the page may be used, such as 'CC BY 4.0'");
    command.add("--scale", "TEXT", "",
                "how long one unit of the surface's coordinates is, such as 1mm: the page has a scale bar",
                [o](const std::string& text) { o->page.words.unit_metres = parse_length("scale", text); });
    command.add_text("--dataset", o->dataset, "where the dataset is now, if it moved").idle();
    command.add_text("-o,--output", o->output, "folder of the page, or file for --single-file").required().idle();
    command.writes([o] {
        return std::vector{
            OutputTarget{.path = o->output, .check = [o] { check_page_target(o->output, o->single_file); }}};
    });
    command.on_run([=] { publish_fit(*o); });
}

}  // namespace radiafit::tools
