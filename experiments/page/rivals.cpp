#include "page/rivals.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "base/error.h"

namespace radiafit::harness {
namespace {

/// Who brings half of the problems home, the quickest first.
std::vector<Rival> in_order(std::vector<Rival> rivals) {
    std::erase_if(rivals, [](const Rival& r) { return !r.seconds.front(); });
    std::ranges::stable_sort(
        rivals, {}, [](const Rival& r) { return std::pair(r.seconds[1].value_or(INFINITY), *r.seconds.front()); });
    return rivals;
}

}  // namespace

std::vector<Rival> vertex_rivals(const CsvTable& vertices, const CsvTable& solvers) {
    constexpr double channels = 3;
    constexpr size_t few = 20;
    std::map<std::pair<std::string, std::string>, std::vector<double>> times;  // infinite: it did not arrive
    for (size_t i = 0; i < vertices.row_count(); ++i) {
        const double seconds = vertices.number(i, "seconds_to_101");
        if (!(seconds >= 0)) throw UserError("vertices.csv: a time below 0; run the experiment again");
        times[{vertices.text(i, "solver"), vertices.text(i, "setting")}].push_back(
            vertices.number(i, "reached") == channels ? seconds : INFINITY);
    }
    size_t most = 0;
    for (const auto& [name, seconds] : times) most = std::max(most, seconds.size());
    std::vector<Rival> rivals;
    for (size_t i = 0; i < solvers.row_count(); ++i) {
        const std::string &solver = solvers.text(i, "solver"), &setting = solvers.text(i, "setting");
        std::vector<double> seconds = times[{solver, setting}];
        if (seconds.empty() || seconds.size() < std::min(few, most)) continue;
        std::ranges::sort(seconds);
        Rival& rival = rivals.emplace_back();
        rival.solver = solver + (setting.empty() ? "" : " " + setting);
        rival.precision = solvers.text(i, "precision");
        rival.instructions = solvers.text(i, "instructions");
        rival.together = int(solvers.number(i, "together"));
        rival.problems = seconds.size();
        const auto arrived = std::ranges::count_if(seconds, [](double s) { return std::isfinite(s); });
        rival.arrived = double(arrived) / double(seconds.size());
        for (size_t k = 0; k < rival_shares.size(); ++k) {
            const auto needed = size_t(std::ceil(rival_shares[k] * double(seconds.size())));
            if (std::isfinite(seconds[needed - 1])) rival.seconds[k] = seconds[needed - 1];
        }
    }
    rivals = in_order(std::move(rivals));
    bool met = false;
    std::erase_if(rivals, [&](const Rival& r) { return r.solver.starts_with("ceres ") && std::exchange(met, true); });
    return rivals;
}

std::vector<Rival> texel_rivals(const CsvTable& arrival) {
    std::vector<Rival> rivals;
    for (size_t i = 0; i < arrival.row_count(); ++i) {
        const std::string& method = arrival.text(i, "method");
        auto rival = std::ranges::find(rivals, method, &Rival::solver);
        if (rival == rivals.end()) {
            rivals.push_back({method, arrival.text(i, "precision"), arrival.text(i, "instructions"),
                              int(arrival.number(i, "together"))});
            rival = rivals.end() - 1;
        }
        const double texels = arrival.number(i, "texels"), share = arrival.number(i, "arrived_share"),
                     seconds = arrival.number(i, "seconds") / texels;
        rival->problems = size_t(texels);
        rival->arrived = std::max(rival->arrived, share);
        for (size_t k = 0; k < rival_shares.size(); ++k)
            if (share >= rival_shares[k]) rival->seconds[k] = std::min(seconds, rival->seconds[k].value_or(INFINITY));
    }
    return in_order(std::move(rivals));
}

}  // namespace radiafit::harness
