#include "reference/scipy_rival.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "base/program.h"

namespace radiafit::fits {
namespace {

/// Reads a problem after another: its method, numbers of residuals, parameters and evaluations at most, and the start.
/// Asks for residuals and derivatives by 1 and a place; says by 0 where it ended, whether it converged, and after how
/// many.
constexpr const char* script = R"(
import struct, sys
import numpy
from scipy.optimize import least_squares

def take(count):
    return numpy.frombuffer(sys.stdin.buffer.read(8 * count), dtype="<f8").copy()

def give(kind, numbers):
    sys.stdout.buffer.write(struct.pack("<q", kind) + numpy.asarray(numbers, dtype="<f8").tobytes())
    sys.stdout.buffer.flush()

while header := sys.stdin.buffer.read(32):
    method, residuals, parameters, evaluations = struct.unpack("<qqqq", header)
    known = {}

    def look(x):
        if known.get("x") != x.tobytes():
            give(1, x)
            known.update(x=x.tobytes(), r=take(residuals), j=take(residuals * parameters).reshape(residuals, parameters))
        return known

    start = take(parameters)
    try:
        end = least_squares(lambda x: look(x)["r"], start, jac=lambda x: look(x)["j"], method=("lm", "trf", "dogbox")[method],
                            x_scale="jac", ftol=1e-15, xtol=1e-15, gtol=1e-15, max_nfev=evaluations)
        give(0, [end.status > 0, end.nfev, *end.x])
    except Exception:  # its own, of residuals or derivatives that are not finite
        give(0, [0, 0, *start])
)";

CurveEnd by_scipy(RunningProgram& python, const CurveProblem& problem, int evaluations, int method) {
    const int64_t header[] = {method, problem.residuals, problem.parameters, evaluations};
    python.write(header, sizeof header);
    python.write(problem.start.data(), problem.start.size() * sizeof(double));
    const auto n = size_t(problem.residuals), p = size_t(problem.parameters);
    std::vector<double> x(p), r(n), derivatives(n * p);
    const auto read = [&](std::vector<double>& numbers) {
        python.read(numbers.data(), numbers.size() * sizeof(double));
    };
    const auto write = [&](const std::vector<double>& numbers) {
        python.write(numbers.data(), numbers.size() * sizeof(double));
    };
    for (int64_t asked = 0; python.read(&asked, sizeof asked), asked == 1;) {
        read(x);
        problem.evaluate(x.data(), r.data(), derivatives.data());
        write(r);
        write(derivatives);
    }
    std::vector<double> says(2);
    CurveEnd out{.parameters = std::vector<double>(p)};
    read(says);
    read(out.parameters);
    out.converged = says[0] > 0;
    out.iterations = int(says[1]);
    return out;
}

std::optional<std::string> python_with_scipy() {
    for (const char* python : {"python3", "/usr/bin/python3"})
        if (run_program({python, "-c", "import numpy, scipy.optimize"}).status == 0) return python;
    return std::nullopt;
}

}  // namespace

std::vector<CurveRival> scipy_rivals() {
    const std::optional<std::string> found = python_with_scipy();
    if (!found) return {};
    const auto python = std::make_shared<RunningProgram>(std::vector<std::string>{*found, "-c", script});
    std::vector<CurveRival> out;
    for (const auto& [setting, method] : {std::pair("MINPACK", 0), {"trust region", 1}, {"dogbox", 2}})
        out.push_back({"SciPy", setting, [python, m = method](const CurveProblem& problem, int evaluations) {
                           return by_scipy(*python, problem, evaluations, m);
                       }});
    return out;
}

}  // namespace radiafit::fits
