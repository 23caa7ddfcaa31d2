#pragma once
#include <algorithm>
#include <map>
#include <span>
#include <vector>

#include "fragment/device_engine.h"
#include "fragment/pass_runner.h"
#include "gl/context.h"

namespace radiafit {

/// Every problem's numbers in textures, and the steps of optimizers, which change them.
class ProblemNumbers final : public DeviceNumbers {
public:
    /// run must outlive it. place [problems]: row * width + column; empty: problem i is at place i. problems: the text
    /// in shaders/optimize that says what the passes before a step leave of one, "vertices" or "texels". one_target: a
    /// pass writes one target, which it doesn't read, in loops of constant length (Passes::r300).
    ProblemNumbers(PassRunner& run, int width, int height, size_t count, std::vector<uint32_t> place,
                   const std::string& problems, bool one_target);
    /// Makes the optimizer's numbers, all zero.
    void make_room(const Room& room);
    /// What takes a step; the caller binds what the text of the problems reads. Compiled when they are first asked for.
    const std::vector<Program>& programs(Step which, const Turn& turn);
    void step(Step which, const Turn& turn);
    /// Sets all of an update's program but its vectors. products: a layer each. numbers, constants: as update() of
    /// optim/engine.h has them.
    void set_update(const Program& update, const Texture& products, std::initializer_list<int> numbers,
                    std::initializer_list<float> constants) const;

    static int64_t device_bytes() { return Context::current().allocated_bytes(); }

    /// Waits for the device, but reads few texels back.
    EngineSummary summary();

    /// Layers of a problem's numbers, four 32-bit floats in each.
    static int layers(const Room& room) { return own_layer + (room.numbers + 3) / 4; }
    /// Widths and heights of the textures that summary() sums into, one from the other.
    static std::vector<std::array<int, 2>> summary_sizes(int width, int height, bool one_target);
    static uint64_t summary_texels(int width, int height, bool one_target);
    /// The layer where the optimizer's numbers begin, behind the fields of ProblemState.
    static constexpr int own_layer = (number::first_own + 3) / 4;

private:
    void write_fresh(std::span<const Status> status) override;
    std::vector<float> read(std::initializer_list<int> numbers) const override;
    std::vector<float> read_places(int layer) const;  ///< [height * width][4]
    size_t place(size_t problem) const { return place_.empty() ? problem : place_[problem]; }
    struct State {
        Texture numbers;  ///< four to a layer
        std::vector<Framebuffer> targets;
    };
    State make_state(int width, int height, int layers) const;

    PassRunner& run_;
    std::vector<uint32_t> place_;
    Defines defines_;
    bool one_target_;
    State state_;
    State next_;  ///< with one target: what a step writes, and then exchanges for state_
    std::map<std::pair<StepKey, int>, std::vector<Program>> programs_;  ///< of steps, by layers of own numbers
    Room room_;
    std::vector<Texture> summaries_;
    std::vector<Framebuffer> summary_targets_;
    Program summary_, further_summary_;
};

/// Textures that are drawn to together, as a key.
using TextureList = std::array<GLuint, MOST_VECTORS>;

/// The program of an update. `elements`: "map_elements" or "texel_elements" in shaders/optimize.
Program make_update(Update which, const std::string& vertex_file, const std::string& elements, const Defines& defines);

}  // namespace radiafit
