#pragma once
#include <span>
#include <vector>

#include "cpu/texel_batch.h"
#include "model/texel_local.h"
#include "model/texel_options.h"
#include "optim/engine.h"

namespace radiafit {

/// The CPU's Engine for a texel-local model: a problem per texel, eight texels at a time, one step length for all
/// parameters of a texel. `Text`: a model's text with real = Pack.
///
/// E is over S-bar = samples of the texel; lambda is 0 (a Laplacian over texels would couple problems); mu E_b holds
/// every parameter to the model's bounds. Texels are independent, so results depend on neither threads nor on which
/// texels share a batch.
template <class Text>
class TexelEngine {
public:
    using Model = TexelLocal<Text>;
    using Batch = TexelBatch<Text::term_count>;
    static constexpr size_t N = size_t(Model::parameters);

    /// batches: the samples of texels 8 i to 8 i + 7; must outlive the engine. texels: how many there are.
    TexelEngine(std::span<const Batch> batches, size_t texels, const TexelOptions& options)
        : batches_(batches), texels_(texels), mode_(options.mode), mu_(options.mu) {}

    size_t problem_count() const { return texels_; }
    /// mean: of the targets.
    ProblemStatistics count();
    /// start [texels][N], TexelLocal's order
    void reset(std::span<const float> start);
    void fit_terms(int, int) {}
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
    void read_parameters(std::span<float> out) const;  ///< not in the canonical gauge

    uint64_t bytes() const { return bytes(texels_); }  ///< of the vectors and states
    static uint64_t bytes(uint64_t texels) {
        const uint64_t batches = (texels + Pack::size - 1) / Pack::size;
        return batches * (7 * sizeof(Vector) + sizeof(Pack) + sizeof(Life)) + texels * sizeof(State);
    }

    // What tests look at: texel t's, after direction_pass(true) and line_pass().
    struct Evaluation {
        float error;
        std::array<float, N> gradient, diagonal;
    };
    Evaluation evaluation(size_t texel) const;
    ProblemText<float>::LineSums line(size_t texel) const { return states_[texel].sums; }
    void set_line(std::span<const float> p, std::span<const float> d);  ///< [texels][N] each, for line_pass()

private:
    using real = float;  // of the constants in the shared text
    using ProblemState = ProblemText<float>;
    using Vector = std::array<Pack, N>;
    struct State {
        typename ProblemState::ProblemState state;
        float alpha, trial_error, trial_norm, cross, conjugate;
        typename ProblemState::LineSums sums;
        bool active() const { return state.status == float(Status::active); }
    };
    /// Of a batch, all its texels together. Those that ended in the last pass A may still have a trial to take over.
    enum class Life : uint8_t { over, ended, active };
    /// body(batch) for those that live so much or more.
    template <class Body>
    void for_batches(Life least, const Body& body);
    /// body(state) for the texels of such batches; then what they live on as.
    template <class Body>
    void update_states(Life least, const Body& body);
    void set_life(size_t batch);
    /// A pack of each texel's `of(state)`.
    template <class Of>
    Pack gather(size_t batch, const Of& of) const;
    template <class Put>
    void scatter(size_t batch, const Put& put);
    void precondition(size_t batch);
    static void set(std::vector<Vector>& vectors, std::span<const float> from);

    std::span<const Batch> batches_;
    size_t texels_;
    Mode mode_;
    float mu_;
    std::vector<State> states_;
    std::vector<Life> life_;
    std::vector<Pack> inverse_samples_;  ///< 1 / S-bar
    std::vector<Vector> p_, trial_, d_, g_, trial_g_, precondition_, fresh_;
};

}  // namespace radiafit
