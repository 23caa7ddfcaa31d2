#include "reference/ceres_solver.h"

#include <ceres/gradient_problem.h>
#include <ceres/gradient_problem_solver.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <fmt/format.h>
#include <glog/logging.h>

#include <cmath>

#include "base/clock.h"
#include "base/config.h"
#include "base/error.h"
#include "reference/ceres_blocks.h"
#include "reference/channel_energy.h"

namespace radiafit {
namespace {

using V = Lanes<double>;

/// How one setting configures Ceres.
struct Method {
    CeresSetting face;
    enum Kind { trust_region, line_search } kind;
    CeresBlocks blocks = CeresBlocks::texels;
    ceres::LinearSolverType linear = ceres::SPARSE_NORMAL_CHOLESKY;
    ceres::PreconditionerType preconditioner = ceres::JACOBI;
    ceres::LineSearchDirectionType direction = ceres::LBFGS;
};

constexpr Method methods[] = {
    {{"sparse-normal-cholesky", "trust region, sparse Cholesky of J'J"}, Method::trust_region},
    {{"dense-normal-cholesky", "trust region, dense Cholesky of J'J"},
     Method::trust_region,
     CeresBlocks::texels,
     ceres::DENSE_NORMAL_CHOLESKY},
    {{"dense-qr", "trust region, dense QR of J"}, Method::trust_region, CeresBlocks::texels, ceres::DENSE_QR},
    {{"dense-schur", "trust region, an independent set of texels eliminated, dense Cholesky of the rest"},
     Method::trust_region,
     CeresBlocks::texels,
     ceres::DENSE_SCHUR},
    {{"dense-schur-maps", "trust region, whole surface maps eliminated, dense Cholesky of the view map"},
     Method::trust_region,
     CeresBlocks::maps,
     ceres::DENSE_SCHUR},
    {{"sparse-schur", "trust region, an independent set of texels eliminated, sparse Cholesky of the rest"},
     Method::trust_region,
     CeresBlocks::texels,
     ceres::SPARSE_SCHUR},
    {{"iterative-schur", "trust region, an independent set of texels eliminated, conjugate gradients on the rest"},
     Method::trust_region,
     CeresBlocks::texels,
     ceres::ITERATIVE_SCHUR,
     ceres::SCHUR_JACOBI},
    {{"cgnr", "trust region, conjugate gradients on J'J"}, Method::trust_region, CeresBlocks::texels, ceres::CGNR},
    {{"lbfgs", "line search, limited-memory BFGS"}, Method::line_search},
    {{"nonlinear-cg", "line search, nonlinear conjugate gradients"},
     Method::line_search,
     CeresBlocks::texels,
     ceres::CGNR,
     ceres::JACOBI,
     ceres::NONLINEAR_CONJUGATE_GRADIENT},
};

const Method& find(const std::string& name) {
    std::vector<std::string> names;
    for (const Method& m : methods) {
        if (name == m.face.name) return m;
        names.push_back(m.face.name);
    }
    throw UserError(fmt::format("ceres setting '{}' does not exist; choose one of {} (nearest: {})", name,
                                fmt::join(names, ", "), nearest(name, names)));
}

/// Stops where the cost is small enough.
class EnoughCallback final : public ceres::IterationCallback {
public:
    explicit EnoughCallback(double enough) : enough_(enough) {}
    ceres::CallbackReturnType operator()(const ceres::IterationSummary& now) override {
        return now.cost <= enough_ ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
    }

private:
    double enough_;
};

/// What both kinds of summary say about one channel. `before`: seconds of work that Ceres' clock doesn't hold.
void take(const std::vector<ceres::IterationSummary>& rows, ceres::TerminationType termination, double initial_cost,
          double before, VertexRun::Channel& out) {
    for (const ceres::IterationSummary& row : rows) {
        out.error.push_back(row.cost);
        out.time_s.push_back(before + row.cumulative_time_in_seconds);
    }
    if (rows.empty()) {  // no step was tried
        out.error = {initial_cost};
        out.time_s = {before};
    }
    switch (termination) {
        case ceres::CONVERGENCE:
            out.status = Status::stationary;
            break;
        case ceres::NO_CONVERGENCE:
            out.status = Status::max_iterations;
            break;
        case ceres::USER_SUCCESS:
            out.status = Status::residual;
            break;
        default:  // no step lowers the cost, or there is no cost
            out.status = std::isfinite(out.error.back()) ? Status::stationary : Status::not_finite;
    }
}

void take_channel(std::span<const V> p, int c, std::vector<double>& x) {
    for (size_t i = 0; i < p.size(); ++i) x[i] = p[i][c];
}
void give_channel(const std::vector<double>& x, int c, std::span<V> p) {
    for (size_t i = 0; i < p.size(); ++i) p[i][c] = x[i];
}

ceres::Solver::Options trust_region_options(const Method& method, CeresVertex& blocks) {
    ceres::Solver::Options o;
    o.linear_solver_type = method.linear;
    o.preconditioner_type = method.preconditioner;
    // By measurement: CXSparse is the fastest at some hundred unknowns; the default radius of 1e4 wastes steps.
    o.sparse_linear_algebra_library_type = ceres::CX_SPARSE;
    o.initial_trust_region_radius = 100;
    if (method.blocks == CeresBlocks::maps) {  // else Ceres finds an independent set itself
        o.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
        for (double* block : blocks.surface()) o.linear_solver_ordering->AddElementToGroup(block, 0);
        for (double* block : blocks.view()) o.linear_solver_ordering->AddElementToGroup(block, 1);
    }
    o.function_tolerance = 1e-9;
    o.gradient_tolerance = 1e-14;
    o.parameter_tolerance = 1e-12;
    o.num_threads = 1;
    o.logging_type = ceres::SILENT;
    return o;
}

void solve_trust_region(const Method& method, int iterations, EnoughCallback& enough, const LfmVertex& vertex,
                        std::span<V> p, VertexRun& run) {
    const Stopwatch clock;
    CeresVertex blocks(vertex, method.blocks);
    ceres::Solver::Options o = trust_region_options(method, blocks);
    o.max_num_iterations = iterations;
    o.callbacks.push_back(&enough);
    run.setup_s = clock.wall_s();
    for (int c = 0; c < 3; ++c) {
        const Stopwatch own;
        blocks.set_channel(c);
        take_channel(p, c, blocks.x());
        run.setup_s += own.wall_s();
        ceres::Solver::Summary summary;
        ceres::Solve(o, &blocks.problem(), &summary);
        take(summary.iterations, summary.termination_type, summary.initial_cost, 0, run.channel[c]);
        give_channel(blocks.x(), c, p);
    }
}

/// y -> E_t(scale y): one change of variables makes the diagonal of J'J at the start one.
class ScaledEnergy final : public ceres::FirstOrderFunction {
public:
    ScaledEnergy(const ChannelEnergy& energy, const std::vector<double>& scale)
        : energy_(&energy), scale_(&scale), x_(energy.size()) {}
    int NumParameters() const override { return int(energy_->size()); }
    bool Evaluate(const double* y, double* cost, double* gradient) const override {
        for (size_t i = 0; i < x_.size(); ++i) x_[i] = (*scale_)[i] * y[i];
        *cost = energy_->evaluate(x_.data(), gradient);
        for (size_t i = 0; gradient && i < x_.size(); ++i) gradient[i] *= (*scale_)[i];
        return true;
    }

private:
    const ChannelEnergy* energy_;
    const std::vector<double>* scale_;
    mutable std::vector<double> x_;
};

void solve_line_search(const Method& method, int iterations, EnoughCallback& enough, const LfmVertex& vertex,
                       std::span<V> p, VertexRun& run) {
    ceres::GradientProblemSolver::Options o;
    o.line_search_direction_type = method.direction;
    o.nonlinear_conjugate_gradient_type = ceres::FLETCHER_REEVES;  // the other two end early on many problems
    o.max_num_iterations = iterations;
    o.function_tolerance = 1e-12;  // line searches fall slowly long before they are done
    o.gradient_tolerance = 1e-14;
    o.parameter_tolerance = 1e-12;
    o.logging_type = ceres::SILENT;
    o.callbacks.push_back(&enough);
    std::vector<double> x(vertex.size()), scale(vertex.size());
    for (int c = 0; c < 3; ++c) {
        const Stopwatch setup;
        const ChannelEnergy energy(vertex, c);
        take_channel(p, c, x);
        run.setup_s += setup.wall_s();
        const Stopwatch own;
        scale = energy.diagonal(x.data());
        for (size_t i = 0; i < x.size(); ++i) {
            scale[i] = 1 / std::sqrt(scale[i]);
            x[i] /= scale[i];
        }
        ceres::GradientProblem problem(new ScaledEnergy(energy, scale));  // which owns it
        const double before = own.wall_s();
        ceres::GradientProblemSolver::Summary summary;
        ceres::Solve(o, problem, x.data(), &summary);
        take(summary.iterations, summary.termination_type, summary.initial_cost, before, run.channel[c]);
        for (size_t i = 0; i < x.size(); ++i) x[i] *= scale[i];
        give_channel(x, c, p);
    }
}

}  // namespace

std::span<const CeresSetting> ceres_settings() {
    static const std::vector<CeresSetting> faces = [] {
        std::vector<CeresSetting> out;
        for (const Method& m : methods) out.push_back(m.face);
        return out;
    }();
    return faces;
}

VertexSolver ceres_solver(const LfmOptions& model, const CeresOptions& options) {
    const Method& method = find(options.setting);
    if (model.mode == Mode::paper && model.mu > 0)
        throw UserError(
            "solver 'ceres' minimizes sums of squares, and the paper's bounds penalty is none; choose --mode modern, "
            "or --mu 0");
    FLAGS_minloglevel = google::GLOG_FATAL;  // a failed step is a status here, not a line on the terminal
    return [method, options](const LfmVertex& vertex, std::span<V> p, VertexRun& run) {
        // rule 1 of Section 5.3.2; a cost below 0 is never reached
        const double square = options.stop_residual * options.stop_residual;
        EnoughCallback enough(square > 0 ? 0.5 * double(vertex.surface_texels()) * square : -1.0);
        const auto solve = method.kind == Method::trust_region ? solve_trust_region : solve_line_search;
        solve(method, options.iterations, enough, vertex, p, run);
    };
}

}  // namespace radiafit
