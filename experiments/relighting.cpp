// Captures under lamps that move: what the field stores of them and what we do, on lamps that were held out.
#include "rows/relighting.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/json.h"
#include "base/log.h"
#include "base/program.h"
#include "base/read_file.h"
#include "experiment.h"
#include "fitting/family.h"
#include "fitting/resolve_options.h"
#include "fitting/tune.h"
#include "report/csv_file.h"
#include "report/table.h"

namespace radiafit::harness {
namespace {

namespace fs = std::filesystem;
namespace rows = rows_of::relighting;
using Row = rows::Method;

constexpr Range<double> seconds_to_tune{0, 1e6};

struct Method {
    std::string name;
    FitSetting setting;  ///< empty: as fit chooses
};

/// Parses "name: --model ptm --curve srgb". Throws UserError.
Method parse_method(const std::string& text) {
    const size_t colon = text.find(':');
    if (colon == std::string::npos || colon == 0)
        throw UserError(fmt::format("'{}': write a name, a colon, and options of radiafit fit", text));
    Method method{text.substr(0, colon), parse_setting(text.substr(colon + 1))};
    FitRequest request;
    for (const auto& [option, value] : method.setting) request.set(option, value);
    return method;
}

struct Options {
    std::vector<std::string> captures = {"neural_dome"};
    std::vector<Method> fits;
    double tune_seconds = 30;
    std::string renders = "datasets/renders";

    explicit Options(Config& c) {
        c.read("captures", captures);
        std::vector<std::string> texts;
        c.read("fits", texts, parse_method);
        for (const std::string& text : texts) fits.push_back(parse_method(text));
        c.read("tune_seconds", tune_seconds, seconds_to_tune);
        c.read("renders", renders);
        c.finish();
    }
};

std::optional<double> finite(double x) { return std::isfinite(x) ? std::optional(x) : std::nullopt; }

/// Numbers stored for each texel.
size_t numbers_of(Fitted& fit) { return size_t(arrays_of(fit).front().shape.back()); }

Row judged(const std::string& method, const FitSetting& setting, const Dataset& dataset) {
    FitRequest request;
    for (const auto& [option, value] : setting) request.set(option, value);
    resolve_options(given_by(setting), dataset, request);
    FinishedFit fit = family_of(request).fit(dataset, request);
    const JudgeResult result = judge(contestant_of(fit.fit), dataset, Split::test, at_pixel_centres);
    double sum = 0;
    for (const ImageFigures& image : result.images) sum += image.stored.psnr();
    return {.capture = dataset.name,
            .method = method,
            .made = command_line_of(setting.empty() ? FitSetting{{"model", request.model_name}} : setting),
            .numbers = numbers_of(fit.fit),
            .training = dataset.split(false).size(),
            .held_out = result.images.size(),
            .mean_image_psnr_db = finite(sum / double(result.images.size())),
            .psnr_db = finite(result.psnr()),
            .ape = result.ape(),
            .seconds = fit.run.times.total};
}

/// By `radiafit judge --renders`, which knows pictures of every kind. Throws UserError with what it complains of.
Row judged_pictures(const fs::path& folder, const Dataset& dataset) {
    const fs::path program = fs::read_symlink("/proc/self/exe").parent_path().parent_path() / "bin" / "radiafit";
    const Ended ended = run_program({program.string(), "judge", "--renders", folder.string(), "--dataset",
                                     dataset.folder.string(), "--json", "--quiet"});
    if (ended.status != 0)
        throw UserError(fmt::format(
            "{}: {}", folder.string(),
            ended.message.empty() ? program.string() + " is missing: run make build" : single_line(ended.message)));
    const auto told = parse_json<nlohmann::json>(ended.output);
    double sum = 0;
    for (const auto& image : told.at("per_image")) sum += image.at("psnr").get<double>();
    const size_t images = told.at("per_image").size();
    return {.capture = dataset.name,
            .method = folder.filename().string(),
            .training = dataset.split(false).size(),
            .held_out = images,
            .mean_image_psnr_db = finite(sum / double(images)),
            .psnr_db = finite(told.at("psnr").get<double>()),
            .ape = told.at("ape").get<double>()};
}

void judge_capture(const Dataset& dataset, const Options& o, const fs::path& renders, std::vector<Row>& all) {
    const auto add = [&](Row row) {
        log_info(fmt::format("{}, {}: mean of images' PSNRs {:.2f} dB, pooled {:.2f} dB", row.capture, row.method,
                             row.mean_image_psnr_db.value_or(NAN), row.psnr_db.value_or(NAN)));
        all.push_back(std::move(row));
    };
    for (const Method& method : o.fits) add(judged(method.name, method.setting, dataset));
    if (o.tune_seconds > 0) {
        const Tuned tuned = tune(dataset, {.seconds = o.tune_seconds, .fixed = {}});
        add(judged(fmt::format("what tune recommends within {:g} s", o.tune_seconds),
                   tuned.tried[tuned.recommended].setting, dataset));
    }
    if (!fs::is_directory(renders)) return;
    std::vector<fs::path> programs;
    for (const auto& entry : fs::directory_iterator(renders))
        if (entry.is_directory()) programs.push_back(entry.path());
    std::ranges::sort(programs);
    for (const fs::path& program : programs) add(judged_pictures(program, dataset));
}

void write(Experiment& experiment, const std::vector<Row>& all) {
    ResultFolder results = experiment.open_results(experiment.cpu_device());
    CsvFile file(results.path(), rows::methods);
    Table table({"capture", "method", "numbers a texel", "mean of images' PSNRs", "pooled PSNR", "fit"});
    for (const Row& r : all) {
        file.add(r);
        table.add({r.capture, r.method, r.numbers ? fmt::format("{}", *r.numbers) : "",
                   r.mean_image_psnr_db ? fmt::format("{:.2f} dB", *r.mean_image_psnr_db) : "",
                   r.psnr_db ? fmt::format("{:.2f} dB", *r.psnr_db) : "",
                   r.seconds ? fmt::format("{:.1f} s", *r.seconds) : "pictures"});
    }
    file.commit();
    const std::string caption = "held-out lamps; " + experiment.cpu_device();
    log_info(caption + "\n" + table.text());
    write_file(results.path() / "relighting.md",
               fmt::format("# {}\n\nPSNR of stored values over the object's pixels of the images that each capture "
                           "holds out.\n\n{}",
                           caption, table.markdown()));
    experiment.finish(results, caption);
}

void run(Experiment& experiment) {
    const Options o(experiment.config());
    std::vector<Row> all;
    for (const std::string& name : o.captures) {
        const fs::path folder = experiment.root() / "datasets" / "packed" / name;
        if (!folder_exists(folder)) {
            log_info(fmt::format("{}: not packed in datasets/packed; datasets/captures.md says how to", name));
            continue;
        }
        const Dataset dataset = experiment.open(folder);
        if (!dataset.light_moves())
            throw UserError(fmt::format("{}: its light stays; give captures under lamps that move", folder.string()));
        judge_capture(dataset, o, experiment.root() / o.renders / name, all);
    }
    if (all.empty())
        log_info("no capture is packed, so there is nothing to judge");
    else
        write(experiment, all);
}

}  // namespace
}  // namespace radiafit::harness

int main(int argc, char** argv) {
    return radiafit::harness::run_experiment("relighting", argc, argv, radiafit::harness::run);
}
