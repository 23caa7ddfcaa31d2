#include "fitting/resolve_options.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/parallel.h"
#include "base/statistics.h"
#include "fitting/family.h"
#include "fitting/fit_options.h"
#include "geometry/raster.h"

namespace radiafit::fits {
namespace {

/// The camera at a size at which drawing the mesh costs little.
Camera small_camera(Camera camera) {
    constexpr int largest = 256;
    const double scale = std::min(1.0, double(largest) / std::max(camera.width, camera.height));
    camera.width = std::max(1, int(camera.width * scale));
    camera.height = std::max(1, int(camera.height * scale));
    for (double* pixels : {&camera.fx, &camera.fy, &camera.cx, &camera.cy}) *pixels *= scale;
    return camera;
}

struct Place {
    Vec3d position, normal;
};
std::vector<Place> middles_of(const Mesh& mesh) {
    std::vector<Place> places;
    for (const auto& triangle : mesh.triangles) {
        const Vec3d a = mesh.positions[triangle[0]].cast<double>(), b = mesh.positions[triangle[1]].cast<double>(),
                    c = mesh.positions[triangle[2]].cast<double>();
        places.push_back({(a + b + c) / 3, (b - a).cross(c - a)});
    }
    return places;
}

/// How far a place may lie behind the surface that a pixel of a small image sees, which spans much of it.
double slack_of(const Mesh& mesh) {
    Vec3f low = Vec3f::Constant(1e30f), high = -low;
    for (const Vec3f& position : mesh.positions) low = low.cwiseMin(position), high = high.cwiseMax(position);
    return mesh.positions.empty() ? 0 : 0.02 * double((high - low).norm());
}

/// Whether a camera sees the place, no more than `slack` behind what the rasterizer has drawn with it.
bool sees(const Camera& camera, const Rasterizer& raster, const Place& place, double slack) {
    if (!((camera.center() - place.position).dot(place.normal) > 0)) return false;
    const Vec3d at = camera.project(place.position);
    if (!(at.z() > 0 && at.x() >= 0 && at.y() >= 0 && at.x() < camera.width && at.y() < camera.height)) return false;
    const float nearest = raster.inverse_depth()[size_t(at.y()) * size_t(camera.width) + size_t(at.x())];
    return nearest == 0 || at.z() < 1 / double(nearest) + slack;
}

/// The request with a model of this name.
FitRequest of_model(FitRequest request, const std::string& name) {
    request.model_name = name;
    return request;
}

/// The first of the models that suit the dataset that takes what is given; else the one that is fitted by default, so
/// that errors are about it, or the only one.
std::optional<Chosen> chosen_model(const Given& given, const Dataset& dataset, const FitRequest& request) {
    std::optional<Chosen> otherwise;
    for (const Family* family : families()) {
        std::optional<Chosen> chosen = family->choose(given, dataset, request);
        if (!chosen) continue;
        if (takes_given(given, of_model(request, chosen->setting.front().second))) return chosen;
        if (!otherwise || family->owns(FitRequest().model_name)) otherwise = std::move(chosen);
    }
    return otherwise;
}

}  // namespace

double views_per_texel(const Dataset& dataset) {
    const std::vector<uint32_t> training = dataset.split(false);
    if (dataset.has_grid()) return double(training.size());
    const std::vector<Place> places = middles_of(dataset.mesh);
    const double slack = slack_of(dataset.mesh);
    std::vector<std::vector<uint32_t>> counts(size_t(thread_count()), std::vector<uint32_t>(places.size()));
    std::vector<Rasterizer> rasters(counts.size());
    parallel_for(training.size(), 1, [&](size_t i, int worker) {
        const Camera camera = small_camera(dataset.views[training[i]].camera);
        Rasterizer& raster = rasters[size_t(worker)];
        raster.draw(dataset.mesh, camera);
        for (size_t t = 0; t < places.size(); ++t) counts[size_t(worker)][t] += sees(camera, raster, places[t], slack);
    });
    std::vector<double> seen;
    for (size_t t = 0; t < places.size(); ++t) {
        uint32_t sum = 0;
        for (const auto& of_worker : counts) sum += of_worker[t];
        if (sum > 0) seen.push_back(sum);
    }
    return seen.empty() ? 0 : median(std::move(seen));
}

FitRequest resolved_request(const FitSetting& setting, const Dataset& dataset) {
    FitRequest request;
    for (const auto& [option, value] : setting) request.set(option, value);
    family_of(request).resolve_options(given_by(setting), dataset, request);
    return request;
}

std::string resolve_options(const Given& given, const Dataset& dataset, FitRequest& request) {
    std::string line;
    if (auto chosen = given("--model") ? std::nullopt : chosen_model(given, dataset, request)) {
        std::erase_if(chosen->setting,
                      [&](const auto& option) { return given(find_fit_option(option.first).first_flag().c_str()); });
        for (const auto& [option, value] : chosen->setting) request.set(option, value);
        if (chosen->why)
            line = fmt::format("chosen by the data: {} ({}); --model and tune choose otherwise",
                               command_line_of(chosen->setting), chosen->why());
    }
    family_of(request).resolve_options(given, dataset, request);
    request.check();
    return line;
}

}  // namespace radiafit::fits
