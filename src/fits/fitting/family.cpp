#include "fitting/family.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "fitting/fit_options.h"

namespace radiafit::fits {

namespace {
constexpr const Family* all[] = {&view_bases, &light_field_maps, &spherical_gaussians, &light_bases,
                                 &texel_local_models};

const Family& family_of(const std::string& model) {
    return **std::ranges::find_if(all, [&](const Family* family) { return family->owns(model); });
}
}  // namespace

std::span<const Family* const> families() { return all; }

const Family& family_of(const FitRequest& request) { return family_of(request.text("model")); }

Fitted open_fit(const std::filesystem::path& folder, const std::filesystem::path& moved_to) {
    return family_of(fitted_model(folder)).open(folder, moved_to);
}

Plan plan(const Dataset& dataset, const FitRequest& request, size_t most_views) {
    return family_of(request).plan(dataset, request, most_views);
}

FitRequest fitted_request(const FitRecord& fit) {
    FitRequest request;
    const auto options = nlohmann::json::parse(fit.options_json.empty() ? "{}" : fit.options_json, nullptr, false);
    if (!options.is_object()) return request;
    for (const FitOption& option : fit_options()) {
        if (!options.contains(option.name)) continue;
        const auto& value = options.at(option.name);
        const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
        if (!text.empty()) option.read(request, text);
    }
    return request;
}

std::vector<uint32_t> fitted_views(const Dataset& dataset, const FitRecord& fit) {
    FitRequest request;
    request.validation = validation_of(fit);
    const auto options = nlohmann::json::parse(fit.options_json.empty() ? "{}" : fit.options_json, nullptr, false);
    if (options.is_object() && options.contains("leave_out") && options.at("leave_out").is_string())
        request.leave_out = options.at("leave_out").get<std::string>();
    return fitted_views(dataset, request);
}

int validation_of(const FitRecord& fit) {
    const auto options = nlohmann::json::parse(fit.options_json.empty() ? "{}" : fit.options_json, nullptr, false);
    if (!options.is_object() || !options.contains("validation")) return 0;
    const auto& validation = options.at("validation");
    if (!validation.is_number_unsigned() || validation != validation.get<int>() || validation.get<int>() < 0)
        throw UserError(fmt::format("the fit of {}: fit.json's options.validation is no number of views; fit again",
                                    fit.dataset_name));
    return validation.get<int>();
}

}  // namespace radiafit::fits
