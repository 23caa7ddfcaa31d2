#include "fitting/fit_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <sstream>
#include <utility>

#include "base/error.h"
#include "base/resources.h"
#include "fitting/family.h"
#include "fitting/limits.h"
#include "fitting/option_rows.h"
#include "fitting/solvers/solver.h"
#include "ownmodel/own_model.h"

namespace radiafit::fits {
namespace {

using rows::by_data, rows::choice, rows::dumped, rows::flag, rows::in, rows::number, rows::of_problem,
    rows::of_resources, rows::option, rows::text;

/// For a table whose entries have a name: throws UserError if none has this one.
void check_name(const char* what, const std::string& name, const auto& table) {
    std::vector<std::string> names;
    for (const auto& entry : table) names.emplace_back(entry.name);
    if (std::ranges::find(names, name) == names.end()) reject_name(what, name, names);
}
void check_solver(const std::string& name) { check_name("solver", name, solvers()); }
void check_ceres(const std::string& name) { check_name("ceres setting", name, ceres_settings()); }

/// An option whose values are a table's names.
FitOption one_of(FitOption o, const auto& table) {
    for (const auto& entry : table) o.choices.emplace_back(entry.name);
    return o;
}

/// "name: help; name: help".
std::string explained(const auto& table) {
    std::string all;
    for (const auto& entry : table) all += fmt::format("{}{}: {}", all.empty() ? "" : "; ", entry.name, entry.help);
    return all;
}
FitOption sort_memory_option() {
    FitOption o =
        option("sort_memory", &FitFacts::records, "bytes of samples that two-step's distribution holds at a time");
    o.values = "bytes, such as 64M";
    o.read = [](FitRequest& r, const std::string& text) { r.sort_memory = parse_bytes("sort-memory", text); };
    o.text = [](const FitRequest& r) { return bytes_text(r.sort_memory); };
    o.json = [](const FitRequest& r) { return dumped(bytes_text(r.sort_memory)); };
    return o;
}

/// Bytes, or any number of them.
FitOption memory_option() {
    FitOption o = option("memory", {},
                         "bytes that the program may hold, itself included: a fit that takes more goes in parts, one "
                         "after another, to the same result");
    o.values = "bytes, such as 4G, or any";
    o.read = [](FitRequest& r, const std::string& text) { r.memory = text == "any" ? 0 : parse_bytes("memory", text); };
    o.text = [](const FitRequest& r) { return r.memory ? bytes_text(r.memory) : "any"; };
    o.json = [text = o.text](const FitRequest& r) { return dumped(text(r)); };
    return o;
}

FitOption mu_option() {
    FitOption o = number("mu", &FitFacts::minimizes_objective, &FitRequest::mu, limits::weight,
                         "weight of the bounds; default: 1, in paper mode 1e-4");
    o.hide_default = true;
    o.json = [](const FitRequest& r) { return dumped(r.bounds_weight()); };
    o.check = [](const FitRequest& r) {
        if (!(r.mu < 0)) require("mu", r.mu, limits::weight);
    };
    return o;
}

FitOption model_option() {
    std::vector<std::pair<std::string, std::string>> choices;
    std::vector<std::string> help;
    for (const Family* family : families()) {
        for (const std::string& name : family->models()) choices.emplace_back(name, name);
        help.emplace_back(family->help);
    }
    help.emplace_back("a file NAME.glsl is a texel-local model of your own (docs/texel-models.md)");
    FitOption o =
        choice<std::string>("model", {}, &FitRequest::model_name, choices,
                            fmt::format("{}; default: by the data, in configs lfm", fmt::join(help, "; ")).c_str());
    o.values += ", NAME.glsl";
    o.names_input = true;
    o.read = [among = o.read, names = o.choices](FitRequest& r, const std::string& text) {
        const std::string name = std::filesystem::path(text).stem().string();
        if (is_model_file(text) && std::ranges::count(names, name))
            throw UserError(fmt::format("{}: there is a model {} in the program already; rename the file", text, name));
        if (is_model_file(text))
            r.model_name = load_model(text).model->name;
        else if (!text_of_model(text).empty())
            r.model_name = text;
        else
            among(r, text);
    };
    o.text = [](const FitRequest& r) { return r.model_name; };
    o.json = [](const FitRequest& r) { return dumped(r.model_name); };
    return of_problem(by_data(std::move(o)));
}

FitOption loss_option() {
    std::vector<std::pair<std::string, LossKind>> choices;
    for (size_t i = 0; i < std::size(loss_names); ++i) choices.emplace_back(loss_names[i], LossKind(i));
    return choice<LossKind>("loss", &FitFacts::has_loss, in(&FitRequest::model, &LfmOptions::loss, &Loss::kind),
                            choices, "what a residual costs: its square, or less where it is large (robust)");
}

FitOption optimizer_option() {
    std::vector<std::pair<std::string, const Method*>> choices;
    std::string help;
    for (const Method& method : methods) {
        choices.emplace_back(method.name, &method);
        help += fmt::format("{}: {}; ", method.name, method.help);
    }
    choices.emplace_back("lm", nullptr);
    help += "lm: Levenberg-Marquardt, of texel-local models on the CPU only, and there by default";
    return choice<const Method*>("optimizer", &FitFacts::optimizer, &FitRequest::optimizer, choices, help.c_str());
}

FitOption curve_option() {
    FitOption o = option(
        "curve", [](const FitFacts& f) { return f.takes_light() && !f.on_fragment(); },
        "what of light is fitted: as sRGB pictures store it, its square root, or light itself; default: of light bases "
        "srgb, of other models linear");
    for (const auto& [name, curve] : value_curves()) o.choices.push_back(name);
    o.type = "NAME";
    o.values = fmt::format("{}", fmt::join(o.choices, ", "));
    o.read = [](FitRequest& r, const std::string& value) { r.curve = choose("curve", value, value_curves()); };
    o.hide_default = true;
    o.text = [](const FitRequest& r) { return name_of(r.value_curve()); };
    o.json = [text = o.text](const FitRequest& r) { return dumped(text(r)); };
    return o;
}

FitOption validation_option() {
    FitOption o =
        number("validation", {}, &FitRequest::validation, limits::validation,
               "leave out every n-th training view, to choose options by (judge --split validation); 0 is off");
    o.check = [in_range = o.check](const FitRequest& r) {
        in_range(r);
        if (r.validation == 1) throw UserError(fmt::format("validation = 1: {}", advice(limits::validation)));
    };
    return o;
}

FitOption records_option() {
    FitOption o = option("records", &FitFacts::records, "folder to keep two-step's records in, or to find them");
    o.values = "a folder";
    o.read = [](FitRequest& r, const std::string& text) {
        if (text.empty()) throw UserError("records = '': give a name");
        r.records = text;
    };
    o.text = [](const FitRequest& r) { return r.records; };
    o.json = [](const FitRequest& r) { return dumped(r.records); };
    return o;
}

/// Rows of options that the family has alone, or that one before it has as well.
void add_own(const Family& family, std::vector<FitOption>& all) {
    for (FitOption& o : family.options()) {
        auto row = std::ranges::find(all, o.name, &FitOption::name);
        if (row == all.end()) row = all.insert(row, std::move(o));
        row->families.push_back(&family);
    }
}

std::vector<FitOption> make_fit_options() {
    std::vector<FitOption> all;
    const auto add = [&all](const char* group, std::vector<FitOption> options) {
        for (FitOption& o : options) {
            o.group = group;
            all.push_back(std::move(o));
        }
    };
    add("What is fitted, and by what",
        {model_option(),
         one_of(text("solver", {}, &FitRequest::solver, "a name", explained(solvers()), check_solver), solvers()),
         choice<EngineKind>(
             "engine", &FitFacts::on_engine, &FitRequest::engine,
             {{"cpu", EngineKind::cpu}, {"fragment", EngineKind::fragment}, {"compute", EngineKind::compute}},
             "what solver stream runs on: the processor, OpenGL's fragment programs, or its compute shaders; colours "
             "by view or lamp direction not on fragment programs"),
         of_problem(choice<TargetSpace>(
             "space", [](const FitFacts& f) { return !f.takes_light(); }, &FitRequest::space,
             {{"stored", TargetSpace::stored}, {"linear", TargetSpace::linear}}, "what residuals are formed in")),
         of_problem(curve_option()), of_problem(validation_option()),
         of_problem(text("leave_out", {}, &FitRequest::leave_out, "names with commas between them",
                         "training images that are not fitted, such as those that judge says to look at")),
         of_resources(memory_option())});
    add("Optimizer",
        {optimizer_option(), loss_option(),
         number("loss_scale", &FitFacts::has_loss, in(&FitRequest::model, &LfmOptions::loss, &Loss::scale),
                limits::loss_scale,
                "residuals well below it cost their square by a robust loss; in units of pixel values"),
         by_data(of_problem(choice<SampleWeights>(
             "weights", &FitFacts::weighs_samples, in(&FitRequest::model, &LfmOptions::loss, &Loss::weights),
             {{"equal", SampleWeights::equal}, {"facing", SampleWeights::facing}},
             "of squared residuals, in sums that stay over the number of samples: facing "
             "is the cosine between the surface's normal and the direction to the "
             "camera; a residual counts as its root times itself for the loss and for "
             "stopping; default: equal; of light field maps with --surface linear facing, "
             "but not in paper mode and configs"))),
         by_data(choice<PriorKind>(
             "prior", &FitFacts::has_prior, &FitRequest::prior,
             {{"none", PriorKind::none}, {"surface", PriorKind::surface}},
             "what is known of texels that few samples tell of: nothing, or, by a first fit, what the texels around "
             "them are like; default: surface, in configs none")),
         of_problem(choice<Mode>("mode", &FitFacts::minimizes_objective, &FitRequest::mode,
                                 {{"paper", Mode::paper}, {"modern", Mode::modern}},
                                 "of the optimizer and of the bounds' penalty")),
         number("iterations", &FitFacts::iterates, &FitRequest::iterations, limits::iterations, "at most"),
         number("stop_residual", &FitFacts::minimizes_objective, &FitRequest::stop_residual, limits::threshold,
                "stop a problem at this root mean square residual; 0 is off"),
         number(
             "stop_output_change", [](const FitFacts& f) { return f.has_loss() && f.method->stop_output_change; },
             &FitRequest::stop_output_change, limits::threshold,
             "stop a problem when its output changes less; 0 is off", "--stop-change"),
         number(
             "history", [](const FitFacts& f) { return f.has_loss() && f.method->history; }, &FitRequest::history,
             limits::history, "steps that lbfgs remembers"),
         number(
             "learning_rate", [](const FitFacts& f) { return f.has_loss() && f.method->learning_rate; },
             &FitRequest::learning_rate, limits::learning_rate, "adam's step in units of the parameters"),
         of_problem(number("seed", &FitFacts::optimizes_maps, &FitRequest::seed, limits::seed,
                           "of the start values of further terms")),
         flag(
             "deflate", [](const FitFacts& f) { return f.light_field() && f.optimizer; }, &FitRequest::deflate,
             "--deflate,!--joint", "fit terms one after another, or together (default)")});
    add("Light field maps and penalties",
        {of_problem(by_data(number("terms", &FitFacts::has_view_maps, in(&FitRequest::model, &LfmOptions::terms),
                                   limits::terms, "K; default: 3; of pca, in paper mode and configs 1"))),
         of_problem(by_data(number(
             "surface_side", [](const FitFacts& f) { return !f.grid; },
             in(&FitRequest::model, &LfmOptions::surface_side), limits::map_side,
             "n: n(n+1)/2 texels per surface map, or per triangle; default: 8; of colours by view direction 12, "
             "fewer where triangles are small in the photographs, of reflectance the side of the dataset's "
             "normals, but not in configs"))),
         of_problem(number(
             "texels_per_pixel", [](const FitFacts& f) { return f.light_field() && !f.streams_images(); },
             &FitRequest::texels_per_pixel, limits::texels_per_pixel,
             "not where OpenGL distributes; in place of one side: a side from 2 to 64 for each triangle's surface "
             "maps, with so many texels for each pixel of the triangle's largest projection into the photographs")),
         of_problem(number("view_side", &FitFacts::has_view_maps, in(&FitRequest::model, &LfmOptions::view_side),
                           limits::map_side, "m: m x m texels per view map")),
         of_problem(choice<ViewLookup>("view", &FitFacts::has_view_maps, in(&FitRequest::model, &LfmOptions::lookup),
                                       {{"bilinear", ViewLookup::bilinear}, {"nearest", ViewLookup::nearest}},
                                       "look-up in view maps", "view look-up")),
         by_data(choice<SurfaceLookup>(
             "surface", &FitFacts::looks_up_surface, &FitRequest::surface,
             {{"nearest", SurfaceLookup::nearest}, {"linear", SurfaceLookup::linear}},
             "look-up in surface maps, or in a mesh's texels where colours by view direction are shown: the texel "
             "that a point falls in, or linearly between texels' centres; light field maps are then fitted to colours "
             "interpolated at these centres, not where OpenGL distributes; default: nearest; of colours by view "
             "direction linear, but not in configs",
             "surface look-up")),
         of_problem(number("lambda_surface", &FitFacts::optimizes_maps,
                           in(&FitRequest::model, &LfmOptions::lambda_surface), limits::weight,
                           "smoothness of surface maps")),
         of_problem(
             by_data(number("lambda_view", &FitFacts::optimizes_maps, in(&FitRequest::model, &LfmOptions::lambda_view),
                            limits::weight, "smoothness of view maps; default: 0.1, in paper mode and configs 0.001"))),
         of_problem(mu_option())});
    for (const Family* family : families()) add_own(*family, all);
    add("Samples",
        {of_problem(
             number("clip_above", &FitFacts::texel_local, &FitRequest::clip_above, limits::share,
                    "leave out pixels with a channel at or above this share of the largest storable value (linear); 0 "
                    "is off")),
         of_problem(
             number("shadow_below", &FitFacts::texel_local, &FitRequest::shadow_below, limits::share,
                    "leave out samples darker than this share of what the texel's Lambertian fit says; 0 is off")),
         of_problem(
             choice<DistributorKind>("distributor", &FitFacts::distributes, &FitRequest::distributor,
                                     {{"cpu", DistributorKind::cpu}, {"gl", DistributorKind::gl}},
                                     "what finds each texel's pixels, for solvers that read a list of samples"))});
    add("OpenGL",
        {choice<Passes>("passes", &FitFacts::on_fragment, &FitRequest::passes,
                        {{"paper", Passes::paper}, {"r300", Passes::r300}, {"combined", Passes::combined}},
                        "those of the paper, the same held to what its chip could bind, or as few as today's hardware "
                        "needs"),
         choice<Storage>("storage", &FitFacts::on_fragment, &FitRequest::storage,
                         {{"fp32", Storage::fp32}, {"fp16", Storage::fp16}, {"fp16-truncate", Storage::fp16_truncate}},
                         "of parameters and of all vectors like them"),
         choice<Sums>("sums", &FitFacts::on_fragment, &FitRequest::sums, {{"fp32", Sums::fp32}, {"fp16", Sums::fp16}},
                      "over samples"),
         choice<SampleUse>(
             "samples", &FitFacts::accumulates, &FitRequest::samples,
             {{"cached", SampleUse::cached}, {"redistributed", SampleUse::redistributed}},
             "of compute shaders over light field maps: distributed once, and kept on the device; or found "
             "again in every sweep over the images, as the paper does"),
         choice<Accumulate>(
             "accumulate", &FitFacts::accumulates, &FitRequest::accumulate,
             {{"gather", Accumulate::gather},
              {"scatter-fixed", Accumulate::scatter_fixed},
              {"scatter-float", Accumulate::scatter_float}},
             "how compute shaders sum over samples of light field maps: each sum by its own invocation; or each sample "
             "adds to its sums, in 64-bit fixed point or in floats; floats alone don't give the same bits twice"),
         choice<ImageSource>(
             "source", &FitFacts::streams_images, &FitRequest::source,
             {{"disk", ImageSource::disk},
              {"disk-cold", ImageSource::disk_cold},
              {"memory", ImageSource::memory},
              {"device", ImageSource::device}},
             "where images are streamed from: disk-cold is past the page cache, device keeps them there"),
         of_problem(choice<ContextKind>(
             "context", &FitFacts::opens_context, in(&FitRequest::context, &ContextOptions::kind),
             {{"egl", ContextKind::egl}, {"osmesa", ContextKind::osmesa}}, "how OpenGL is reached")),
         of_problem(
             of_resources(number("device", &FitFacts::opens_context, in(&FitRequest::context, &ContextOptions::device),
                                 limits::device, "EGL device index, see radiafit devices; -1 chooses")))});
    add("Other solvers",
        {choice<RecordKind>(
             "record", [](const FitFacts& f) { return f.light_field() && f.records; }, &FitRequest::record,
             {{"compact", RecordKind::compact}, {"full", RecordKind::full}},
             "what two-step writes of a sample; full is the paper's"),
         of_resources(sort_memory_option()), of_resources(records_option()),
         number("refills", &FitFacts::resamples, &FitRequest::refills, limits::refills,
                "how often pca replaces entries that it had to invent by what its terms say, and refines the terms"),
         one_of(text("ceres", &FitFacts::ceres, &FitRequest::ceres, "a name", explained(ceres_settings()), check_ceres),
                ceres_settings())});
    return all;
}

}  // namespace

std::span<const FitOption> fit_options() {
    static const std::vector<FitOption> table = make_fit_options();
    return table;
}

const FitOption& find_fit_option(const std::string& name) {
    std::vector<std::string> names;
    for (const FitOption& o : fit_options()) {
        if (o.name == name) return o;
        names.push_back(o.name);
    }
    reject_name("option", name, names);
}

std::string command_line_of(const FitSetting& setting) {
    std::vector<std::string> words;
    for (const auto& [name, value] : setting) {
        const FitOption& option = find_fit_option(name);
        if (!option.flag_value)
            words.push_back(fmt::format("{} {}", option.flag, value));
        else if (value == "true")
            words.push_back(option.first_flag());
    }
    return fmt::format("{}", fmt::join(words, " "));
}

FitSetting parse_setting(const std::string& command_line) {
    FitSetting setting;
    std::istringstream words(command_line);
    for (std::string flag, value; words >> flag;) {
        if (!flag.starts_with("--")) throw UserError(fmt::format("'{}' is no option of radiafit fit", flag));
        std::string name = flag.substr(2);
        std::ranges::replace(name, '-', '_');
        if (find_fit_option(name).flag_value)
            value = "true";
        else if (!(words >> value))
            throw UserError(fmt::format("{} has no value", flag));
        setting.emplace_back(name, value);
    }
    return setting;
}

std::function<bool(const char*)> given_by(const FitSetting& setting) {
    return [&setting](const char* flag) {
        return std::ranges::any_of(setting,
                                   [&](const auto& o) { return find_fit_option(o.first).first_flag() == flag; });
    };
}

bool takes_given(const std::function<bool(const char*)>& given, const FitRequest& request) {
    if (!family_of(request).facts(find_solver(request.solver)) || request.lacks_engine()) return false;
    return std::ranges::all_of(fit_options(), [&, facts = facts_of(request)](const FitOption& o) {
        return o.means_something(facts) || !given(o.first_flag().c_str());
    });
}

bool FitOption::means_something(const FitFacts& fit) const {
    if (!families.empty() && std::ranges::find(families, fit.family) == families.end()) return false;
    return !meaning || meaning(fit);
}

void reject_idle_options(const FitRequest& request, bool grid) {
    const FitFacts facts = facts_of(request, grid);
    FitRequest plain;
    plain.mode = request.mode;  // mu's default depends on it
    for (const FitOption& o : fit_options()) {
        const FitRequest defaults = o.name == "mode" ? FitRequest() : plain;
        if (o.means_something(facts) || o.json(request) == o.json(defaults)) continue;
        const bool of_other_methods = std::ranges::any_of(methods, [&, fit = facts](const Method& method) mutable {
            fit.method = &method;
            return o.means_something(fit);
        });
        std::string what = "solver " + request.solver;
        if (request.optimizer && of_other_methods)
            what = "optimizer " + request.text("optimizer");
        else if (request.texel_model())
            what = "model " + request.text("model") + " with " +
                   (request.levenberg_marquardt() ? "optimizer lm" : what) + (grid ? " over a grid" : "");
        else if (facts.on_engine)
            what = "engine " + request.text("engine");
        throw UserError(fmt::format("{} means nothing to {}; leave it out", o.first_flag(), what));
    }
}

}  // namespace radiafit::fits
