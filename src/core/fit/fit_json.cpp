#include "fit/fit_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "base/choose.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/json.h"
#include "fit/fit_maps.h"

namespace radiafit {
namespace {

/// Names that are no UTF-8 lose what is not.
std::string to_text(const nlohmann::ordered_json& json) { return json_text(json, 2, NotUtf8::replace) + "\n"; }

using Json = nlohmann::ordered_json;

// The double nearest to the shortest decimal that names this float: 0.001 stays 0.001 and still reads back exactly.
double plain(float value) { return std::stod(fmt::format("{}", value)); }

Json object_of(const std::string& text, const char* what) {
    if (text.empty()) return Json::object();
    Json parsed = parse_json<Json>(text);
    if (!parsed.is_object()) throw std::invalid_argument(fmt::format("the fit's {} are no JSON object", what));
    return parsed;
}

template <class Enum>
Enum one_of(const Json& value, std::initializer_list<Enum> choices, const char* what) {
    const auto text = value.get<std::string>();
    for (const Enum e : choices)
        if (to_string(e) == text) return e;
    throw std::runtime_error(fmt::format("unknown {} \"{}\"", what, text));
}

// nlohmann's get<int>() takes true, 2.9 and 2^32 + 2 for numbers: we do not.
int whole(const Json& object, const char* key) {
    const Json& value = object.at(key);
    if (!value.is_number_integer() || value != value.get<int>())
        throw std::runtime_error(fmt::format("{} is {}, no whole number", key, json_text(value)));
    return value.get<int>();
}
uint64_t count(const Json& object, const std::string& key) {
    const Json& value = object.at(key);
    if (!value.is_number_unsigned()) throw std::runtime_error(fmt::format("{} is {}, no count", key, json_text(value)));
    return value.get<uint64_t>();
}
float number(const Json& object, const char* key) {
    const Json& value = object.at(key);
    if (!value.is_number()) throw std::runtime_error(fmt::format("{} is {}, no number", key, json_text(value)));
    return value.get<float>();
}

std::string space_name(TargetSpace space) { return space == TargetSpace::stored ? "stored" : "linear"; }

TargetSpace space_of(const std::string& name) {
    if (name == "stored") return TargetSpace::stored;
    if (name == "linear") return TargetSpace::linear;
    throw std::runtime_error("unknown space \"" + name + "\"");
}

/// The entries before a model's private ones, and those behind them.
Json head(const FitRecord& fit, const std::string& model, int version = fit_version) {
    return {{"format", fit_format},
            {"version", version},
            {"model", model},
            {"solver", fit.solver},
            {"engine", fit.engine},
            {"space", space_name(fit.space)},
            {"surface_lookup", to_string(fit.surface)}};
}
void add_tail(Json& json, const FitRecord& fit, const std::string& dataset_path,
              const std::vector<std::string>& files) {
    const DatasetFingerprint& f = fit.dataset_fingerprint;
    Json statuses = Json::object();
    const auto counts = fit.status_counts();
    for (size_t s = 0; s < counts.size(); ++s) statuses[to_string(Status(s))] = counts[s];
    json["problems"] = {{"count", fit.problem_count()}, {"status", statuses}};
    json["dataset"] = {{"path", dataset_path},   {"name", fit.dataset_name},     {"encoding", to_string(fit.encoding)},
                       {"vertices", f.vertices}, {"triangles", f.triangles},     {"views", f.views},
                       {"held_out", f.held_out}, {"image_bytes", f.image_bytes}, {"digest", f.digest}};
    json["files"] = files;
    json["times_s"] = object_of(fit.times_json, "times");
    json["options"] = object_of(fit.options_json, "options");
    json["provenance"] = object_of(fit.provenance_json, "provenance");
}

Json checked_json(const std::string& text, int newest = fit_version) {
    if (nested_deeper(text, 100)) throw std::runtime_error("its brackets are nested more than 100 deep");
    Json json = Json::parse(text);
    if (json.at("format") != fit_format) throw std::runtime_error("its format is not radiafit-fit");
    const Json& version = json.at("version");
    if (!version.is_number_integer() || version < fit_version || version > newest)
        throw std::runtime_error(
            fmt::format("its version is {}, this program reads version {}", json_text(version), newest));
    return json;
}

FitPromises take_record(const Json& json, FitRecord& fit) {
    FitPromises promises;
    fit.solver = json.at("solver").get<std::string>();
    fit.engine = json.at("engine").get<std::string>();
    fit.space = space_of(json.at("space").get<std::string>());
    fit.surface = surface_lookup_of(json.value("surface_lookup", "nearest"));
    const Json& statuses = json.at("problems").at("status");
    for (size_t s = 0; s < promises.status_counts.size(); ++s)
        promises.status_counts[s] = count(statuses, to_string(Status(s)));
    const Json& d = json.at("dataset");
    promises.dataset_path = d.at("path").get<std::string>();
    fit.dataset_name = d.at("name").get<std::string>();
    fit.encoding = one_of(
        d.at("encoding"),
        {Encoding::u8_srgb, Encoding::u8_linear, Encoding::u16_linear, Encoding::f16_linear, Encoding::f32_linear},
        "encoding");
    fit.dataset_fingerprint = {count(d, "vertices"), count(d, "triangles"),   count(d, "views"),
                               count(d, "held_out"), count(d, "image_bytes"), d.at("digest").get<std::string>()};
    fit.times_json = json_text(json.at("times_s"));
    fit.options_json = json_text(json.at("options"));
    fit.provenance_json = json_text(json.at("provenance"));
    return promises;
}

/// read(json), with what goes wrong in it as one line.
template <class Read>
auto reading(const std::filesystem::path& path, const std::string& text, const Read& read, int newest = fit_version) {
    try {
        return read(checked_json(text, newest));
    } catch (const std::exception& e) {
        throw UserError(fmt::format("{}: cannot be used ({}); restore it or fit again", path.string(), e.what()));
    }
}

}  // namespace

std::string fit_to_json(const LightFieldFit& fit, const TriangleAtlas& atlas, const std::string& dataset_path,
                        const std::vector<std::string>& files) {
    const LfmOptions& o = fit.options;
    const size_t vertices = fit.problem_count() / 3;
    Json json = head(fit, lfm_name, o.sides ? newer_version : fit_version);
    json[lfm_name] = {{"terms", o.terms},
                      {"surface_side", o.surface_side},
                      {"view_side", o.view_side},
                      {"lookup", to_string(o.lookup)},
                      {"mode", to_string(o.mode)},
                      {"lambda_surface", plain(o.lambda_surface)},
                      {"lambda_view", plain(o.lambda_view)},
                      {"mu", plain(o.mu)},
                      {"lower", plain(o.lower)},
                      {"upper", plain(o.upper)}};
    if (o.sides) json[lfm_name]["sides"] = checksum_of(*o.sides);
    json["surface_maps"] = {
        {"width", atlas.width()}, {"height", atlas.height()}, {"rectangles_per_row", atlas.rectangles_per_row()}};
    json["view_maps"] = {{"columns", table_columns(vertices)}, {"rows", table_rows(vertices)}};
    add_tail(json, fit, dataset_path, files);
    return to_text(json);
}

TexelFitNotes notes_of(const ReflectanceFit& fit) {
    const TexelOptions& o = fit.options;
    std::vector<std::string> parameters;
    for (int i = 0; i < o.model->parameters; ++i) parameters.push_back(o.model->parameter_name(i));
    const Json own = {{"parameters", parameters},
                      {"curve", name_of(o.curve)},
                      {"surface_side", o.surface_side},
                      {"mode", to_string(o.mode)},
                      {"mu", plain(o.mu)},
                      {"clip_above", plain(o.clip_above)},
                      {"shadow_below", plain(o.shadow_below)}};
    return {o.model->name, reflectance_key, json_text(own), o.curve != ValueCurve::linear};
}

void take_notes(const std::string& model, const std::string& own_json, ReflectanceFit& fit) {
    TexelOptions& o = fit.options;
    o.model = find_texel_model(model);
    if (!o.model) throw std::runtime_error("its model \"" + model + "\" is unknown here");
    const Json r = Json::parse(own_json);
    for (int i = 0; i < o.model->parameters; ++i)
        if (r.at("parameters").at(size_t(i)) != o.model->parameter_name(i))
            throw std::runtime_error("its parameters are those of another version of model " + model);
    if (r.contains("curve")) o.curve = choose("curve", r.at("curve").get<std::string>(), value_curves());
    o.surface_side = whole(r, "surface_side");
    o.mode = one_of(r.at("mode"), {Mode::paper, Mode::modern}, "mode");
    o.mu = number(r, "mu");
    o.clip_above = number(r, "clip_above");
    o.shadow_below = number(r, "shadow_below");
    check_options(o);
}

std::string fit_to_json(const FitRecord& fit, const TexelFitNotes& notes, const Atlas& atlas,
                        const std::string& dataset_path, const std::vector<std::string>& files) {
    Json json = head(fit, notes.model, notes.newer ? newer_version : fit_version);
    json[notes.key] = object_of(notes.own_json, "model's entries");
    json["maps"] = {{"width", atlas.width()}, {"height", atlas.height()}};
    add_tail(json, fit, dataset_path, files);
    return to_text(json);
}

std::vector<std::string> files_in_json(const std::string& text) {
    const Json json = parse_json<Json>(text);
    std::vector<std::string> files;
    if (!json.is_object() || !json.contains("format") || json.at("format") != fit_format || !json.contains("files"))
        return files;
    for (const Json& name : json.at("files"))
        if (name.is_string()) files.push_back(name.get<std::string>());
    return files;
}

std::string checksum_of(const std::vector<uint8_t>& sides) {
    return fmt::format("{:016x}", hash_bytes(sides.data(), sides.size()));
}

std::string model_in_json(const std::filesystem::path& path, const std::string& text) {
    return reading(
        path, text, [](const Json& json) { return json.at("model").get<std::string>(); }, newer_version);
}

FitPromises fit_from_json(const std::filesystem::path& path, const std::string& text, LightFieldFit& fit) {
    return reading(
        path, text,
        [&](const Json& json) {
            if (json.at("model") != lfm_name) throw std::runtime_error("its model is no light field map");
            LfmOptions& o = fit.options;
            const Json& lfm = json.at(lfm_name);
            o.terms = whole(lfm, "terms");
            o.surface_side = whole(lfm, "surface_side");
            o.view_side = whole(lfm, "view_side");
            o.lookup = one_of(lfm.at("lookup"), {ViewLookup::bilinear, ViewLookup::nearest}, "lookup");
            o.mode = one_of(lfm.at("mode"), {Mode::paper, Mode::modern}, "mode");
            o.lambda_surface = number(lfm, "lambda_surface");
            o.lambda_view = number(lfm, "lambda_view");
            o.mu = number(lfm, "mu");
            o.lower = number(lfm, "lower");
            o.upper = number(lfm, "upper");
            check_options(o);
            FitPromises promises = take_record(json, fit);
            if (json.at("version") == newer_version) promises.sides = lfm.at("sides").get<std::string>();
            const auto sides = std::ranges::count(json.at("files"), Json("sides.exr"));
            if (sides != 0 && promises.sides.empty())
                throw std::runtime_error("it lists sides.exr, but its version has none");
            return promises;
        },
        newer_version);
}

FitPromises fit_from_json(const std::filesystem::path& path, const std::string& text, const std::string& key,
                          const TakeNotes& take, FitRecord& fit) {
    return reading(
        path, text,
        [&](const Json& json) {
            take(json.at("model").get<std::string>(), json.contains(key) ? json_text(json.at(key)) : "{}");
            return take_record(json, fit);
        },
        newer_version);
}

}  // namespace radiafit
