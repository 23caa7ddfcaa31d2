// Derivatives that are made from a model's text: on a device by a made text, in C++ by numbers that carry them, against
// each other and against those that a text has by hand; and what is not in the dialect.
#include "gl/derivative_text.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "base/error.h"
#include "base/rng.h"
#include "gl/program.h"
#include "model/texel_local.h"
#include "model/texel_texts.h"
#include "several_shapes.h"
#include "shared_context.h"

// Lafortune's text, whose own derivatives go by other names: so its are made.
#define shape_slope slope_by_hand
#define shape_bend bend_by_hand
#define RADIAFIT_TEXEL_MODEL lafortune_made
#define RADIAFIT_TEXEL_FILE "model/lafortune.glsl"
#include "model/define_texel_text.h"
#undef shape_slope
#undef shape_bend

#define RADIAFIT_TEXEL_MODEL every_construct
#define RADIAFIT_TEXEL_FILE "every_construct.glsl"
#include "model/define_texel_text.h"

namespace radiafit {
using namespace testing;
namespace {

std::string with_other_names(std::string text) {
    for (const auto& [from, to] : {std::pair{"shape_slope", "slope_by_hand"}, {"shape_bend", "bend_by_hand"}})
        for (size_t at; (at = text.find(from)) != std::string::npos;) text.replace(at, std::string(from).size(), to);
    return text;
}

constexpr const char* evaluate = R"(#version 450 core
#include "model/prelude.glsl"
#include "model/MODEL.glsl"
#ifndef SHAPED_COUNT
#define SHAPED_COUNT 1
#endif
#define SLOPES (SHAPED_COUNT * SHAPE_COUNT)
layout(local_size_x = 64) in;
layout(std430) readonly buffer Points { float points[]; };     // [point] shape, change of it, terms
layout(std430) writeonly buffer Derivatives { float derivatives[]; };  // [point] slopes, bends
void main() {
    uint each = uint(2 * SHAPE_COUNT + TERM_COUNT), first = gl_GlobalInvocationID.x * each;
    Shape s, d;
    Terms t;
    for (int i = 0; i < SHAPE_COUNT; ++i) {
        s.x[i] = points[first + uint(i)];
        d.x[i] = points[first + uint(SHAPE_COUNT + i)];
    }
    for (int k = 0; k < TERM_COUNT; ++k) t.x[k] = points[first + uint(2 * SHAPE_COUNT + k)];
    Slope g = shape_slope(s, t);
    uint out_first = gl_GlobalInvocationID.x * uint(SLOPES + 2 * SHAPED_COUNT);
    for (int i = 0; i < SLOPES; ++i) derivatives[out_first + uint(i)] = g.x[i];
    for (int l = 0; l < SHAPED_COUNT; ++l) {
#if SHAPED_COUNT > 1
        vec2 along = shape_bends(s, d, t).x[l];
#else
        vec2 along = shape_bend(s, d, t);
#endif
        derivatives[out_first + uint(SLOPES + 2 * l)] = along.x;
        derivatives[out_first + uint(SLOPES + 2 * l + 1)] = along.y;
    }
}
)";

/// Shape, change of it, terms, of points within the bounds.
template <class Text>
std::vector<float> points_of(size_t count) {
    Rng rng(5);
    std::vector<float> out;
    const auto direction = [&] {
        const double z = 0.05 + 0.95 * rng.uniform(), around = 6.283185307 * rng.uniform(), r = std::sqrt(1 - z * z);
        return typename Text::real3{r * std::cos(around), r * std::sin(around), z};
    };
    for (size_t point = 0; point < count; ++point) {
        for (int i = 0; i < Text::shape_count; ++i) {
            const double low = Text::shape_bounds[i][0], high = Text::shape_bounds[i][1];
            out.push_back(float(low + (high - low) * rng.uniform()));
        }
        for (int i = 0; i < Text::shape_count; ++i) out.push_back(float(2 * rng.uniform() - 1));
        const auto terms = Text::sample_terms(direction(), direction());
        for (const double x : terms.x) out.push_back(float(x));
    }
    return out;
}

/// By numbers that carry derivatives, or by hand, in double: [point] slopes, bends.
template <class Text>
std::vector<double> in_double(const std::vector<float>& points) {
    using Model = TexelLocal<Text>;
    std::vector<double> out;
    for (const float* at = points.data(); at != points.data() + points.size();) {
        typename Text::Shape s, d;
        typename Text::Terms t;
        for (auto* numbers : {&s, &d})
            for (double& x : numbers->x) x = double(*at++);
        for (double& x : t.x) x = double(*at++);
        const auto slope = Model::shape_slope(s, t);
        out.insert(out.end(), std::begin(slope.x), std::end(slope.x));
        for (const auto& along : Model::shape_bends(s, d, t)) out.insert(out.end(), {along.x, along.y});
    }
    return out;
}

std::vector<float> on_device(const std::string& model, const std::vector<float>& points, size_t count, size_t each) {
    SharedContext::use();
    add_shader("test/derivatives.comp", [] { return std::string(evaluate); });
    const Program program = Program::compute("test/derivatives.comp", {{"MODEL", model}});
    const Buffer given(points), found(std::vector<float>(count * each));
    program.bind("Points", given);
    program.bind("Derivatives", found);
    program.use();
    program.dispatch(count / 64);
    std::vector<float> out(count * each);
    found.read(0, out.size() * sizeof(float), out.data());
    return out;
}

/// Of one kind of derivative, over the root of the mean of its squares.
struct Errors {
    double worst, mean;  ///< mean: the root of that of squares
};
template <class A, class B>
Errors errors_of(const std::vector<A>& found, const std::vector<B>& truth, size_t each, size_t kind) {
    double worst = 0, errors = 0, squares = 0;
    for (size_t i = kind; i < truth.size(); i += each) {
        const double error = std::abs(double(found[i]) - double(truth[i]));
        worst = std::max(worst, error);
        errors += error * error;
        squares += double(truth[i]) * double(truth[i]);
    }
    if (squares == 0) squares = 1;  // a function that knows nothing of this number
    return {worst / std::sqrt(squares * double(each) / double(truth.size())), std::sqrt(errors / squares)};
}

constexpr size_t point_count = 10'240;

/// reference: a model that has the same derivatives by hand.
template <class Text>
void expect_same_on_device(const std::string& model, const std::string& text, const char* reference = nullptr) {
    add_shader("model/" + model + ".glsl",
               [=] { return with_derivatives(model + ".glsl", text, TexelLocal<Text>::shaped, shader_file); });
    const auto points = points_of<Text>(point_count);
    const std::vector<double> truth = in_double<Text>(points);
    constexpr size_t each = size_t(TexelLocal<Text>::slopes + 2 * TexelLocal<Text>::shaped);
    const std::vector<float> found = on_device(model, points, point_count, each);
    const std::vector<float> by_hand =
        reference ? on_device(reference, points, point_count, each) : std::vector<float>();
    for (size_t kind = 0; kind < each; ++kind) {
        // in floats values themselves are off by some units in the last place; powers of them by more
        const Errors rounding = reference ? errors_of(by_hand, truth, each, kind) : Errors{1.5e-5, 5e-7};
        const Errors errors = errors_of(found, truth, each, kind);
        EXPECT_LT(errors.worst, 2 * rounding.worst) << model << " " << kind;
        EXPECT_LT(errors.mean, 2 * rounding.mean) << model << " " << kind;
        std::printf("  %s %zu: mean %.1e, worst %.1e\n", model.c_str(), kind, errors.mean, errors.worst);
    }
}

TEST(MadeDerivatives, OfLafortuneAreThoseByHand) {
    const auto points = points_of<texel_text::lafortune<double>>(point_count);
    const auto by_hand = in_double<texel_text::lafortune<double>>(points),
               made = in_double<texel_text::lafortune_made<double>>(points);
    for (size_t i = 0; i < made.size(); ++i) ASSERT_NEAR(made[i], by_hand[i], 1e-9 * (1 + std::abs(by_hand[i]))) << i;
    expect_same_on_device<texel_text::lafortune_made<double>>(
        "lafortune_made", with_other_names(shader_file("model/lafortune.glsl")), "lafortune");
}

TEST(MadeDerivatives, OfEveryConstructOfTheDialect) {
    std::ifstream file(std::string(RADIAFIT_TEST_TEXTS) + "/every_construct.glsl");
    std::ostringstream text;
    text << file.rdbuf();
    expect_same_on_device<texel_text::every_construct<double>>("every_construct", text.str());
}

TEST(MadeDerivatives, OfSeveralBasisFunctions) {
    expect_same_on_device<texel_text::several_shapes<double>>(several_shapes().name, several_shapes_text());
}

TEST(MadeDerivatives, ATextThatLacksNothingStaysAsItIs) {
    for (const char* model : {"lafortune", "ptm", "lambert", "hsh3"}) {
        const std::string text = shader_file(fmt::format("model/{}.glsl", model));
        EXPECT_EQ(with_derivatives("a.glsl", text, 1, shader_file), text) << model;
    }
}

TEST(MadeDerivatives, WhatIsNotInTheDialectIsNamed) {
    const std::string head =
        "#define SHAPE_COUNT 1\nstruct Terms { real x[1]; };\nstruct Shape { real x[1]; };\nstruct Basis { real x[1]; "
        "};\n";
    const auto complaint = [&](const std::string& body, int shaped = 1) -> std::string {
        try {
            with_derivatives("mine.glsl", head + body, shaped, shader_file);
        } catch (const UserError& error) {
            return error.what();
        }
        return "";
    };
    const auto of_basis = [](const std::string& statements) {
        return "SHARED_FN Basis basis(Shape s, Terms t) {\nBasis b;\n" + statements + "\nreturn b;\n}\n";
    };
    EXPECT_EQ(complaint(of_basis("b.x[0] = s.x[0];")), "");
    EXPECT_EQ(complaint("struct Slope { real x[1]; };\n" + of_basis("b.x[0] = s.x[0];"), 2),
              "mine.glsl:1: a struct Slope where SHAPED_COUNT is above 1: leave it out, since derivatives are made");
    EXPECT_EQ(complaint(""), "mine.glsl:1: no function basis");
    EXPECT_EQ(complaint(of_basis("b.x[0] = sin(s.x[0]);")), "mine.glsl:7: no function sin");
    EXPECT_EQ(complaint(of_basis("b.x[0] = s.x[0] ? s.x[0] : t.x[0];")),
              "mine.glsl:7: '?' is not in the dialect of models");
    EXPECT_EQ(complaint(of_basis("if (s.x[0] < t.x[0]) b.x[0] = t.x[0];")),
              "mine.glsl:7: 'if' is not in the dialect of models; take SELECT");
    EXPECT_EQ(complaint(of_basis("b.x[0] = s.x[0] +;")), "mine.glsl:7: ';' is not in the dialect of models here");
    EXPECT_EQ(complaint(of_basis("b.x[0] = (s.x[0];")), "mine.glsl:7: ';' where ')' should be");
    EXPECT_EQ(complaint(of_basis("real2 y = real2(s.x[0], t.x[0]);")),
              "mine.glsl:7: real2 where derivatives are made: take numbers one by one, or real3");
    EXPECT_EQ(complaint("#define F(x) x\n"), "mine.glsl:5: a macro with arguments is not in the dialect of models");
    EXPECT_EQ(complaint("#if 1\n"), "mine.glsl:5: #if is not in the dialect of models");
    EXPECT_EQ(complaint("#ifdef __cplusplus\n"), "mine.glsl:5: an #ifdef __cplusplus without its #endif");
    EXPECT_EQ(complaint("SHARED_FN Basis basis(Shape s, Terms t) { return basis(s, t); }\n"),
              "mine.glsl:5: basis calls itself");
    EXPECT_EQ(complaint("SHARED_FN Basis basis(Shape s, Terms t) { Basis b;"),
              "mine.glsl:5: the text ends within a statement");
}

}  // namespace
}  // namespace radiafit
