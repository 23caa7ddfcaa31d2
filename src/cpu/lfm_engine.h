#pragma once
#include <cstring>
#include <span>
#include <vector>

#include "base/parallel.h"
#include "cpu/lfm_problem.h"
#include "cpu/vertex_problem.h"
#include "optim/engine.h"

namespace radiafit {

/// The CPU's Engine over the vertices of a Problem (LfmProblem, or VertexProblem's one): all cores, one vertex (three
/// problems, in lanes) at a time. Vertices are independent, so results don't depend on the number of threads. Vertices
/// whose three problems have stopped are skipped.
template <class Problem>
class LfmEngine {
public:
    using real = typename Problem::Real;
    using V = Lanes<real>;
    /// The problem must outlive the engine.
    explicit LfmEngine(Problem& problem) : problem_(&problem) {}

    size_t problem_count() const { return 3 * problem_->vertex_count(); }
    ProblemStatistics count();
    void reset(std::span<const float> start);
    void fit_terms(int first, int last) { first_term_ = first, last_term_ = last; }
    void direction_pass(bool diagonal);
    void project(Rule rule, bool fresh);
    void after_direction(Rule rule, bool restart, ProblemText<float>::StopRules stop);
    void update_direction(Rule rule, bool fresh);
    void line_pass();
    void after_line(Rule rule, ProblemText<float>::StopRules stop);
    void advance();
    EngineSummary summary() const;
    void outcomes(std::span<ProblemOutcome> out) const;
    void read_errors(std::span<float> out) const;
    void read_parameters(std::span<float> out) const;

    uint64_t bytes() const;  ///< of the vectors and states

private:
    using Text = ProblemText<real>;
    struct Channel {
        typename Text::ProblemState state;
        real alpha, trial_error, trial_norm, cross, conjugate;
        typename Text::LineSums sums;
    };
    struct Vertex {
        Channel channel[3];
        bool active() const {
            for (const Channel& c : channel)
                if (c.state.status == real(0)) return true;
            return false;
        }
    };
    /// body(v, begin, end): a vertex and its range of lanes in the vectors; vertices that had stopped are left out.
    template <class Body>
    void for_active(const Body& body);

    Problem* problem_;
    int first_term_ = 0, last_term_ = 1 << 30;
    std::vector<uint32_t> samples_;
    std::vector<Vertex> vertices_;
    std::vector<V> p_, trial_, d_, g_, trial_g_, precondition_, fresh_;
};

/// Every pass runs over all samples in memory.
template <class real>
using StreamEngine = LfmEngine<LfmProblem<real>>;

extern template class LfmEngine<LfmProblem<float>>;
extern template class LfmEngine<LfmProblem<double>>;
extern template class LfmEngine<VertexProblem>;
static_assert(Engine<StreamEngine<float>> && Engine<StreamEngine<double>> && Engine<LfmEngine<VertexProblem>>);

}  // namespace radiafit
