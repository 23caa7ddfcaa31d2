#include "capture/mesh_placement.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "base/wording.h"
#include "capture/axes_turn.h"

namespace radiafit::tools {
namespace {

std::optional<Vec3d> parse_shift(std::string_view text) {
    const auto parts = three_parts(text);
    if (!parts) return {};
    Vec3d shift;
    for (int axis = 0; axis < 3; ++axis) {
        std::string_view part = (*parts)[size_t(axis)];
        if (part.starts_with('+')) part.remove_prefix(1);
        const char* end = part.data() + part.size();
        const auto [at, error] = std::from_chars(part.data(), end, shift[axis]);
        if (error != std::errc() || at != end || !std::isfinite(shift[axis])) return {};
    }
    return shift;
}

/// The scale if the matrix is a turn of axes and one scale.
std::optional<double> scale_of(const Mat3d& linear) {
    const double scale = linear.cwiseAbs().maxCoeff();
    if (!(scale > 0)) return {};
    const Mat3d turn = linear / scale;
    for (int k = 0; k < 3; ++k) {
        if (turn.row(k).cwiseAbs().sum() != 1 || turn.col(k).cwiseAbs().sum() != 1) return {};
        if (turn.row(k).cwiseAbs().maxCoeff() != 1) return {};
    }
    return scale;
}

}  // namespace

MeshPlacement parse_placement(std::string_view turn, double scale, std::string_view shift, bool flip_faces) {
    MeshPlacement placement;
    placement.flip_faces = flip_faces;
    if (!turn.empty()) {
        const auto linear = parse_axes_turn(turn);
        if (!linear)
            throw UserError(
                fmt::format("{} {}: give the old axes that the new x, y and z are, each axis once, such as x,z,-y",
                            option_name("mesh-turn"), turn));
        placement.linear = *linear;
    }
    if (!(scale > 0 && std::isfinite(scale)))
        throw UserError(fmt::format("{} {}: give a number above 0", option_name("mesh-scale"), scale));
    if (scale != 1) placement.linear *= scale;
    if (!shift.empty()) {
        const auto parsed = parse_shift(shift);
        if (!parsed)
            throw UserError(
                fmt::format("{} {}: give three numbers, such as 0.5,0,-2", option_name("mesh-shift"), shift));
        placement.shift = *parsed;
    }
    return placement;
}

std::string describe_placement(const MeshPlacement& placement) {
    std::string text;
    const auto add = [&](const std::string& part) { text += (text.empty() ? "" : " ") + part; };
    const auto option = [](const char* name) { return option_name(name); };
    if (const auto scale = scale_of(placement.linear)) {
        const Mat3d turn = placement.linear / *scale;
        if (!turn.isIdentity(0)) add(option("mesh-turn") + " " + axes_turn_text(turn));
        if (*scale != 1) add(fmt::format("{} {}", option("mesh-scale"), *scale));
    } else {
        const Mat3d& m = placement.linear;
        add(fmt::format("linear part {},{},{};{},{},{};{},{},{}", m(0, 0), m(0, 1), m(0, 2), m(1, 0), m(1, 1), m(1, 2),
                        m(2, 0), m(2, 1), m(2, 2)));
    }
    const Vec3d& s = placement.shift;
    if (!s.isZero(0)) add(fmt::format("{} {},{},{}", option("mesh-shift"), s.x(), s.y(), s.z()));
    if (placement.flip_faces) add(option("flip-faces"));
    return text;
}

}  // namespace radiafit::tools
