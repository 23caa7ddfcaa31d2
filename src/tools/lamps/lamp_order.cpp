#include "lamps/lamp_order.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/decompositions.h"
#include "base/parallel.h"
#include "base/rng.h"
#include "base/statistics.h"

namespace radiafit::tools {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Order = std::vector<uint32_t>;
using Lamps = Eigen::Matrix<double, Eigen::Dynamic, 3>;

constexpr size_t least_in_order = 8;
constexpr int strength_rounds = 5;
constexpr double brightest_kept = 1.5;  // of a pixel's upper decile

/// [images][images] cosines between the images, whose pixels count alike and whose highlights are cut.
MatrixXd cosines(const LightStack& stack) {
    const size_t images = stack.images();
    constexpr size_t parts = 16;
    std::vector<MatrixXd> sums(parts, MatrixXd::Zero(Eigen::Index(images), Eigen::Index(images)));
    parallel_for(parts, 1, [&](size_t part, int) {
        VectorXd row(images);
        for (int y = int(part); y < stack.height; y += int(parts))
            for (int x = 0; x < stack.width; ++x) {
                const float* all = stack.at(x, y);
                std::vector<double> known;
                for (size_t i = 0; i < images; ++i)
                    if (std::isfinite(all[i])) known.push_back(double(all[i]));
                if (2 * known.size() < images) continue;
                const double decile = quantile(std::move(known), 0.9);
                if (!(decile > 0)) continue;
                for (size_t i = 0; i < images; ++i)
                    row[Eigen::Index(i)] =
                        std::isfinite(all[i]) ? std::min(double(all[i]) / decile, brightest_kept) : 1;
                sums[part].selfadjointView<Eigen::Lower>().rankUpdate(row);
            }
    });
    MatrixXd sum = MatrixXd::Zero(Eigen::Index(images), Eigen::Index(images));
    for (const MatrixXd& part : sums) sum += MatrixXd(part.selfadjointView<Eigen::Lower>());
    const VectorXd scale = (sum.diagonal().array() + 1e-12).sqrt().inverse();
    return scale.asDiagonal() * sum * scale.asDiagonal();
}

class Explainer {
public:
    explicit Explainer(const LightStack& stack) : cosines_(cosines(stack)), lamps_(Eigen::Index(stack.images()), 3) {
        for (size_t i = 0; i < stack.images(); ++i) lamps_.row(Eigen::Index(i)) = stack.direction(i).transpose();
        const VectorXd values = symmetric_eigenvalues(cosines_).reverse();
        one_ = double(stack.images()) - values[0];
        changing_ = values[1] + values[2];
        lit_by_lamps_ = changing_ > 0.3 * one_;
    }
    size_t images() const { return size_t(lamps_.rows()); }
    /// Whether three images explain much of what changes, as under any lamps on a matt surface.
    bool lit_by_lamps() const { return lit_by_lamps_; }
    /// What images lit as in this order would explain, beyond one image of many strengths, over what any three images
    /// would.
    double explained(const Order& order) const {
        const Lamps lamps = ordered(order);
        const Basis basis = fitted(lamps, VectorXd::Ones(lamps.rows()));
        double missed = 0;
        for (Eigen::Index i = 0; i < lamps.rows(); ++i) missed += missed_by(basis, lamps.row(i).transpose(), i);
        return (one_ - missed) / std::max(changing_, 1e-12);
    }
    /// [images][entries] squares of each image that every entry's lamp misses, on the surface that the other images
    /// show. trusted: images that the surface is found from.
    MatrixXd misses(const std::vector<uint8_t>& trusted) const {
        MatrixXd out(lamps_.rows(), lamps_.rows());
        parallel_for(images(), 1, [&](size_t i, int) {
            VectorXd use(lamps_.rows());
            for (size_t k = 0; k < images(); ++k) use[Eigen::Index(k)] = trusted[k] && k != i;
            const Basis basis = fitted(lamps_, use);
            for (Eigen::Index k = 0; k < lamps_.rows(); ++k)
                out(Eigen::Index(i), k) = missed_by(basis, lamps_.row(k).transpose(), Eigen::Index(i));
        });
        return out;
    }

private:
    Lamps ordered(const Order& order) const {
        Lamps out(lamps_.rows(), 3);
        for (size_t i = 0; i < order.size(); ++i) out.row(Eigen::Index(i)) = lamps_.row(order[i]);
        return out;
    }
    /// Three images, whose sums weighted by a lamp's direction are what it lights.
    struct Basis {
        Eigen::Matrix<double, 3, Eigen::Dynamic> with_images;  ///< products with each image
        Mat3d with_itself;
    };
    /// In turn with the images' strengths.
    Basis fitted(const Lamps& lamps, const VectorXd& use) const {
        VectorXd strengths = VectorXd::Ones(lamps.rows());
        Basis out;
        for (int round = 0; round < strength_rounds; ++round) {
            const Lamps lit = (use.array() * strengths.array()).matrix().asDiagonal() * lamps;
            const Mat3d inner = lit.transpose() * lit + 1e-9 * Mat3d::Identity();
            const MatrixXd by_images = inner.ldlt().solve(MatrixXd(lit.transpose()));  // [3][images]
            out.with_images.noalias() = by_images * cosines_;
            out.with_itself = out.with_images * by_images.transpose();
            for (Eigen::Index i = 0; i < lamps.rows(); ++i) {
                const Vec3d l = lamps.row(i);
                strengths[i] =
                    std::clamp(l.dot(out.with_images.col(i)) / (l.dot(out.with_itself * l) + 1e-12), 0.05, 20.0);
            }
        }
        return out;
    }
    static double missed_by(const Basis& basis, const Vec3d& lamp, Eigen::Index image) {
        const double along = std::max(0.0, lamp.dot(basis.with_images.col(image)));
        return 1 - along * along / (lamp.dot(basis.with_itself * lamp) + 1e-12);
    }

    MatrixXd cosines_;
    Lamps lamps_;
    double one_ = 0, changing_ = 0;  // squares that one image leaves over, and what two more explain of them
    bool lit_by_lamps_ = false;
};

Order straight(size_t count) {
    Order out(count);
    std::iota(out.begin(), out.end(), 0u);
    return out;
}

/// Runs of digits count as numbers: img2 before img10.
bool before_by_number(const std::string& a, const std::string& b) {
    const auto digit = [](char c) { return c >= '0' && c <= '9'; };
    size_t i = 0, k = 0;
    while (i < a.size() && k < b.size()) {
        if (!digit(a[i]) || !digit(b[k])) {
            if (a[i] != b[k]) return a[i] < b[k];
            ++i, ++k;
            continue;
        }
        const auto number = [&](const std::string& text, size_t& at) {
            while (at + 1 < text.size() && text[at] == '0' && digit(text[at + 1])) ++at;
            const size_t begin = at;
            while (at < text.size() && digit(text[at])) ++at;
            return text.substr(begin, at - begin);
        };
        const std::string x = number(a, i), y = number(b, k);
        if (x != y) return x.size() != y.size() ? x.size() < y.size() : x < y;
    }
    return a.size() - i < b.size() - k;
}

std::vector<OrderFinding> plain_orders(const LightStack& stack) {
    using Kind = OrderFinding::Kind;
    const size_t count = stack.images();
    std::vector<OrderFinding> out;
    Order order = straight(count);
    std::ranges::reverse(order);
    out.push_back({.kind = Kind::reversed, .entry = order});
    for (size_t shift = 1; shift < count; ++shift) {
        for (size_t i = 0; i < count; ++i) order[i] = uint32_t((i + shift) % count);
        const int by = int(2 * shift > count ? ptrdiff_t(shift) - ptrdiff_t(count) : ptrdiff_t(shift));
        out.push_back({.kind = Kind::shifted, .entry = order, .shift = by});
    }
    Order sorted = straight(count);  // images by number
    std::ranges::stable_sort(sorted,
                             [&](uint32_t a, uint32_t b) { return before_by_number(stack.names[a], stack.names[b]); });
    if (!std::ranges::is_sorted(sorted)) {
        for (size_t place = 0; place < count; ++place) order[sorted[place]] = uint32_t(place);
        out.push_back({.kind = Kind::by_number, .entry = order});
    }
    return out;
}

/// The one that explains most. Lamps in a ring that begin elsewhere are like lamps that are turned: of those that
/// explain nearly as much, the first, by the shortest shift.
OrderFinding best_plain_order(const LightStack& stack, const Explainer& explainer) {
    std::vector<OrderFinding> orders = plain_orders(stack);
    parallel_for(orders.size(), 1,
                 [&](size_t k, int) { orders[k].explained_so = explainer.explained(orders[k].entry); });
    const double most = std::ranges::max_element(orders, {}, &OrderFinding::explained_so)->explained_so;
    const double enough = most - 0.25 * (1 - most);
    std::ranges::stable_sort(orders, [](const OrderFinding& a, const OrderFinding& b) {
        const int x = std::abs(a.shift), y = std::abs(b.shift);
        return x != y ? x < y : a.explained_so > b.explained_so;
    });
    return *std::ranges::find_if(orders, [&](const OrderFinding& o) { return o.explained_so >= enough; });
}

/// Images whose lamps are each other's: the others show the surface.
std::optional<OrderFinding> find_swapped(const Explainer& explainer) {
    const size_t count = explainer.images();
    std::vector<uint8_t> trusted(count, 1);
    Order order = straight(count);
    MatrixXd misses;
    constexpr double far_worse = 3;
    for (int round = 0; round < 4; ++round) {
        misses = explainer.misses(trusted);
        std::vector<double> own;
        for (size_t i = 0; i < count; ++i) own.push_back(misses(Eigen::Index(i), Eigen::Index(i)));
        const double typical = median(own);
        for (size_t i = 0; i < count; ++i) {
            const double best = misses.row(Eigen::Index(i)).minCoeff();
            trusted[i] = own[i] < far_worse * std::max(typical, best);
        }
        if (size_t(std::ranges::count(trusted, 1)) * 3 < 2 * count) return {};
    }
    std::vector<uint32_t> odd;
    for (size_t i = 0; i < count; ++i)
        if (!trusted[i]) odd.push_back(uint32_t(i));
    // Each of them takes the entry of another that suits it best, the surest first.
    struct Match {
        double miss;
        uint32_t image, entry;
    };
    std::vector<Match> matches;
    for (const uint32_t i : odd)
        for (const uint32_t k : odd)
            if (k != i && misses(i, k) < misses(i, i) / far_worse) matches.push_back({misses(i, k), i, k});
    std::ranges::sort(matches, {}, &Match::miss);
    std::vector<uint8_t> has(count, 0), taken(count, 0);
    for (const Match& m : matches)
        if (!has[m.image] && !taken[m.entry]) {
            order[m.image] = m.entry;
            has[m.image] = taken[m.entry] = 1;
        }
    // What is taken from an image that gets none is no exchange.
    if (has != taken || std::ranges::count(has, 1) < 2) return {};
    return OrderFinding{
        .kind = OrderFinding::Kind::swapped, .entry = order, .explained_so = explainer.explained(order)};
}

/// What lamps in random order explain.
struct Chance {
    double mean = 0, deviation = 0;
};
Chance chance_of(const Explainer& explainer) {
    constexpr size_t draws = 200;
    std::vector<double> explained(draws);
    parallel_for(draws, 1, [&](size_t n, int) {
        Rng rng(1, n);
        Order order = straight(explainer.images());
        for (size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[rng.index(uint32_t(i))]);
        explained[n] = explainer.explained(order);
    });
    Chance out;
    double squares = 0;
    for (const double e : explained) out.mean += e / draws;
    for (const double e : explained) squares += (e - out.mean) * (e - out.mean) / (draws - 1);
    out.deviation = std::sqrt(squares);
    return out;
}

}  // namespace

std::optional<OrderFinding> find_order(const LightStack& stack) {
    if (stack.images() < least_in_order) return {};
    const Explainer explainer(stack);
    const double said = explainer.explained(straight(stack.images()));
    const Chance chance = chance_of(explainer);
    const double beyond_chance = chance.mean + 5 * chance.deviation;
    const OrderFinding best = best_plain_order(stack, explainer);
    const auto found = [&](OrderFinding finding) {
        finding.explained = said;
        return finding;
    };
    if (best.explained_so > beyond_chance && 1 - best.explained_so < 0.5 * (1 - said)) return found(best);
    if (said > beyond_chance) {
        const std::optional<OrderFinding> swapped = find_swapped(explainer);
        if (swapped && 1 - swapped->explained_so < 0.8 * (1 - said)) return found(*swapped);
        return {};
    }
    // Where chance explains much, a right order would not stand out either.
    const bool tells = explainer.lit_by_lamps() && beyond_chance < 0.7;
    if (tells && said < chance.mean + 3 * chance.deviation) return found({.kind = OrderFinding::Kind::unknown});
    return {};
}

}  // namespace radiafit::tools
