// NIST's nonlinear reference problems: digits of their certified values that our batched solver finds, and others do.
#include "rows/certified.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <sstream>

#include "base/choose.h"
#include "base/log.h"
#include "base/statistics.h"
#include "base/text_file.h"
#include "batch/problems.h"
#include "experiment.h"
#include "fitting/limits.h"
#include "reference/curve_rivals.h"
#include "reference/scipy_rival.h"
#include "report/csv_file.h"
#include "report/table.h"

namespace radiafit::harness {
namespace {

namespace rows = rows_of::certified;

/// A problem's formula, in the language of models' texts.
struct Formula {
    const char *name, *text;
};
constexpr const char* gauss =
    "b1 * exp(-b2 * x) + b3 * exp(-(x - b4) * (x - b4) / (b5 * b5)) + b6 * exp(-(x - b7) * (x - b7) / (b8 * b8))";
constexpr const char* lanczos = "b1 * exp(-b2 * x) + b3 * exp(-b4 * x) + b5 * exp(-b6 * x)";
constexpr const char* cubics = "(b1 + x * (b2 + x * (b3 + x * b4))) / (1.0 + x * (b5 + x * (b6 + x * b7)))";
constexpr const char* chwirut = "exp(-b1 * x) / (b2 + b3 * x)";
constexpr const char* saturation = "b1 * (1.0 - exp(-b2 * x))";
constexpr Formula formulas[] = {
    {"Bennett5", "b1 * pow(b2 + x, -1.0 / b3)"},
    {"BoxBOD", saturation},
    {"Chwirut1", chwirut},
    {"Chwirut2", chwirut},
    {"DanWood", "b1 * pow(x, b2)"},
    {"ENSO",
     "b1 + b2 * cos(year * x) + b3 * sin(year * x) + b5 * cos(turn * x / b4) + b6 * sin(turn * x / b4)"
     " + b8 * cos(turn * x / b7) + b9 * sin(turn * x / b7)"},
    {"Eckerle4", "b1 / b2 * exp(-0.5 * ((x - b3) / b2) * ((x - b3) / b2))"},
    {"Gauss1", gauss},
    {"Gauss2", gauss},
    {"Gauss3", gauss},
    {"Hahn1", cubics},
    {"Kirby2", "(b1 + x * (b2 + x * b3)) / (1.0 + x * (b4 + x * b5))"},
    {"Lanczos1", lanczos},
    {"Lanczos2", lanczos},
    {"Lanczos3", lanczos},
    {"MGH09", "b1 * (x * x + x * b2) / (x * x + x * b3 + b4)"},
    {"MGH10", "b1 * exp(b2 / (x + b3))"},
    {"MGH17", "b1 + b2 * exp(-x * b4) + b3 * exp(-x * b5)"},
    {"Misra1a", saturation},
    {"Misra1b", "b1 * (1.0 - 1.0 / ((1.0 + 0.5 * b2 * x) * (1.0 + 0.5 * b2 * x)))"},
    {"Misra1c", "b1 * (1.0 - 1.0 / sqrt(1.0 + 2.0 * b2 * x))"},
    {"Misra1d", "b1 * b2 * x / (1.0 + b2 * x)"},
    {"Nelson", "b1 - b2 * x1 * exp(-b3 * x2)"},  // of log y
    {"Rat42", "b1 / (1.0 + exp(b2 - b3 * x))"},
    {"Rat43", "b1 / pow(1.0 + exp(b2 - b3 * x), 1.0 / b4)"},
    {"Roszman1", "b1 - b2 * x - atan(b3 / (x - b4)) / (0.5 * turn)"},
    {"Thurber", cubics},
};

void check_problem(const std::string& name) {
    std::vector<std::string> names;
    for (const Formula& f : formulas) names.emplace_back(f.name);
    if (!std::ranges::count(names, name)) reject_name("problem", name, names);
}

struct Options {
    int iterations = 5000;
    std::vector<std::string> problems;

    explicit Options(Config& c) {
        c.read("iterations", iterations, limits::some_iterations);
        c.read("problems", problems, check_problem);
        c.finish();
    }
};

struct Certified {
    std::string name, difficulty;
    std::vector<double> starts[2], parameters, deviations;
    double error = 0;
    std::vector<double> terms, targets;  ///< [samples][terms], [samples]
    size_t term_count = 1;
};

/// A file of NIST's: lines of the starts and certified values, "  b1 = START1 START2 VALUE DEVIATION", then the data
/// behind the second line that begins with "Data:".
Certified read_certified(const std::filesystem::path& file) {
    Certified out{file.stem().string(), {}, {}, {}, {}, 0, {}, {}};
    TextFile text(file, "reference problem");
    std::string_view line;
    int heads = 0;
    while (text.next_line(line)) {
        const std::vector<std::string_view> tokens = split_tokens(line);
        if (tokens.empty()) continue;
        if (heads == 2) {
            const double y = text.to_double(tokens[0], "response");
            out.targets.push_back(out.name == "Nelson" ? std::log(y) : y);
            out.term_count = tokens.size() - 1;
            for (size_t i = 1; i < tokens.size(); ++i) out.terms.push_back(text.to_double(tokens[i], "predictor"));
        } else if (tokens[0] == "Data:") {
            ++heads;
        } else if (tokens.size() == 6 && tokens[0].starts_with('b') && tokens[1] == "=") {
            for (int k = 0; k < 2; ++k) out.starts[k].push_back(text.to_double(tokens[size_t(2 + k)], "start"));
            out.parameters.push_back(text.to_double(tokens[4], "certified value"));
            out.deviations.push_back(text.to_double(tokens[5], "certified deviation"));
        } else if (line.starts_with("Residual Sum of Squares:")) {
            out.error = text.to_double(tokens.back(), "certified sum");
        } else if (line.find("Level of Difficulty") != std::string_view::npos) {
            out.difficulty = std::string(tokens[0]);
            out.difficulty[0] = char(std::tolower(out.difficulty[0]));
        }
    }
    if (out.parameters.empty() || out.targets.empty() || !(out.error > 0)) text.fail("no certified values, or no data");
    return out;
}

batch::ModelText model_of(const Certified& problem) {
    const Formula& formula =
        *std::ranges::find(formulas, problem.name, [](const Formula& f) { return std::string(f.name); });
    std::vector<std::string> terms, names;
    if (problem.term_count == 1)
        terms = {"x"};
    else
        for (size_t i = 0; i < problem.term_count; ++i) terms.push_back(fmt::format("x{}", i + 1));
    for (size_t i = 0; i < problem.parameters.size(); ++i) names.push_back(fmt::format("b{}", i + 1));
    std::string text =
        fmt::format("struct Terms {{ real {}; }};\nstruct Parameters {{ real {}; }};\nstruct Values {{ real y; }};\n",
                    fmt::join(terms, ", "), fmt::join(names, ", "));
    text += "Values value(Parameters p, Terms t) {\n    real turn = 6.283185307179586, year = turn / 12.0;\n";
    for (const std::string& t : terms) text += fmt::format("    real {0} = t.{0};\n", t);
    for (const std::string& b : names) text += fmt::format("    real {0} = p.{0};\n", b);
    return batch::read_model(problem.name, text + fmt::format("    return Values({});\n}}\n", formula.text));
}

constexpr double all_digits = 11;

double digits_of(double value, double certified) {
    if (!std::isfinite(value)) return 0;
    const double off = std::abs(value - certified) / std::abs(certified);
    return off > 0 ? std::clamp(-std::log10(off), 0.0, all_digits) : all_digits;
}
double digits_of(const std::vector<double>& values, const std::vector<double>& certified) {
    double least = all_digits;
    for (size_t i = 0; i < certified.size(); ++i) least = std::min(least, digits_of(values[i], certified[i]));
    return least;
}

rows::Run run_ours(const Certified& problem, int start, const batch::CompiledModel& model, int iterations) {
    const auto found =
        batch::solve(model,
                     batch::Problems<double>{
                         1, {}, problem.targets.size(), problem.terms, problem.targets, {}, problem.starts[start]},
                     {.iterations = iterations});
    return {"radiafit solve",
            "",
            problem.name,
            problem.difficulty,
            start + 1,
            digits_of(found.parameters, problem.parameters),
            digits_of(found.error[0], problem.error),
            digits_of(found.deviations, problem.deviations),
            batch::name_of(batch::BatchStatus(found.status[0])),
            found.steps[0]};
}

/// Standard deviations at parameters, by the derivatives there and the sum of squared residuals.
std::vector<double> deviations_at(const Certified& problem, const batch::CompiledModel& model,
                                  const std::vector<double>& parameters, double error) {
    const auto n = Eigen::Index(problem.targets.size()), p = Eigen::Index(parameters.size());
    std::vector<double> values(size_t(n), 0), derivatives(size_t(n * p), 0);
    model.evaluate(parameters.data(), problem.terms.data(), n, values.data(), derivatives.data());
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const Eigen::MatrixXd jacobian = Eigen::Map<const Rows>(derivatives.data(), n, p);
    const Eigen::MatrixXd r = jacobian.householderQr().matrixQR().topRows(p).triangularView<Eigen::Upper>();
    const Eigen::MatrixXd inverse = r.triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(p, p));
    std::vector<double> out;
    for (Eigen::Index i = 0; i < p; ++i) out.push_back(inverse.row(i).norm() * std::sqrt(error / double(n - p)));
    return out;
}

rows::Run run_rival(const fits::CurveRival& rival, const Certified& problem, int start,
                    const batch::CompiledModel& model, int iterations) {
    const auto samples = problem.targets.size();
    const fits::CurveProblem curve{int(samples), int(problem.parameters.size()), problem.starts[start],
                                   [&](const double* p, double* r, double* derivatives) {
                                       std::vector<double> values(samples);
                                       model.evaluate(p, problem.terms.data(), (long long)samples, values.data(),
                                                      derivatives);
                                       for (size_t i = 0; r && i < samples; ++i) r[i] = values[i] - problem.targets[i];
                                   }};
    const fits::CurveEnd end = rival.solve(curve, iterations);
    std::vector<double> r(samples);
    curve.evaluate(end.parameters.data(), r.data(), nullptr);
    double error = 0;
    for (const double x : r) error += x * x;
    return {rival.name,
            rival.setting,
            problem.name,
            problem.difficulty,
            start + 1,
            digits_of(end.parameters, problem.parameters),
            digits_of(error, problem.error),
            digits_of(deviations_at(problem, model, end.parameters, error), problem.deviations),
            end.converged ? "converged" : "not converged",
            end.iterations};
}

void certified(Experiment& experiment) {
    const Options o(experiment.config());
    ResultFolder results = experiment.open_results(experiment.cpu_device());
    std::vector<rows::Run> runs;
    std::vector<fits::CurveRival> rivals = fits::curve_rivals(), of_scipy = fits::scipy_rivals();
    if (of_scipy.empty())
        log_info("without SciPy, which no python3 has: install Debian's python3-scipy to compare with it");
    std::ranges::move(of_scipy, std::back_inserter(rivals));
    Progress progress("problems", o.problems.size());
    for (const std::string& name : o.problems) {
        const Certified problem = read_certified(experiment.root() / "experiments/nist" / (name + ".dat"));
        const batch::CompiledModel model(model_of(problem), batch::Precision::double_precision);
        for (int start = 0; start < 2; ++start) {
            runs.push_back(run_ours(problem, start, model, o.iterations));
            for (const fits::CurveRival& rival : rivals)
                runs.push_back(run_rival(rival, problem, start, model, o.iterations));
        }
        progress.advance();
    }
    progress.finish();

    CsvFile run_file(results.path(), rows::runs);
    CsvFile solver_file(results.path(), rows::solvers);
    Table table({"solver", "setting", "8 digits", "sigma, 6 digits", "wrongly converged", "digits, median"});
    std::vector<std::pair<std::string, std::string>> solvers;
    for (const rows::Run& run : runs) {
        run_file.add(run);
        if (const std::pair solver(run.solver, run.setting); !std::ranges::count(solvers, solver))
            solvers.push_back(solver);
    }
    for (const auto& [solver, setting] : solvers) {
        rows::Solver sum{solver, setting, 0, 0, 0, 0, 0};
        std::vector<double> digits;
        for (const rows::Run& run : runs) {
            if (run.solver != solver || run.setting != setting) continue;
            const bool says = run.ended == "converged";
            ++sum.starts;
            sum.solved += run.digits >= 8;
            sum.sigma_right += run.sigma_digits >= 6;
            sum.wrongly_converged += says && run.digits < 4;
            digits.push_back(run.digits);
        }
        sum.digits_median = median(std::move(digits));
        solver_file.add(sum);
        table.add({solver, setting, fmt::format("{} of {}", sum.solved, sum.starts), std::to_string(sum.sigma_right),
                   std::to_string(sum.wrongly_converged), fmt::format("{:.1f}", sum.digits_median)});
    }
    run_file.commit();
    solver_file.commit();
    log_info("digits of NIST's certified values\n" + table.text());
    experiment.finish(results,
                      fmt::format("NIST's nonlinear reference problems, both starts; {}", experiment.cpu_device()));
}

}  // namespace
}  // namespace radiafit::harness

int main(int argc, char** argv) {
    return radiafit::harness::run_experiment("certified", argc, argv, radiafit::harness::certified);
}
