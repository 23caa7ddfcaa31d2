#include "exchange/normal_integration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

#include "base/error.h"
#include "base/parallel.h"

namespace radiafit::tools {
namespace {

constexpr double least_facing = 0.05;  // n_z that normals count with at least
constexpr double membrane = 1e-4;      // weight of a pair without two normals, where one that lies flat has 1
constexpr double tolerance = 1e-7;     // of the error's energy norm
constexpr int most_steps = 1000;       // some tens are needed; rounding could keep it from the tolerance
constexpr int coarsest = 2;            // texels a side

/// A network of springs over a grid: row by row, what joins a texel to the next in its row and in its column.
struct Network {
    int width, height;
    std::vector<double> right, down;  ///< [height][width] weights, 0: not joined
    std::vector<double> sum;          ///< [height][width] of a texel's weights: the matrix's diagonal

    Network(int w, int h) : width(w), height(h), right(size()), down(size()), sum(size()) {}
    size_t size() const { return size_t(width) * size_t(height); }
    size_t at(int x, int y) const { return size_t(y) * size_t(width) + size_t(x); }

    void sum_up() {
        each_row([&](int y) {
            for (int x = 0; x < width; ++x) {
                const size_t i = at(x, y);
                sum[i] = right[i] + down[i] + (x > 0 ? right[i - 1] : 0) + (y > 0 ? down[i - size_t(width)] : 0);
            }
        });
    }
    /// Of a texel's neighbours, by their weights.
    double neighbours(const std::vector<double>& z, int x, int y) const {
        const size_t i = at(x, y), row = size_t(width);
        double out = 0;
        if (x + 1 < width) out += right[i] * z[i + 1];
        if (x > 0) out += right[i - 1] * z[i - 1];
        if (y + 1 < height) out += down[i] * z[i + row];
        if (y > 0) out += down[i - row] * z[i - row];
        return out;
    }
    void each_row(const std::function<void(int y)>& body) const {
        const size_t grain = std::max<size_t>(1, 16384 / size_t(width));
        parallel_for(size_t(height), grain, [&](size_t y, int) { body(int(y)); });
    }
    /// Adds numbers of texels row by row, so that threads change nothing.
    template <class Number>
    double total(const Number& of) const {
        std::vector<double> rows(static_cast<size_t>(height));
        each_row([&](int y) {
            for (int x = 0; x < width; ++x) rows[size_t(y)] += of(at(x, y));
        });
        double out = 0;
        for (const double row : rows) out += row;
        return out;
    }
    /// out = A z, the graph's Laplacian.
    void apply(const std::vector<double>& z, std::vector<double>& out) const {
        each_row([&](int y) {
            for (int x = 0; x < width; ++x) {
                const size_t i = at(x, y);
                out[i] = sum[i] * z[i] - neighbours(z, x, y);
            }
        });
    }
    /// Gauss-Seidel over the texels of one colour of a chessboard.
    void relax(const std::vector<double>& b, std::vector<double>& z, int colour) const {
        each_row([&](int y) {
            for (int x = (y + colour) % 2; x < width; x += 2) {
                const size_t i = at(x, y);
                if (sum[i] > 0) z[i] = (b[i] + neighbours(z, x, y)) / sum[i];
            }
        });
    }
};

/// Of blocks of 2 x 2 texels. Two springs side by side add up, and each is twice as long as before: the factor 1/2
/// makes the coarse Laplacian that of the same surface, without which piecewise constant steps go half as far as they
/// should (Braess, Computing 1995).
Network halved(const Network& fine) {
    Network coarse((fine.width + 1) / 2, (fine.height + 1) / 2);
    for (int y = 0; y < fine.height; ++y)
        for (int x = 0; x < fine.width; ++x) {
            const size_t i = fine.at(x, y), block = coarse.at(x / 2, y / 2);
            if (x % 2 == 1) coarse.right[block] += 0.5 * fine.right[i];
            if (y % 2 == 1) coarse.down[block] += 0.5 * fine.down[i];
        }
    coarse.sum_up();
    return coarse;
}

/// An approximate inverse of a network's Laplacian, symmetric and positive, as conjugate gradients want it.
class VCycle {
public:
    explicit VCycle(const Network& finest) {
        levels_.push_back({&finest, {}, {}, {}});
        while (levels_.back().network->width > coarsest || levels_.back().network->height > coarsest) {
            owned_.push_back(std::make_unique<const Network>(halved(*levels_.back().network)));
            levels_.push_back({owned_.back().get(), {}, {}, {}});
        }
        for (Level& level : levels_)
            for (auto* vector : {&level.b, &level.z, &level.left}) vector->resize(level.network->size());
    }
    void apply(const std::vector<double>& b, std::vector<double>& z) {
        levels_[0].b = b;
        descend(0);
        z = levels_[0].z;
    }

private:
    struct Level {
        const Network* network;
        std::vector<double> b, z, left;
    };

    void descend(size_t depth) {
        Level& level = levels_[depth];
        const Network& network = *level.network;
        std::ranges::fill(level.z, 0.0);
        for (const int colour : {0, 1}) network.relax(level.b, level.z, colour);
        if (depth + 1 < levels_.size()) {
            network.apply(level.z, level.left);
            Level& coarse = levels_[depth + 1];
            const Network& blocks = *coarse.network;
            blocks.each_row([&](int y) {
                for (int x = 0; x < blocks.width; ++x) {
                    double sum = 0;
                    for (int j = 2 * y; j < std::min(2 * y + 2, network.height); ++j)
                        for (int i = 2 * x; i < std::min(2 * x + 2, network.width); ++i)
                            sum += level.b[network.at(i, j)] - level.left[network.at(i, j)];
                    coarse.b[blocks.at(x, y)] = sum;
                }
            });
            descend(depth + 1);
            network.each_row([&](int y) {
                for (int x = 0; x < network.width; ++x)
                    if (network.sum[network.at(x, y)] > 0)
                        level.z[network.at(x, y)] += coarse.z[blocks.at(x / 2, y / 2)];
            });
        }
        for (const int colour : {1, 0}) network.relax(level.b, level.z, colour);
    }

    std::vector<std::unique_ptr<const Network>> owned_;
    std::vector<Level> levels_;
};

/// A z = b, by preconditioned conjugate gradients (Hestenes & Stiefel 1952). A is singular, of a constant for each
/// piece of surface, and b in its range.
std::vector<double> solve(const Network& network, const std::vector<double>& b) {
    const size_t n = network.size();
    std::vector<double> z(n), r = b, conditioned(n), direction(n), along(n);
    VCycle cycle(network);
    double before = 0, first = 0;
    for (int step = 0; step < most_steps; ++step) {
        cycle.apply(r, conditioned);
        const double now = network.total([&](size_t i) { return r[i] * conditioned[i]; });
        if (step == 0) first = now;
        if (!(now > tolerance * tolerance * first)) break;
        const double keep = step == 0 ? 0 : now / before;
        network.each_row([&](int y) {
            for (size_t i = network.at(0, y); i < network.at(0, y) + size_t(network.width); ++i)
                direction[i] = conditioned[i] + keep * direction[i];
        });
        network.apply(direction, along);
        const double length = now / network.total([&](size_t i) { return direction[i] * along[i]; });
        if (!std::isfinite(length)) break;
        network.each_row([&](int y) {
            for (size_t i = network.at(0, y); i < network.at(0, y) + size_t(network.width); ++i) {
                z[i] += length * direction[i];
                r[i] -= length * along[i];
            }
        });
        before = now;
    }
    return z;
}

/// Makes the mean of every connected piece 0, and counts them.
int centre_parts(const Network& network, std::span<const uint8_t> surface, std::vector<double>& z) {
    std::vector<uint8_t> seen(network.size());
    std::vector<size_t> part;
    const auto row = size_t(network.width);
    int parts = 0;
    for (size_t start = 0; start < seen.size(); ++start) {
        if (seen[start] || (!surface.empty() && !surface[start])) continue;
        part.assign(1, start);
        seen[start] = 1;
        double sum = 0;
        const auto visit = [&](bool joined, size_t i) {
            if (!joined || seen[i]) return;
            seen[i] = 1;
            part.push_back(i);
        };
        for (size_t k = 0; k < part.size(); ++k) {
            const size_t i = part[k];
            sum += z[i];
            visit(network.right[i] > 0, i + 1);
            visit(i > 0 && network.right[i - 1] > 0, i - 1);
            visit(network.down[i] > 0, i + row);
            visit(i >= row && network.down[i - row] > 0, i - row);
        }
        for (const size_t i : part) z[i] -= sum / double(part.size());
        ++parts;
    }
    return parts;
}

struct Slope {
    bool known;
    double right, down, facing;
};

Slope slope_of(const Vec3f& n) {
    if (n == Vec3f::Zero()) return {false, 0, 0, 0};
    const double facing = std::max(least_facing, double(n.z()));
    return {true, -double(n.x()) / facing, double(n.y()) / facing, facing};
}

}  // namespace

HeightMap integrate_normals(int width, int height, std::span<const Vec3f> normals, std::span<const uint8_t> surface,
                            const std::array<double, 2>& step) {
    const size_t texels = width < 1 || height < 1 ? 0 : size_t(width) * size_t(height);
    if (texels == 0 || normals.size() != texels || (!surface.empty() && surface.size() != texels))
        throw UserError(fmt::format("{} normals and a mask of {} for {} x {} texels: give one for each", normals.size(),
                                    surface.size(), width, height));
    if (!(step[0] > 0 && step[1] > 0 && std::isfinite(step[0]) && std::isfinite(step[1])))
        throw UserError(fmt::format("a grid of {} x {} steps: give widths above 0", step[0], step[1]));
    for (size_t i = 0; i < texels; ++i)
        if (!normals[i].allFinite())
            throw UserError(fmt::format("normal {} is not finite: give 0 0 0 where it is unknown", i));
    const auto is_surface = [&](size_t i) { return surface.empty() || surface[i]; };
    Network network(width, height);
    std::vector<double> b(texels);
    const auto join = [&](size_t i, size_t k, double Slope::*direction, double length, double& weight) {
        if (!is_surface(i) || !is_surface(k)) return;
        const Slope one = slope_of(normals[i]), other = slope_of(normals[k]);
        const bool known = one.known && other.known;
        weight = known ? one.facing * other.facing : membrane;
        const double rise = known ? length * (one.*direction + other.*direction) / 2 : 0;
        b[i] -= weight * rise;
        b[k] += weight * rise;
    };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const size_t i = network.at(x, y);
            if (x + 1 < width) join(i, i + 1, &Slope::right, step[0], network.right[i]);
            if (y + 1 < height) join(i, i + size_t(width), &Slope::down, step[1], network.down[i]);
        }
    network.sum_up();
    std::vector<double> z = solve(network, b);
    HeightMap out;
    out.parts = centre_parts(network, surface, z);
    out.heights.assign(z.begin(), z.end());
    return out;
}

}  // namespace radiafit::tools
