#include "reference/curve_rivals.h"

#include <ceres/ceres.h>
#include <ceres/tiny_solver.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_multifit_nlinear.h>
#include <nlopt.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <unsupported/Eigen/NonLinearOptimization>

namespace radiafit::fits {
namespace {

class CeresCost final : public ceres::CostFunction {
public:
    explicit CeresCost(const CurveProblem& problem) : problem_(problem) {
        set_num_residuals(problem.residuals);
        mutable_parameter_block_sizes()->push_back(problem.parameters);
    }
    bool Evaluate(double const* const* p, double* r, double** derivatives) const override {
        problem_.evaluate(p[0], r, derivatives ? derivatives[0] : nullptr);
        return std::all_of(r, r + problem_.residuals, [](double x) { return std::isfinite(x); });
    }

private:
    const CurveProblem& problem_;
};

CurveEnd by_ceres(const CurveProblem& problem, int iterations,
                  const std::function<void(ceres::Solver::Options&)>& set) {
    CurveEnd out{problem.start};
    ceres::Problem ceres_problem;
    ceres_problem.AddResidualBlock(new CeresCost(problem), nullptr, out.parameters.data());
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.max_num_iterations = iterations;
    options.function_tolerance = options.gradient_tolerance = options.parameter_tolerance = 1e-16;
    options.max_num_consecutive_invalid_steps = 50;
    options.logging_type = ceres::SILENT;
    options.num_threads = 1;
    set(options);
    ceres::Solver::Summary summary;
    ceres::Solve(options, &ceres_problem, &summary);
    out.converged = summary.termination_type == ceres::CONVERGENCE;
    out.iterations = int(summary.iterations.size()) - 1;
    return out;
}

struct TinyCurve {
    using Scalar = double;
    enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = Eigen::Dynamic };
    const CurveProblem* problem;

    int NumResiduals() const { return problem->residuals; }
    int NumParameters() const { return problem->parameters; }
    bool operator()(const double* p, double* r, double* jacobian) const {  // column by column
        if (!jacobian) return problem->evaluate(p, r, nullptr), true;
        Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows(problem->residuals,
                                                                                    problem->parameters);
        problem->evaluate(p, r, rows.data());
        Eigen::Map<Eigen::MatrixXd>(jacobian, rows.rows(), rows.cols()) = rows;
        return true;
    }
};

CurveEnd by_tiny_solver(const CurveProblem& problem, int iterations) {
    ceres::TinySolver<TinyCurve> solver;
    solver.options.max_num_iterations = iterations;
    solver.options.gradient_tolerance = solver.options.parameter_tolerance = solver.options.function_tolerance = 1e-16;
    solver.options.cost_threshold = 0;
    Eigen::VectorXd x = Eigen::Map<const Eigen::VectorXd>(problem.start.data(), problem.parameters);
    const auto& summary = solver.Solve(TinyCurve{&problem}, &x);
    return {{x.data(), x.data() + x.size()},
            summary.status != ceres::TinySolver<TinyCurve>::HIT_MAX_ITERATIONS,
            summary.iterations};
}

struct EigenCurve {
    using Scalar = double;
    const CurveProblem* problem;

    int inputs() const { return problem->parameters; }
    int values() const { return problem->residuals; }
    int operator()(const Eigen::VectorXd& p, Eigen::VectorXd& r) const {
        problem->evaluate(p.data(), r.data(), nullptr);
        return 0;
    }
    int df(const Eigen::VectorXd& p, Eigen::MatrixXd& jacobian) const {
        Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows(problem->residuals,
                                                                                    problem->parameters);
        Eigen::VectorXd r(problem->residuals);
        problem->evaluate(p.data(), r.data(), rows.data());
        jacobian = rows;
        return 0;
    }
};

CurveEnd by_eigen(const CurveProblem& problem, int iterations) {
    EigenCurve curve{&problem};
    Eigen::LevenbergMarquardt<EigenCurve> solver(curve);
    solver.parameters.ftol = solver.parameters.xtol = 1e-15;
    solver.parameters.gtol = 0;
    solver.parameters.maxfev = iterations;
    Eigen::VectorXd x = Eigen::Map<const Eigen::VectorXd>(problem.start.data(), problem.parameters);
    const auto status = solver.minimize(x);
    return {{x.data(), x.data() + x.size()},
            status >= 1 && status <= 8 && status != Eigen::LevenbergMarquardtSpace::TooManyFunctionEvaluation,
            int(solver.nfev)};
}

CurveEnd by_gsl(const CurveProblem& problem, int iterations, const gsl_multifit_nlinear_trs* method) {
    gsl_set_error_handler_off();
    const auto n = size_t(problem.residuals), p = size_t(problem.parameters);
    gsl_multifit_nlinear_parameters parameters = gsl_multifit_nlinear_default_parameters();
    parameters.trs = method;
    const std::unique_ptr<gsl_multifit_nlinear_workspace, void (*)(gsl_multifit_nlinear_workspace*)> work(
        gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &parameters, n, p), gsl_multifit_nlinear_free);
    gsl_multifit_nlinear_fdf functions{};
    functions.n = n;
    functions.p = p;
    functions.params = const_cast<CurveProblem*>(&problem);
    functions.f = [](const gsl_vector* x, void* of, gsl_vector* f) {
        static_cast<const CurveProblem*>(of)->evaluate(x->data, f->data, nullptr);
        // GSL gives up where a function fails, but rejects a step to far worse
        std::replace_if(
            f->data, f->data + f->size, [](double r) { return !std::isfinite(r); }, 1e150);
        return int(GSL_SUCCESS);
    };
    functions.df = [](const gsl_vector* x, void* of, gsl_matrix* jacobian) {
        std::vector<double> r(jacobian->size1);
        static_cast<const CurveProblem*>(of)->evaluate(x->data, r.data(), jacobian->data);
        return int(GSL_SUCCESS);
    };
    const gsl_vector_const_view start = gsl_vector_const_view_array(problem.start.data(), p);
    CurveEnd out{problem.start};
    if (gsl_multifit_nlinear_init(&start.vector, &functions, work.get()) != GSL_SUCCESS) return out;
    int info = 0;
    const int status =
        gsl_multifit_nlinear_driver(size_t(iterations), 1e-15, 1e-15, 0, nullptr, nullptr, &info, work.get());
    const gsl_vector* x = gsl_multifit_nlinear_position(work.get());
    out.parameters.assign(x->data, x->data + p);
    out.converged = status == GSL_SUCCESS;
    out.iterations = int(gsl_multifit_nlinear_niter(work.get()));
    return out;
}

CurveEnd by_nlopt(const CurveProblem& problem, int iterations, nlopt_algorithm algorithm) {
    struct Call {
        const CurveProblem* problem;
        std::vector<double> r, derivatives;
        int evaluations = 0;
    } call{&problem, std::vector<double>(size_t(problem.residuals)),
           std::vector<double>(size_t(problem.residuals * problem.parameters))};
    const auto objective = [](unsigned count, const double* p, double* gradient, void* of) {
        Call& c = *static_cast<Call*>(of);
        ++c.evaluations;
        c.problem->evaluate(p, c.r.data(), gradient ? c.derivatives.data() : nullptr);
        double sum = 0;
        for (const double r : c.r) sum += 0.5 * r * r;
        for (unsigned i = 0; gradient && i < count; ++i) {
            gradient[i] = 0;
            for (size_t k = 0; k < c.r.size(); ++k) gradient[i] += c.r[k] * c.derivatives[k * count + i];
        }
        return sum;
    };
    const std::unique_ptr<nlopt_opt_s, void (*)(nlopt_opt)> solver(
        nlopt_create(algorithm, unsigned(problem.parameters)), nlopt_destroy);
    nlopt_set_min_objective(solver.get(), objective, &call);
    nlopt_set_ftol_rel(solver.get(), 1e-16);
    nlopt_set_xtol_rel(solver.get(), 1e-16);
    nlopt_set_maxeval(solver.get(), iterations);
    CurveEnd out{problem.start};
    double least = 0;
    const nlopt_result result = nlopt_optimize(solver.get(), out.parameters.data(), &least);
    out.converged = result > 0 && result != NLOPT_MAXEVAL_REACHED;
    out.iterations = call.evaluations;
    return out;
}

}  // namespace

const std::vector<CurveRival>& curve_rivals() {
    static const std::vector<CurveRival> all = {
        {"Ceres", "Levenberg-Marquardt by QR", [](const auto& p, int n) { return by_ceres(p, n, [](auto&) {}); }},
        {"Ceres", "dogleg",
         [](const auto& p, int n) {
             return by_ceres(p, n, [](auto& o) { o.trust_region_strategy_type = ceres::DOGLEG; });
         }},
        {"Ceres", "nonmonotonic steps",
         [](const auto& p, int n) { return by_ceres(p, n, [](auto& o) { o.use_nonmonotonic_steps = true; }); }},
        {"Ceres TinySolver", "", by_tiny_solver},
        {"GSL", "Levenberg-Marquardt", [](const auto& p, int n) { return by_gsl(p, n, gsl_multifit_nlinear_trs_lm); }},
        {"GSL", "geodesic acceleration",
         [](const auto& p, int n) { return by_gsl(p, n, gsl_multifit_nlinear_trs_lmaccel); }},
        {"Eigen", "Levenberg-Marquardt of MINPACK", by_eigen},
        {"NLopt", "L-BFGS", [](const auto& p, int n) { return by_nlopt(p, n, NLOPT_LD_LBFGS); }},
        {"NLopt", "SLSQP", [](const auto& p, int n) { return by_nlopt(p, n, NLOPT_LD_SLSQP); }},
    };
    return all;
}

}  // namespace radiafit::fits
