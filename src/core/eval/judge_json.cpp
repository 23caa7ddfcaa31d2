#include <nlohmann/json.hpp>
#include <numbers>

#include "base/json.h"
#include "eval/judge.h"
#include "eval/outliers.h"

namespace radiafit {
namespace {

using Json = nlohmann::ordered_json;  // writes null for what is not finite

void add_figures(Json& json, const ErrorSums& stored, const ErrorSums& linear) {
    json["psnr"] = stored.psnr();
    json["ape"] = stored.ape();
    json["psnr_linear"] = linear.psnr();
    json["ape_linear"] = linear.ape();
}

void add_parts(Json& json, const JudgeResult& result) {
    for (const PartFigures& part : result.parts)
        json["parts"].push_back({{"name", part.name},
                                 {"psnr", part.stored.psnr()},
                                 {"ape", part.stored.ape()},
                                 {"pixels", part.stored.values / 3}});
}

/// Figures of pixels by the angle to the nearest training image.
void add_by_angle(Json& json, const JudgeResult& result) {
    const auto figures = [&](const ErrorSums& sums) {
        return Json{{"pixels", sums.values / 3},
                    {"share", double(sums.values) / double(result.stored.values)},
                    {"psnr", sums.psnr()},
                    {"ape", sums.ape()}};
    };
    double from = 0;
    for (size_t i = 0; i < result.by_angle.bins.size(); ++i) {
        const double to = i < ErrorsByAngle::bounds.size() ? ErrorsByAngle::bounds[i] : 180;
        Json entry = {{"degrees", {from, to}}};
        entry.update(figures(result.by_angle.bins[i]));
        json["by_angle"].push_back(entry);
        from = to;
    }
    json["unseen"] = figures(result.by_angle.unseen);
}

/// Figures of images amid the training views' directions, and beyond them.
void add_hull(Json& json, const JudgeResult& result) {
    if (result.split == Split::train) return;
    const auto add = [&](const char* name, const ErrorSums& sums, size_t images) {
        json[name] = {{"images", images}, {"psnr", sums.psnr()}, {"ape", sums.ape()}};
    };
    add("inside", result.inside, result.images.size() - result.outside_count);
    add("outside", result.outside, result.outside_count);
}

}  // namespace

std::string judge_json(const JudgeResult& result, const JudgeResult* baseline, std::span<const MaterialErrors> truth,
                       std::span<const JudgedBeside> beside) {
    Json json;
    add_figures(json, result.stored, result.linear);
    if (result.ssim.windows) json["ssim"] = result.ssim.mean();
    json["split"] = to_string(result.split);
    json["pixel_points"] = result.pixel_points;
    json["images"] = result.images.size();
    json["pixels"] = result.stored.values / 3;
    json["not_finite"] = result.stored.not_finite;
    json["missing_share"] = result.missing_share();
    json["psnr_with_missing"] = result.with_missing().psnr();
    if (const ErrorBarFigures& bars = result.error_bars; bars.values > 0)
        json["error_bars"] = {{"within", bars.within_share()},
                              {"doubtful", bars.doubtful_share()},
                              {"psnr_sound", bars.sound.psnr()},
                              {"psnr_doubtful", bars.doubtful.psnr()}};
    add_parts(json, result);
    add_hull(json, result);
    if (result.by_angle.any()) add_by_angle(json, result);
    if (baseline) {
        add_figures(json["baseline"], baseline->stored, baseline->linear);
        if (baseline->ssim.windows) json["baseline"]["ssim"] = baseline->ssim.mean();
        add_parts(json["baseline"], *baseline);
        add_hull(json["baseline"], *baseline);
    }
    for (const JudgedBeside& other : beside) {
        add_figures(json["beside"][other.name], other.result.stored, other.result.linear);
        if (other.result.ssim.windows) json["beside"][other.name]["ssim"] = other.result.ssim.mean();
    }
    json["outliers"] = outlying_images(result);
    for (const MaterialErrors& m : truth) {
        Json entry = {{"name", m.name}, {"texels", m.texels}, {"rmse", m.rmse}};
        if (m.comparable) {
            entry["worst_median"] = m.worst_median;
            entry["worst_90"] = m.worst_90;
            if (const TruthShare all = m.within_all(); all.values > 0) {
                entry["within"] = all.share();
                for (size_t i = 0; i < m.within.size(); ++i)
                    entry["within_each"][m.parameters[i]] = {{"values", m.within[i].values},
                                                             {"share", m.within[i].share()}};
            }
            for (size_t i = 0; i < m.parameters.size(); ++i) entry["median"][m.parameters[i]] = m.median[i];
        }
        json["truth"].push_back(entry);
    }
    json["per_image"] = Json::array();
    for (size_t i = 0; i < result.images.size(); ++i) {
        const ImageFigures& image = result.images[i];
        Json entry = {{"name", image.name}};
        add_figures(entry, image.stored, image.linear);
        if (baseline) entry["baseline_psnr"] = baseline->images[i].stored.psnr();
        if (image.ssim.windows) entry["ssim"] = image.ssim.mean();
        entry["pixels"] = image.pixels;
        if (image.gain.uniform())
            entry["gain"] = image.gain[0];
        else
            entry["gain"] = image.gain.channels;
        entry["share_of_fit"] = image.share_of_fit;
        entry["degrees_outside"] = image.outside * 180 / std::numbers::pi;
        json["per_image"].push_back(entry);
    }
    return json_text(json, 2);
}

}  // namespace radiafit
