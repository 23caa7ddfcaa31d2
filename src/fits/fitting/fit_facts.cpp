#include "fitting/fit_facts.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "fitting/family.h"
#include "fitting/solvers/solver.h"

namespace radiafit::fits {

FitFacts facts_of(const FitRequest& request, bool grid) {
    const Family& family = family_of(request);
    const auto solving = family.facts(find_solver(request.solver));
    if (!solving) {
        std::vector<std::string> others;
        for (const Solver& other : solvers())
            if (family.facts(other)) others.emplace_back(other.name);
        throw UserError(fmt::format("solver {} does not fit {}; choose one of {} for --model {}", request.solver,
                                    family.name, fmt::join(others, ", "), request.text("model")));
    }
    FitFacts facts{*solving};
    facts.family = &family;
    facts.kind = family.kind;
    if (solving->on_engine) facts.engine = request.engine;
    if (facts.texel_local() && facts.on_fragment()) facts.most_parameters = most_fragment_parameters;
    facts.method = request.optimizer;
    facts.samples = request.samples;
    facts.surface = request.surface;
    facts.grid = grid;
    return facts;
}

}  // namespace radiafit::fits
