#include "reference/ceres_solver.h"

#include <ceres/gradient_problem.h>
#include <ceres/gradient_problem_solver.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/config.h"
#include "base/error.h"
#include "reference/ceres_blocks.h"
#include "reference/ceres_status.h"
#include "reference/channel_energy.h"

namespace radiafit::fits {
namespace {

using V = Lanes<double>;

/// How one setting configures Ceres.
struct CeresMethod {
    CeresSetting face;
    enum Kind { trust_region, line_search } kind;
    CeresBlocks blocks = CeresBlocks::texels;
    ceres::LinearSolverType linear = ceres::SPARSE_NORMAL_CHOLESKY;
    ceres::PreconditionerType preconditioner = ceres::JACOBI;
    ceres::LineSearchDirectionType direction = ceres::LBFGS;
};

constexpr CeresMethod ceres_methods[] = {
    {{"sparse-normal-cholesky", "trust region, sparse Cholesky of J'J", CeresMemory::sparse_factor},
     CeresMethod::trust_region},
    {{"dense-normal-cholesky", "trust region, dense Cholesky of J'J", CeresMemory::dense_normal},
     CeresMethod::trust_region,
     CeresBlocks::texels,
     ceres::DENSE_NORMAL_CHOLESKY},
    {{"dense-qr", "trust region, dense QR of J", CeresMemory::dense_qr},
     CeresMethod::trust_region,
     CeresBlocks::texels,
     ceres::DENSE_QR},
    {{"dense-schur", "trust region, an independent set of texels eliminated, dense Cholesky of the rest",
      CeresMemory::dense_schur},
     CeresMethod::trust_region,
     CeresBlocks::texels,
     ceres::DENSE_SCHUR},
    {{"dense-schur-maps", "trust region, whole surface maps eliminated, dense Cholesky of the view map",
      CeresMemory::dense_maps},
     CeresMethod::trust_region,
     CeresBlocks::maps,
     ceres::DENSE_SCHUR},
    {{"sparse-schur", "trust region, an independent set of texels eliminated, sparse Cholesky of the rest",
      CeresMemory::sparse_factor},
     CeresMethod::trust_region,
     CeresBlocks::texels,
     ceres::SPARSE_SCHUR},
    {{"iterative-schur", "trust region, an independent set of texels eliminated, conjugate gradients on the rest",
      CeresMemory::jacobian},
     CeresMethod::trust_region,
     CeresBlocks::texels,
     ceres::ITERATIVE_SCHUR,
     ceres::SCHUR_JACOBI},
    {{"cgnr", "trust region, conjugate gradients on J'J", CeresMemory::jacobian},
     CeresMethod::trust_region,
     CeresBlocks::texels,
     ceres::CGNR},
    {{"lbfgs", "line search, limited-memory BFGS", CeresMemory::vectors}, CeresMethod::line_search},
    {{"nonlinear-cg", "line search, nonlinear conjugate gradients", CeresMemory::vectors},
     CeresMethod::line_search,
     CeresBlocks::texels,
     ceres::CGNR,
     ceres::JACOBI,
     ceres::NONLINEAR_CONJUGATE_GRADIENT},
};

const CeresMethod& find(const std::string& name) {
    std::vector<std::string> names;
    for (const CeresMethod& m : ceres_methods) {
        if (name == m.face.name) return m;
        names.push_back(m.face.name);
    }
    throw UserError(fmt::format("ceres setting '{}' does not exist; choose one of {} (nearest: {})", name,
                                fmt::join(names, ", "), nearest(name, names)));
}

/// Writes one channel's rows as Ceres reports them, and stops it where the cost is small enough.
class Rows final : public ceres::IterationCallback {
public:
    Rows(const LfmVertex& vertex, double stop_residual, VertexRun& run)
        : run_(&run), enough_(enough_error(vertex, stop_residual)) {}

    void begin(int channel) {
        now_ = &run_->channel[channel];
        start_ = run_->clock();
    }
    ceres::CallbackReturnType operator()(const ceres::IterationSummary& row) override {
        add(row);
        return row.cost <= enough_ ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
    }
    /// Takes what both kinds of Ceres' summaries have.
    void end(const std::vector<ceres::IterationSummary>& all, ceres::TerminationType termination, double initial_cost) {
        // line searches report no row that ends them
        for (size_t i = now_->error.size(); i < all.size(); ++i) add(all[i]);
        if (now_->error.empty()) {  // no step was tried
            now_->error = {initial_cost};
            now_->time_s = {run_->clock() - start_};
        }
        now_->status =
            ceres_status(termination, std::isfinite(now_->error.back()) ? Status::stationary : Status::not_finite);
    }

private:
    /// A step that is rejected has the cost of its trial.
    void add(const ceres::IterationSummary& row) {
        now_->error.push_back(now_->error.empty() ? row.cost : std::min(now_->error.back(), row.cost));
        now_->time_s.push_back(run_->clock() - start_);
    }

    VertexRun* run_;
    double enough_;
    VertexRun::Channel* now_ = nullptr;
    double start_ = 0;
};

void take_channel(std::span<const V> p, int c, std::span<double> x) {
    for (size_t i = 0; i < p.size(); ++i) x[i] = p[i][c];
}
void give_channel(std::span<const double> x, int c, std::span<V> p) {
    for (size_t i = 0; i < p.size(); ++i) p[i][c] = x[i];
}

ceres::Solver::Options trust_region_options(const CeresMethod& method, CeresVertex& blocks) {
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

void solve_trust_region(const CeresMethod& method, const CeresOptions& options, const LfmVertex& vertex, std::span<V> p,
                        VertexRun& run) {
    const double start = run.clock();
    Rows rows(vertex, options.stop_residual, run);
    CeresVertex blocks(vertex, method.blocks);
    ceres::Solver::Options o = trust_region_options(method, blocks);
    o.max_num_iterations = options.iterations;
    o.callbacks.push_back(&rows);
    run.setup_s = run.clock() - start;
    for (int c = 0; c < 3; ++c) {
        const double own = run.clock();
        blocks.set_channel(c);
        take_channel(p, c, blocks.x());
        run.setup_s += run.clock() - own;
        ceres::Solver::Summary summary;
        rows.begin(c);
        ceres::Solve(o, &blocks.problem(), &summary);
        rows.end(summary.iterations, summary.termination_type, summary.initial_cost);
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

void solve_line_search(const CeresMethod& method, const CeresOptions& options, const LfmVertex& vertex, std::span<V> p,
                       VertexRun& run) {
    Rows rows(vertex, options.stop_residual, run);
    ceres::GradientProblemSolver::Options o;
    o.line_search_direction_type = method.direction;
    o.nonlinear_conjugate_gradient_type = ceres::FLETCHER_REEVES;  // the other two end early on many problems
    // L-BFGS keeps Ceres' rank of 20: 5, 8 and 12 take the same time within 7 %, by more iterations.
    o.max_num_iterations = options.iterations;
    o.function_tolerance = 1e-12;  // line searches fall slowly long before they are done
    o.gradient_tolerance = 1e-14;
    o.parameter_tolerance = 1e-12;
    o.logging_type = ceres::SILENT;
    o.callbacks.push_back(&rows);
    std::vector<double> x(vertex.size()), scale(vertex.size());
    for (int c = 0; c < 3; ++c) {
        const double setup = run.clock();
        const ChannelEnergy energy(vertex, c);
        take_channel(p, c, x);
        run.setup_s += run.clock() - setup;
        rows.begin(c);
        scale = energy.diagonal(x.data());
        for (size_t i = 0; i < x.size(); ++i) {
            scale[i] = 1 / std::sqrt(scale[i]);
            x[i] /= scale[i];
        }
        ceres::GradientProblem problem(new ScaledEnergy(energy, scale));  // which owns it
        ceres::GradientProblemSolver::Summary summary;
        ceres::Solve(o, problem, x.data(), &summary);
        rows.end(summary.iterations, summary.termination_type, summary.initial_cost);
        for (size_t i = 0; i < x.size(); ++i) x[i] *= scale[i];
        give_channel(x, c, p);
    }
}

}  // namespace

std::span<const CeresSetting> ceres_settings() {
    static const std::vector<CeresSetting> faces = [] {
        std::vector<CeresSetting> out;
        for (const CeresMethod& m : ceres_methods) out.push_back(m.face);
        return out;
    }();
    return faces;
}

const CeresSetting& find_ceres_setting(const std::string& name) { return find(name).face; }

VertexSolver ceres_solver(const LfmOptions& model, const CeresOptions& options) {
    const CeresMethod& method = find(options.setting);
    require_modern_penalty(model, "ceres");
    silence_ceres();
    return [method, options](const LfmVertex& vertex, std::span<V> p, VertexRun& run) {
        const auto solve = method.kind == CeresMethod::trust_region ? solve_trust_region : solve_line_search;
        solve(method, options, vertex, p, run);
    };
}

}  // namespace radiafit::fits
