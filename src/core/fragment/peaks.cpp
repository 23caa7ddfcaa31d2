#include "fragment/peaks.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

#include "base/error.h"
#include "fragment/pass_costs.h"
#include "gl/texture.h"
#include "gl/timer.h"

namespace radiafit {
namespace {

constexpr int repetitions = 5;
constexpr double long_enough_s = 0.02;

void draw_whole(const VertexArray& empty) {
    empty.bind();
    gl().DrawArrays(GL_TRIANGLES, 0, 3);
}

Texture ones(int side) {
    Texture texture(GL_RGBA32F, side, side);
    const std::vector<float> values(size_t(4) * side * side, 1.0f);
    texture.upload(GL_RGBA, GL_FLOAT, values.data());
    return texture;
}

void expect_values(const std::vector<float>& values, float expected, const std::string& what) {
    for (float value : {values.front(), values.back()})
        if (value != expected)
            throw SystemError(fmt::format("{} gives {} instead of {}: no peak can be told", what, value, expected));
}

void expect_result(const Texture& texture, float expected, const std::string& what) {
    std::vector<float> values(size_t(4) * texture.width() * texture.height());
    texture.download(GL_RGBA, GL_FLOAT, values.data(), values.size() * sizeof(float));
    expect_values(values, expected, what);
}

void expect_result(const Buffer& buffer, float expected, const std::string& what) {
    std::vector<float> values(buffer.bytes() / sizeof(float));
    buffer.read(0, buffer.bytes(), values.data());
    expect_values(values, expected, what);
}

/// Seconds of body(n), the least of some repetitions, with n doubled from 1 until that takes long enough; and n.
template <class Body>
std::pair<double, int> time_enough(const Body& body) {
    body(1);  // compiles
    for (int n = 1;; n *= 2) {
        double least = 1e9;
        for (int i = 0; i < repetitions; ++i) {
            GlStopwatch clock;
            clock.start();
            body(n);
            clock.stop();
            least = std::min(least, clock.seconds());
            if (least < long_enough_s) break;
        }
        if (least >= long_enough_s || n >= 1 << 18) return {least, n};
    }
}

/// Work per second of a program with a loop over `turns`, whose every turn adds `per_turn` to the result.
Work rate_of_loop(const std::string& shader, float per_turn) {
    const Texture source = ones(32), result(GL_RGBA32F, 512, 512);
    const Framebuffer target({{&result}});
    const Program program = Program::draw("common/whole.vert", shader);
    const VertexArray empty;
    program.set_if_used("factor", 1.0f);
    program.set_if_used("term", 1.0f);
    program.bind_if_used("source", source);
    const auto [seconds, turns] = time_enough([&](int n) {
        program.set("turns", n);
        target.bind();
        program.use();
        draw_whole(empty);
    });
    expect_result(result, per_turn * float(turns), shader);
    const uint64_t fragments = uint64_t(result.width()) * result.height();
    const PassCost& cost = *find_pass_cost(program);
    const Work work = Work(cost.fragment * fragments) += cost.entry * (fragments * uint64_t(turns));
    const auto rate = [&, s = seconds](uint64_t amount) { return uint64_t(double(amount) / s); };
    return {rate(work.operations), rate(work.reads), rate(work.read_bytes)};
}

// To and fro: into one target again and again, a tiling renderer would never leave its caches.
double bytes_per_second(bool blend) {
    const int side = 2048;
    const Texture textures[2] = {ones(side), ones(side)};
    const Framebuffer targets[2] = {Framebuffer({{&textures[0]}}), Framebuffer({{&textures[1]}})};
    const Program program = Program::draw("common/whole.vert", "peaks/copy.frag");
    const VertexArray empty;
    if (blend) {
        gl().Enable(GL_BLEND);
        gl().BlendEquation(GL_MAX);  // sums would grow beyond all floats
    }
    const auto [seconds, draws] = time_enough([&](int n) {
        for (int i = 0; i < n; ++i)
            for (int to = 0; to < 2; ++to) {
                program.bind("source", textures[1 - to]);
                program.use();
                targets[to].bind();
                draw_whole(empty);
            }
    });
    gl().Disable(GL_BLEND);
    for (const Texture& texture : textures) expect_result(texture, 1, "peaks/copy.frag");
    const double texels = 2.0 * draws * side * side;
    return texels * double(find_pass_cost(program)->fragment.read_bytes + (blend ? 2 : 1) * 16) / seconds;
}

// Constants of shaders/peaks/*.comp.
constexpr size_t lanes = 128;
constexpr double fused_operations = 2 * 4 * 3 * 16;  // of an invocation's turn

double compute_operations() {
    const size_t invocations = size_t(512) * 512;
    const Buffer results(std::vector<float>(4 * invocations), true);
    const Program program = Program::compute("peaks/fused.comp");
    program.bind("Results", results);
    program.set("factor", 1.0f);
    program.set("term", 1.0f);
    const auto [seconds, turns] = time_enough([&](int n) {
        program.set("turns", n);
        program.dispatch(invocations / lanes);
    });
    expect_result(results, 48 * float(turns), "peaks/fused.comp");
    return fused_operations * double(invocations) * turns / seconds;
}

double compute_bytes() {
    const size_t texels = size_t(4) << 20;
    const Buffer source(std::vector<float>(4 * texels, 1.0f)), results(std::vector<float>(4 * texels), true);
    const Texture fetched = Texture::of_buffer(GL_RGBA32F, source);
    const Program program = Program::compute("peaks/copy.comp");
    program.bind("source", fetched);
    program.bind("Results", results);
    const auto [seconds, times] = time_enough([&](int n) {
        for (int i = 0; i < n; ++i) program.dispatch(texels / lanes);
    });
    expect_result(results, 1, "peaks/copy.comp");
    return 32.0 * double(texels) * times / seconds;
}

}  // namespace

ComputePeaks measure_compute_peaks() { return {compute_operations(), compute_bytes()}; }

GlPeaks measure_gl_peaks() {
    return {double(rate_of_loop("peaks/fused.frag", 48).operations), double(rate_of_loop("peaks/fetch.frag", 16).reads),
            std::max(bytes_per_second(false), bytes_per_second(true))};
}

}  // namespace radiafit
