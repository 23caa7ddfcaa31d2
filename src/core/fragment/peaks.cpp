#include "fragment/peaks.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/clock.h"
#include "base/error.h"
#include "fragment/pass_costs.h"
#include "gl/context.h"
#include "gl/texture.h"

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

// The first component at both ends, within what many roundings may add up to.
void expect_values(const std::vector<float>& values, double expected, const std::string& what) {
    for (const float value : {values.front(), values[values.size() - 4]})
        if (!(std::abs(value - expected) <= 1e-3 * std::abs(expected)))
            throw SystemError(fmt::format("{} gives {} instead of {}: no peak can be told", what, value, expected));
}

void expect_result(const Texture& texture, double expected, const std::string& what) {
    std::vector<float> values(size_t(4) * texture.width() * texture.height());
    texture.download(GL_RGBA, GL_FLOAT, values.data(), values.size() * sizeof(float));
    expect_values(values, expected, what);
}

void expect_result(const Buffer& buffer, double expected, const std::string& what) {
    std::vector<float> values(buffer.bytes() / sizeof(float));
    buffer.read(0, buffer.bytes(), values.data());
    expect_values(values, expected, what);
}

/// Seconds of body(n), the least of some repetitions, with n doubled from 1 until that takes long enough; and n. By the
/// wall clock, between two glFinish: so long a time needs no timestamps of the device, which not every driver tells
/// right.
template <class Body>
std::pair<double, int> time_enough(const Body& body) {
    body(1);  // compiles
    for (int n = 1;; n *= 2) {
        double least = 1e9;
        for (int i = 0; i < repetitions; ++i) {
            gl().Finish();
            const double start = wall_time_s();
            body(n);
            gl().Finish();
            least = std::min(least, wall_time_s() - start);
            if (least < long_enough_s) break;
        }
        if (least >= long_enough_s || n >= 1 << 18) return {least, n};
    }
}

// Of shaders/peaks/fused.*: chains tend to 1.
constexpr float factor = 0.999f, term = 1 - factor;
constexpr float start_of(int chain, int component) { return 0.5f + 0.125f * float(4 * chain + component); }

void set_chains(const Program& program) {
    std::vector<float> starts;
    for (int chain = 0; chain < 3; ++chain)
        for (int component = 0; component < 4; ++component) starts.push_back(start_of(chain, component));
    program.set("factor", factor);
    program.set("term", term);
    program.set("starts", starts);
}

/// The first component of the three chains' sum after so many turns of 16 steps.
double sum_of_chains(int turns) {
    const double left = std::pow(double(factor), 16.0 * turns);
    double sum = 0;
    for (int chain = 0; chain < 3; ++chain) sum += 1 + left * (double(start_of(chain, 0)) - 1);
    return sum;
}

double sum_of_ones(int turns) { return 16.0 * turns; }

/// Work per second of a program with a loop over `turns`. prepare(program): sets what else it takes; expected(turns):
/// the first component of the result.
Work rate_of_loop(const std::string& shader, void (*prepare)(const Program&), double (*expected)(int)) {
    const Texture source = ones(32), result(GL_RGBA32F, 512, 512);
    const Framebuffer target({{&result}});
    const Program program = Program::draw("common/whole.vert", shader);
    const VertexArray empty;
    if (prepare) prepare(program);
    program.bind_if_used("source", source);
    const auto [seconds, turns] = time_enough([&](int n) {
        program.set("turns", n);
        target.bind();
        program.use();
        draw_whole(empty);
    });
    expect_result(result, expected(turns), shader);
    const uint64_t fragments = uint64_t(result.width()) * result.height();
    const PassCost& cost = *find_pass_cost(program);
    const Work work = Work(cost.fragment * fragments) += cost.entry * (fragments * uint64_t(turns));
    const auto rate = [&, s = seconds](uint64_t amount) { return uint64_t(double(amount) / s); };
    return {rate(work.operations), rate(work.reads), rate(work.read_bytes)};
}

// Texels on a side of what is copied: 64 MB, and on a chip with 2 GB to spare 256 MB, of which its caches hold little.
int side_beyond_caches() {
    const Context& context = Context::current();
    const int64_t spare = int64_t(2) << 30;
    return context.software() || context.free_device_bytes().value_or(spare) < spare ? 2048 : 4096;
}

// To and fro: into one target again and again, a tiling renderer would never leave its caches.
double bytes_per_second(bool blend) {
    const int side = side_beyond_caches();
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
    set_chains(program);
    const auto [seconds, turns] = time_enough([&](int n) {
        program.set("turns", n);
        program.dispatch(invocations / lanes);
    });
    expect_result(results, sum_of_chains(turns), "peaks/fused.comp");
    return fused_operations * double(invocations) * turns / seconds;
}

double compute_bytes() {
    const int64_t most =
        std::min(Context::current().limits().texture_buffer_texels, Context::current().limits().ssbo_bytes / 16);
    size_t texels = size_t(side_beyond_caches());
    texels = std::min(texels * texels, size_t(most));
    texels -= texels % lanes;
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
    return {double(rate_of_loop("peaks/fused.frag", set_chains, sum_of_chains).operations),
            double(rate_of_loop("peaks/fetch.frag", nullptr, sum_of_ones).reads),
            std::max(bytes_per_second(false), bytes_per_second(true))};
}

}  // namespace radiafit
