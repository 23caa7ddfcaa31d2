// The fp16 storage of N-texel arrays rounds as F16C does: every half value, the midpoints between neighbours and one
// unit in the last place to either side, not-a-numbers and infinities; but subnormals as the driver is measured to
// round them. The truncating storage rounds towards zero where render targets do.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "base/half.h"
#include "context_kinds.h"
#include "fragment/half_rounding.h"
#include "gl/program.h"
#include "gl/texture.h"
#include "gl_scene.h"

namespace radiafit {
namespace {

constexpr int side = 1024;

std::vector<float> interesting_values() {
    std::vector<float> values;
    for (uint32_t bits = 0; bits < 0x10000; ++bits) {
        const float x = float_from_half(uint16_t(bits));
        values.push_back(x);
        if (!std::isfinite(x)) continue;
        const float next = (bits & 0x7fff) == 0x7bff ? std::copysign(65536.0f, x) : float_from_half(uint16_t(bits + 1));
        const float middle = 0.5f * (x + next);
        for (float m : {std::nextafterf(middle, 0.0f), middle, std::nextafterf(middle, 2 * next)}) values.push_back(m);
    }
    const float infinity = std::numeric_limits<float>::infinity();
    for (float x : {infinity, -infinity, std::nanf(""), -std::nanf("1"), 1e38f, -1e38f, 3e-8f, -3e-8f, 1e-38f})
        values.push_back(x);
    return values;
}

void draw(const Program& program, const char* sampler, const Texture& from, const Framebuffer& target) {
    program.bind(sampler, from);
    VertexArray empty;
    empty.bind();
    target.bind();
    program.use();
    gl().DrawArrays(GL_TRIANGLES, 0, 3);
}

class HalfStore : public ::testing::TestWithParam<ContextKind> {
protected:
    void check(const Defines& storage);
};

TEST_P(HalfStore, RoundsAsF16c) {
    const auto context = make_context(GetParam());
    const std::vector<HalfRounding> told = measure_half_rounding();
    ASSERT_EQ(told.size(), 4u);
    const HalfRounding &packing = told[0], &stored = told[1];
    constexpr const char* nearest = "to nearest, ties to even";
    EXPECT_TRUE(stored.values == nearest && stored.subnormals == nearest) << stored.values << "; " << stored.subnormals;
    if (context->renderer().starts_with("llvmpipe")) {
        EXPECT_TRUE(packing.values == nearest && packing.subnormals == nearest) << packing.values;
        for (const HalfRounding& h : {told[2], told[3]})
            EXPECT_TRUE(h.values == "towards zero" && h.subnormals == h.values) << h.of << ": " << h.values;
    }
    check(storage_defines(Storage::fp16));
    check({{"STORAGE", "1"}, {"OWN_HALVES", ""}});
}

void HalfStore::check(const Defines& storage) {
    const HalfRounding target = measure_half_rounding()[2];
    const std::vector<float> values = interesting_values();
    ASSERT_LE(values.size(), size_t(side) * side / 2);
    // Red and blue hold the value, green its neighbour's: the packed pairs must not touch each other.
    std::vector<float> data(size_t(side) * side * 4);
    for (size_t i = 0; i < values.size(); ++i) {
        data[4 * i] = data[4 * i + 2] = values[i];
        data[4 * i + 1] = values[(i + 7) % values.size()];
    }
    Texture floats(GL_RGBA32F, side, side, 1), halves(GL_RG32UI, side, side, 1), truncated(GL_RGBA16F, side, side, 1);
    floats.upload(GL_RGBA, GL_FLOAT, data.data());
    draw(Program::draw("common/whole.vert", "gather/store.frag", storage), "values", floats,
         Framebuffer({{&halves, 0}}));
    draw(Program::draw("common/whole.vert", "gather/store.frag", {{"STORAGE", "2"}}), "values", floats,
         Framebuffer({{&truncated, 0}}));
    std::vector<uint16_t> rounded(data.size()), cut(data.size());
    halves.download(GL_RG_INTEGER, GL_UNSIGNED_INT, rounded.data(), rounded.size() * 2);
    truncated.download(GL_RGBA, GL_HALF_FLOAT, cut.data(), cut.size() * 2);
    Texture back(GL_RGBA32F, side, side, 1);
    draw(Program::draw("common/whole.vert", "gather/store.frag", {{"STORAGE", "1"}, {"FROM_STORAGE", ""}}), "maps",
         halves, Framebuffer({{&back, 0}}));
    std::vector<float> read(data.size());
    back.download(GL_RGBA, GL_FLOAT, read.data(), read.size() * sizeof(float));

    for (size_t i = 0; i < values.size(); ++i)
        for (size_t c = 0; c < 3; ++c) {
            const float x = data[4 * i + c];
            const uint16_t expected = half_from_float(x), got = rounded[4 * i + c];
            const bool subnormal = std::abs(x) < 0x1p-14f;
            const float again = read[4 * i + c];
            if (std::isnan(x)) {  // which of the not-a-numbers is nobody's concern
                ASSERT_TRUE(std::isnan(float_from_half(got)) && std::isnan(again));
                ASSERT_TRUE(std::isnan(float_from_half(cut[4 * i + c])));
                continue;
            }
            ASSERT_EQ(got, expected) << x << ", channel " << c;
            ASSERT_EQ(std::bit_cast<uint32_t>(again), std::bit_cast<uint32_t>(float_from_half(expected))) << x;
            // How a render target rounds is the driver's: Mesa's software truncates, and this storage stands for that.
            if ((subnormal ? target.subnormals : target.values) == "towards zero") {
                ASSERT_EQ(cut[4 * i + c], half_from_float_truncated(x)) << x << ", truncated";
            }
        }
}

INSTANTIATE_TEST_SUITE_P(Kinds, HalfStore, ::testing::ValuesIn(context_kinds()),
                         [](const auto& info) { return to_string(info.param); });

}  // namespace
}  // namespace radiafit
