#include "capture/axes_turn.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>

namespace radiafit::tools {

std::optional<std::array<std::string_view, 3>> three_parts(std::string_view text) {
    std::array<std::string_view, 3> parts;
    for (size_t k = 0; k < 3; ++k) {
        const size_t comma = text.find(',');
        if ((comma == std::string_view::npos) != (k == 2)) return {};
        std::string_view part = text.substr(0, comma);
        while (!part.empty() && part.front() == ' ') part.remove_prefix(1);
        while (!part.empty() && part.back() == ' ') part.remove_suffix(1);
        parts[k] = part;
        text.remove_prefix(k == 2 ? text.size() : comma + 1);
    }
    return parts;
}

std::optional<Mat3d> parse_axes_turn(std::string_view text) {
    const auto parts = three_parts(text);
    if (!parts) return {};
    Mat3d turn = Mat3d::Zero();
    for (int row = 0; row < 3; ++row) {
        std::string_view part = (*parts)[size_t(row)];
        double sign = 1;
        if (part.starts_with('-') || part.starts_with('+')) {
            sign = part[0] == '-' ? -1 : 1;
            part.remove_prefix(1);
        }
        if (part.size() != 1 || part[0] < 'x' || part[0] > 'z') return {};
        turn(row, part[0] - 'x') = sign;
    }
    if (std::abs(turn.determinant()) != 1) return {};  // an axis twice
    return turn;
}

std::string axes_turn_text(const Mat3d& turn) {
    std::string text;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            if (turn(row, column) != 0)
                text += fmt::format("{}{}{}", row ? "," : "", turn(row, column) < 0 ? "-" : "", "xyz"[column]);
    return text;
}

}  // namespace radiafit::tools
