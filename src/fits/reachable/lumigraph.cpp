#include "reachable/lumigraph.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "base/parallel.h"

namespace radiafit::fits {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double least_penalty = 1e-9;  // of a photograph from the eye itself, which then counts alone

/// The angle between two unit vectors; accurate where it is small.
double angle_between(const Vec3d& a, const Vec3d& b) { return 2 * std::asin(std::min(1.0, 0.5 * (a - b).norm())); }

/// By how much the direction to a point so far away turns, at most, within a radius.
double widest_turn(double radius, double distance) { return std::asin(std::min(1.0, radius / distance)); }

/// From a point within an image to the nearest of its borders, in pixels.
double distance_to_border(double x, double y, const TargetImage& image) {
    return std::min({x, y, image.width - x, image.height - y});
}

/// Leaves the first k parts, and weighs them.
void weigh(std::vector<Lumigraph::Part>& parts, size_t k) {
    const double threshold = parts.size() > k ? 1 / std::max(parts[k].penalty, least_penalty) : 0;
    if (parts.size() > k) parts.resize(k);
    double sum = 0;
    for (Lumigraph::Part& part : parts) sum += part.weight = 1 / std::max(part.penalty, least_penalty) - threshold;
    // Where all penalties are the threshold, all weights are alike.
    for (Lumigraph::Part& part : parts) part.weight = sum > 0 ? part.weight / sum : 1 / double(parts.size());
}

/// The colours of a photograph's pixels that see the surface, added up, and how many there are.
std::pair<Vec3d, double> sum_of(const SurfacePhotograph& photograph, double scale) {
    Vec3d sum = Vec3d::Zero();
    double count = 0;
    for (size_t pixel = 0; pixel < photograph.inverse_depth().size(); ++pixel) {
        if (!photograph.image().masked_in(pixel) || photograph.inverse_depth()[pixel] == 0) continue;
        const auto channels = photograph.image().channel16(pixel);
        sum += scale * Vec3d(channels[0], channels[1], channels[2]);
        count += 1;
    }
    return {sum, count};
}

}  // namespace

Lumigraph::Eye Lumigraph::eye_of(const Camera& camera) { return {camera.center(), std::sqrt(camera.fx * camera.fy)}; }

Lumigraph::Lumigraph(const Dataset& dataset, const std::vector<uint32_t>& views, TargetSpace space,
                     const LumigraphOptions& options)
    : mesh_(&dataset.mesh), options_(options), photographs_(views.size()) {
    struct Tools {
        ImageStream stream;
        Rasterizer rasterizer;
    };
    const ImageStream stream(dataset, StreamSource::disk, space);
    scale_ = stream.scale16();
    std::vector<std::unique_ptr<Tools>> tools{size_t(thread_count())};
    parallel_for(views.size(), 1, [&](size_t i, int worker) {
        auto& own = tools[size_t(worker)];
        if (!own) own = std::make_unique<Tools>(stream.another());
        photographs_[i].load(own->stream, views[i], dataset.views[views[i]].camera, dataset.mesh, own->rasterizer);
    });
    Vec3d sum = Vec3d::Zero();
    double count = 0;
    for (const SurfacePhotograph& photograph : photographs_) {
        eyes_.push_back(eye_of(photograph.camera()));
        const auto [colours, pixels] = sum_of(photograph, double(scale_));
        sum += colours;
        count += pixels;
    }
    if (count > 0) mean_ = (sum / count).cast<float>();
}

Vec3d Lumigraph::place_of(const RasterPixel& pixel) const {
    const auto& [a, b, c] = mesh_->triangles[pixel.triangle];
    const double b1 = double(pixel.b1), b2 = double(pixel.b2);
    return (1 - b1 - b2) * mesh_->positions[a].cast<double>() + b1 * mesh_->positions[b].cast<double>() +
           b2 * mesh_->positions[c].cast<double>();
}

void Lumigraph::find_candidates(const Eye& eye, uint32_t triangle, std::vector<Candidate>& out) const {
    out.clear();
    Vec3d corners[3], middle = Vec3d::Zero();
    for (size_t k = 0; k < 3; ++k) {
        corners[k] = mesh_->positions[mesh_->triangles[triangle][k]].cast<double>();
        middle += corners[k] / 3;
    }
    double radius = 0;
    for (const Vec3d& corner : corners) radius = std::max(radius, (corner - middle).norm());
    const Vec3d to_eye = eye.place - middle;
    const double turn = widest_turn(radius, to_eye.norm());
    for (uint32_t i = 0; i < photographs_.size(); ++i) {
        const auto plane = photographs_[i].plane_of(*mesh_, triangle);
        if (!plane) continue;
        const Vec3d to_camera = eyes_[i].place - middle;
        const double angle = angle_between(to_eye.normalized(), to_camera.normalized());
        out.push_back({i, angle - turn - widest_turn(radius, to_camera.norm()), *plane});
    }
    std::ranges::sort(out, {}, &Candidate::least);
}

Lumigraph::Part Lumigraph::seen_by(const Candidate& candidate, const Eye& eye, const Vec3d& place) const {
    const SurfacePhotograph& photograph = photographs_[candidate.photograph];
    Part part{candidate.photograph, infinite, 0, Vec3f::Zero()};
    const Vec3d p = photograph.camera().project(place);
    if (!(p.z() > 0 && photograph.contains(p.x(), p.y()))) return part;
    const SurfacePhotograph::Colour colour = photograph.colour(p.x(), p.y(), candidate.plane);
    const double fade = std::min(1.0, distance_to_border(p.x(), p.y(), photograph.image()) / options_.border);
    const Vec3d to_eye = eye.place - place, to_camera = eyes_[candidate.photograph].place - place;
    const double footprint = to_camera.norm() / eyes_[candidate.photograph].focal;
    const double octaves = std::max(0.0, std::log2(footprint * eye.focal / to_eye.norm()));
    const double angle = angle_between(to_eye.normalized(), to_camera.normalized());
    const double share = colour.share * fade;
    if (!(share > 0)) return part;
    part.penalty = (angle + options_.resolution * octaves) / share;
    part.colour = scale_ * Vec3d(colour.rgb[0], colour.rgb[1], colour.rgb[2]).cast<float>();
    return part;
}

void Lumigraph::find_parts(const Eye& eye, const Vec3d& place, const std::vector<Candidate>& candidates,
                           std::vector<Part>& out) const {
    const auto k = size_t(options_.neighbours);
    out.clear();
    for (const Candidate& candidate : candidates) {
        if (out.size() > k && candidate.least >= out[k].penalty) break;  // nor any after it
        const Part part = seen_by(candidate, eye, place);
        if (part.penalty == infinite || (out.size() > k && part.penalty >= out[k].penalty)) continue;
        out.insert(std::ranges::upper_bound(out, part.penalty, {}, &Part::penalty), part);
        if (out.size() > k + 1) out.pop_back();
    }
    weigh(out, k);
}

std::vector<Lumigraph::Part> Lumigraph::parts(const Camera& camera, const RasterPixel& pixel) const {
    std::vector<Candidate> candidates;
    std::vector<Part> out;
    find_candidates(eye_of(camera), pixel.triangle, candidates);
    find_parts(eye_of(camera), place_of(pixel), candidates, out);
    return out;
}

void Lumigraph::shade(const Camera& camera, const std::vector<RasterPixel>& pixels, std::vector<float>& rgb) const {
    rgb.assign(3 * pixels.size(), 0.0f);
    const Eye eye = eye_of(camera);
    // Triangle by triangle, since a triangle's pixels have their candidates in common.
    std::vector<std::pair<uint32_t, uint32_t>> order;
    for (uint32_t i = 0; i < pixels.size(); ++i)
        if (pixels[i].triangle != no_triangle) order.emplace_back(pixels[i].triangle, i);
    std::ranges::sort(order);
    std::vector<Candidate> candidates;
    std::vector<Part> found;
    uint32_t last = no_triangle;
    for (const auto& [triangle, i] : order) {
        if (triangle != last) find_candidates(eye, triangle, candidates);
        last = triangle;
        find_parts(eye, place_of(pixels[i]), candidates, found);
        Vec3f colour = found.empty() ? mean_ : Vec3f(Vec3f::Zero());
        for (const Part& part : found) colour += float(part.weight) * part.colour;
        Vec3f::Map(&rgb[3 * size_t(i)]) = colour;
    }
}

Contestant lumigraph_of(const Dataset& dataset, const std::vector<uint32_t>& views, TargetSpace space,
                        const LumigraphOptions& options) {
    require_light_field(dataset);
    const auto lumigraph = std::make_shared<Lumigraph>(dataset, views, space, options);
    return {[lumigraph](const View& view, const auto& pixels, std::vector<float>& rgb, int) {
                lumigraph->shade(view.camera, pixels, rgb);
            },
            space};
}

}  // namespace radiafit::fits
