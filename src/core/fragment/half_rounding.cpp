#include "fragment/half_rounding.h"

#include <array>
#include <map>
#include <mutex>

#include "base/half.h"
#include "gl/context.h"
#include "gl/program.h"
#include "gl/texture.h"

namespace radiafit {
namespace {

// What is rounded: half way from an even half to the next, from an odd one, and three quarters of the way from an even
// one; by one unit of the last place beyond 1 and, subnormal, 2^-24; and a subnormal that is a half itself.
constexpr float unit = 0x1p-10f, tiny = 0x1p-24f;
constexpr std::array<float, 7> whole = {1, 1 + unit, 1, 2 * tiny, 3 * tiny, 2 * tiny, 0x1p-15f},
                               rest = {unit / 2, unit / 2, 3 * unit / 4, tiny / 2, tiny / 2, 3 * tiny / 4, 0};

/// By how many units each of three was rounded up: 0 or 1.
std::string words(float even, float odd, float beyond) {
    if (beyond == 0) return even == 0 && odd == 0 ? "towards zero" : "in another way";
    if (beyond != 1) return "in another way";
    if (even == 0 && odd == 1) return "to nearest, ties to even";
    if (even == 1 && odd == 1) return "to nearest, ties away from zero";
    return even == 0 && odd == 0 ? "to nearest, ties towards zero" : "in another way";
}

HalfRounding told(const char* of, const std::array<float, 7>& rounded) {
    const auto up = [&](size_t i) { return (rounded[i] - whole[i]) / (i < 3 ? unit : tiny); };
    return {of, words(up(0), up(1), up(2)), rounded[6] == 0 ? "become 0" : words(up(3), up(4), up(5))};
}

std::vector<float> four_of_each(const std::array<float, 7>& values, const std::array<float, 7>& more) {
    std::vector<float> out;
    for (size_t i = 0; i < values.size(); ++i) out.insert(out.end(), 4, values[i] + more[i]);
    return out;
}

void draw(const Program& program, const std::vector<float>& values, const Framebuffer& target) {
    Texture floats(GL_RGBA32F, int(values.size() / 4), 1, 1);
    floats.upload(GL_RGBA, GL_FLOAT, values.data());
    program.bind("values", floats);
    const VertexArray empty;
    empty.bind();
    target.bind();
    program.use();
    gl().DrawArrays(GL_TRIANGLES, 0, 3);
}

/// The first of each texel's halves.
std::array<float, 7> read(const Texture& halves, GLenum format, GLenum type) {
    std::array<uint16_t, 4 * whole.size()> bits;
    halves.download(format, type, bits.data(), sizeof bits);
    std::array<float, 7> out;
    for (size_t i = 0; i < out.size(); ++i) out[i] = float_from_half(bits[4 * i]);
    return out;
}

constexpr const char* nearest = "to nearest, ties to even";

Defines numbered(Storage storage) { return {{"STORAGE", std::to_string(int(storage))}}; }

Program storing(const Defines& storage) { return Program::draw("common/whole.vert", "gather/store.frag", storage); }

HalfRounding rounding_of_words(const char* of, const Defines& storage) {
    const Texture packed(GL_RG32UI, int(whole.size()), 1, 1);
    draw(storing(storage), four_of_each(whole, rest), Framebuffer({{&packed}}));
    return told(of, read(packed, GL_RG_INTEGER, GL_UNSIGNED_INT));
}

}  // namespace

Defines storage_defines(Storage storage) {
    if (storage != Storage::fp16) return numbered(storage);
    static std::mutex mutex;
    static std::map<std::string, bool> known;
    const std::lock_guard lock(mutex);
    const std::string& renderer = Context::current().renderer();
    if (!known.contains(renderer)) {
        const HalfRounding packing = rounding_of_words("packing", numbered(storage));
        known[renderer] = packing.values == nearest && packing.subnormals == nearest;
    }
    return known[renderer] ? numbered(storage) : numbered(storage) + Defines{{"OWN_HALVES", ""}};
}

std::vector<HalfRounding> measure_half_rounding() {
    std::vector<HalfRounding> out = {rounding_of_words("packing", numbered(Storage::fp16)),
                                     rounding_of_words("storage", storage_defines(Storage::fp16))};
    const Texture halves(GL_RGBA16F, int(whole.size()), 1, 1);
    const Framebuffer target({{&halves}});
    const Program program = storing(numbered(Storage::fp16_truncate));
    draw(program, four_of_each(whole, rest), target);
    out.push_back(told("render target", read(halves, GL_RGBA, GL_HALF_FLOAT)));

    constexpr std::array<float, 7> zero = {};
    draw(program, four_of_each(whole, zero), target);
    gl().Enable(GL_BLEND);
    gl().BlendEquation(GL_FUNC_ADD);
    gl().BlendFunc(GL_ONE, GL_ONE);
    draw(program, four_of_each(zero, rest), target);
    gl().Disable(GL_BLEND);
    out.push_back(told("blended sum", read(halves, GL_RGBA, GL_HALF_FLOAT)));
    return out;
}

}  // namespace radiafit
