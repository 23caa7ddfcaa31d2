#include "reference/subset_interpolation.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>

namespace radiafit::fits {
namespace {

constexpr uint32_t missing = UINT32_MAX;

Vec2d mixed(std::span<const Vec2d> points, const Triangulation::Weights& w) {
    return w.weight[0] * points[w.point[0]] + w.weight[1] * points[w.point[1]] + w.weight[2] * points[w.point[2]];
}

std::vector<Vec2d> picked(std::span<const Vec2d> points, std::span<const uint32_t> which) {
    std::vector<Vec2d> out;
    for (const uint32_t i : which) out.push_back(points[i]);
    return out;
}

bool each_is_a_corner(const Triangulation& triangulation, size_t points) {
    std::vector<bool> corner(points);
    for (const auto& triangle : triangulation.triangles())
        for (const uint32_t i : triangle) corner[i] = true;
    return std::ranges::all_of(corner, std::identity());
}

}  // namespace

SubsetInterpolation::SubsetInterpolation(std::vector<Vec2d> points, std::vector<Vec2d> places)
    : points_(std::move(points)),
      places_(std::move(places)),
      all_(points_),
      every_point_is_a_corner_(each_is_a_corner(all_, points_.size())) {
    for (const Vec2d& place : places_) base_.push_back(all_.at(place));
}

std::vector<Triangulation::Weights> SubsetInterpolation::by_itself(std::span<const uint32_t> subset) const {
    const Triangulation own(picked(points_, subset));
    std::vector<Triangulation::Weights> out;
    for (const Vec2d& place : places_) out.push_back(own.at(place));
    return out;
}

std::vector<Triangulation::Weights> SubsetInterpolation::of(std::span<const uint32_t> subset) const {
    if (!every_point_is_a_corner_) return by_itself(subset);
    std::vector<uint32_t> position(points_.size(), missing);  // in the subset
    for (uint32_t i = 0; i < subset.size(); ++i) position[subset[i]] = i;
    const auto there = [&](uint32_t point) { return position[point] != missing; };

    std::vector<Triangulation::Weights> out = base_;
    std::vector<size_t> open;  // places whose triangle, or side of the hull, is gone
    for (size_t i = 0; i < out.size(); ++i) {
        if (!std::ranges::all_of(out[i].point, there)) {
            open.push_back(i);
            continue;
        }
        for (uint32_t& point : out[i].point) point = position[point];
    }
    if (open.empty()) return out;

    std::vector<bool> beside(points_.size());  // what is missing
    for (const auto& triangle : all_.triangles())
        if (!std::ranges::all_of(triangle, there))
            for (const uint32_t i : triangle) beside[i] = there(i);
    std::vector<uint32_t> neighbours;
    for (const uint32_t i : subset)
        if (beside[i]) neighbours.push_back(i);
    if (neighbours.size() > subset.size() * 3 / 4) return by_itself(subset);
    const Triangulation hole(picked(points_, neighbours));
    std::vector<std::array<uint32_t, 2>> border;  // of the subset's hull, what is left of the whole one's
    for (const auto& side : all_.border())
        if (std::ranges::all_of(side, there)) border.push_back(side);
    for (const size_t i : open) {
        Triangulation::Weights w = hole.at(places_[i]);
        for (uint32_t& point : w.point) point = neighbours[point];
        if (!w.inside && !border.empty()) {  // sides of the neighbours' hull that lie within the subset's are no nearer
            const Triangulation::Weights other = Triangulation::nearest(points_, border, places_[i]);
            const auto distance = [&](const auto& weights) {
                return (mixed(points_, weights) - places_[i]).squaredNorm();
            };
            if (distance(other) < distance(w)) w = other;
        }
        for (uint32_t& point : w.point) point = position[point];
        out[i] = w;
    }
    return out;
}

}  // namespace radiafit::fits
