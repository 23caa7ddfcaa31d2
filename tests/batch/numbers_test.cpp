// Numbers that a batch's models are compiled with: values as the C library has them, derivatives as differences have
// them.
#include "batch/kernel/numbers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace radiafit::batch {
namespace {

using number = Wide<double>;
using J = Jet<number, 2>;

/// A number whose lanes differ.
number spread(double from, double to) {
    number x(0);
    for (int lane = 0; lane < number::size; ++lane) x.v[lane] = from + (to - from) * lane / number::size;
    return x;
}
J variable(const number& x, int index) {
    J j(x);
    j.d[index] = number(1);
    return j;
}

struct Function {
    const char* name;
    std::function<J(const J&, const J&)> jet;
    std::function<double(double, double)> plain;
};

const std::vector<Function>& functions() {
    static const std::vector<Function> all = {
        {"sum", [](J a, J b) { return a + 2.0 * b; }, [](double a, double b) { return a + 2 * b; }},
        {"difference", [](J a, J b) { return 3 - a - b; }, [](double a, double b) { return 3 - a - b; }},
        {"product", [](J a, J b) { return a * b * a; }, [](double a, double b) { return a * b * a; }},
        {"quotient", [](J a, J b) { return a / (b + 1.0); }, [](double a, double b) { return a / (b + 1); }},
        {"negative", [](J a, J b) { return -a * b; }, [](double a, double b) { return -a * b; }},
        {"exp", [](J a, J b) { return exp(-a * b); }, [](double a, double b) { return std::exp(-a * b); }},
        {"log", [](J a, J b) { return log(a + b * b); }, [](double a, double b) { return std::log(a + b * b); }},
        {"sqrt", [](J a, J b) { return sqrt(a + b); }, [](double a, double b) { return std::sqrt(a + b); }},
        {"pow", [](J a, J b) { return pow(a, b); }, [](double a, double b) { return std::pow(a, b); }},
        {"sin", [](J a, J b) { return sin(a * b); }, [](double a, double b) { return std::sin(a * b); }},
        {"cos", [](J a, J b) { return cos(a - b); }, [](double a, double b) { return std::cos(a - b); }},
        {"tan", [](J a, J b) { return tan(0.3 * a * b); }, [](double a, double b) { return std::tan(0.3 * a * b); }},
        {"atan", [](J a, J b) { return atan(a / b); }, [](double a, double b) { return std::atan(a / b); }},
        {"sinh", [](J a, J b) { return sinh(a - b); }, [](double a, double b) { return std::sinh(a - b); }},
        {"cosh", [](J a, J b) { return cosh(a - b); }, [](double a, double b) { return std::cosh(a - b); }},
        {"tanh", [](J a, J b) { return tanh(a - b); }, [](double a, double b) { return std::tanh(a - b); }},
        {"abs", [](J a, J b) { return abs(a - 5 * b); }, [](double a, double b) { return std::abs(a - 5 * b); }},
        {"max", [](J a, J b) { return max(a * a, b); }, [](double a, double b) { return std::max(a * a, b); }},
        {"min", [](J a, J b) { return min(a * a, b); }, [](double a, double b) { return std::min(a * a, b); }},
        {"select", [](J a, J b) { return J::select(a < b, a * b, a + b); },
         [](double a, double b) { return a < b ? a * b : a + b; }},
    };
    return all;
}

TEST(BatchNumbers, ValuesAreTheLibrarysAndDerivativesAreThoseOfDifferences) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(0.2, 1.9);
    constexpr double step = 1e-6;
    for (const Function& f : functions())
        for (int trial = 0; trial < 20; ++trial) {
            number a(0), b(0);
            for (int lane = 0; lane < number::size; ++lane) a.v[lane] = uniform(random), b.v[lane] = uniform(random);
            const J y = f.jet(variable(a, 0), variable(b, 1));
            for (int lane = 0; lane < number::size; ++lane) {
                const double x = a.v[lane], z = b.v[lane], value = f.plain(x, z);
                EXPECT_NEAR(y.v.v[lane], value, 1e-13 * (1 + std::abs(value))) << f.name;
                const double by_a = (f.plain(x + step, z) - f.plain(x - step, z)) / (2 * step);
                const double by_b = (f.plain(x, z + step) - f.plain(x, z - step)) / (2 * step);
                EXPECT_NEAR(y.d[0].v[lane], by_a, 2e-8 * (1 + std::abs(by_a))) << f.name;
                EXPECT_NEAR(y.d[1].v[lane], by_b, 2e-8 * (1 + std::abs(by_b))) << f.name;
            }
        }
}

TEST(BatchNumbers, PowersOfZeroHaveNoDerivativeByTheExponent) {
    const J y = pow(variable(number(0.0), 0), variable(number(2.0), 1));
    for (int lane = 0; lane < number::size; ++lane) {
        EXPECT_EQ(y.v.v[lane], 0);
        EXPECT_EQ(y.d[0].v[lane], 0);
        EXPECT_EQ(y.d[1].v[lane], 0);
    }
}

TEST(BatchNumbers, FloatsAreAsPreciseAsFloatsAre) {
    using F = Wide<float>;
    for (float x = -20; x < 20; x += 0.37f) {
        const F y = exp(F(x));
        for (int lane = 0; lane < F::size; ++lane) EXPECT_NEAR(y.v[lane], std::exp(x), 5e-7 * std::exp(x));
    }
    const number s = spread(0.5, 3), root = sqrt(s * s);
    for (int lane = 0; lane < number::size; ++lane) EXPECT_NEAR(root.v[lane], s.v[lane], 1e-15 * s.v[lane]);
}

}  // namespace
}  // namespace radiafit::batch
