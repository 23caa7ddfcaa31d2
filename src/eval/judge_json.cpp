#include <nlohmann/json.hpp>

#include "eval/judge.h"

namespace radiafit {
namespace {

using Json = nlohmann::ordered_json;  // writes null for what is not finite

void add_figures(Json& json, const ErrorSums& stored, const ErrorSums& linear) {
    json["psnr"] = stored.psnr();
    json["ape"] = stored.ape();
    json["psnr_linear"] = linear.psnr();
    json["ape_linear"] = linear.ape();
}

}  // namespace

std::string judge_json(const JudgeResult& result, const JudgeResult* baseline) {
    Json json;
    add_figures(json, result.stored, result.linear);
    json["split"] = to_string(result.split);
    json["images"] = result.images.size();
    json["pixels"] = result.stored.values / 3;
    json["not_finite"] = result.stored.not_finite;
    if (baseline) add_figures(json["baseline"], baseline->stored, baseline->linear);
    json["per_image"] = Json::array();
    for (const ImageFigures& image : result.images) {
        Json entry = {{"name", image.name}};
        add_figures(entry, image.stored, image.linear);
        entry["pixels"] = image.pixels;
        entry["gain"] = image.gain;
        json["per_image"].push_back(entry);
    }
    return json.dump(2);
}

}  // namespace radiafit
