#pragma once
#include <algorithm>
#include <map>
#include <span>
#include <tuple>
#include <vector>

#include "fragment/pass_runner.h"
#include "optim/engine.h"

namespace radiafit {

/// Every problem's numbers (optim/verbs.h) in textures, and the steps of optimizers, which change them.
class ProblemNumbers {
public:
    /// place [problems]: row * width + column; empty: problem i stands at place i. problems: the text in
    /// shaders/optimize that says what the passes before a step leave of one, "vertices" or "texels".
    ProblemNumbers(int width, int height, size_t count, std::vector<uint32_t> place, const std::string& problems);
    /// The optimizer's own, all zero.
    void make_room(const Room& room);
    /// Fresh problems; samples(problem): 0 where there is nothing to fit.
    template <class Samples>
    void reset(const Samples& samples) {
        std::vector<Status> status(count_);
        for (size_t i = 0; i < count_; ++i) status[i] = samples(i) ? Status::active : Status::no_samples;
        reset(std::span<const Status>(status));
    }
    void reset(std::span<const Status> status);
    /// What takes a step; the caller binds what the text of the problems reads. Compiled when it is first asked for.
    const Program& program(Step which, const Turn& turn);
    void step(PassRunner& run, Step which, const Turn& turn);
    /// products: a layer each. numbers, constants: as update() of optim/engine.h has them.
    void tell_update(const Program& update, const Texture& products, std::span<const int> numbers,
                     std::span<const float> constants) const;

    // These wait for the device. summary() reads few texels back, the others whole layers.
    EngineSummary summary(PassRunner& run);
    void outcomes(std::span<ProblemOutcome> out) const;  ///< [problems]
    void read_errors(std::span<float> out) const;        ///< [problems]

    /// Of four 32-bit floats each.
    static int layers(const Room& room) { return own_layer + (room.numbers + 3) / 4; }
    /// Widths and heights of the textures that summary() sums into, one from the other.
    static std::vector<std::array<int, 2>> summary_sizes(int width, int height);
    static uint64_t summary_texels(int width, int height);
    /// Where the optimizer's own begin; before stand the fields of ProblemState.
    static constexpr int own_layer = (number::first_own + 3) / 4;

private:
    std::vector<float> read_places(int layer) const;  ///< [height * width][4]
    std::vector<float> read_layer(int layer) const;   ///< [problems][4]

    size_t count_;
    std::vector<uint32_t> place_;
    Defines defines_;
    Texture state_;
    Framebuffer target_;
    std::map<std::tuple<Step, int, int, float>, Program> programs_;  ///< by layers of own numbers, and mends left out
    Room room_;
    std::vector<Texture> summaries_;
    std::vector<Framebuffer> summary_targets_;
    Program summary_, further_summary_;
};

/// Vectors by number, as a key.
using VectorList = std::array<int, MOST_VECTORS>;
inline VectorList vector_list(std::span<const int> vectors) {
    VectorList list;
    list.fill(vector::none);
    std::ranges::copy(vectors, list.begin());
    return list;
}

/// Makes or drops the optimizer's own vectors behind those of optim/verbs.h, and clears them. Framebuffers of vectors
/// that are gone go from `targets`, whose keys are lists of vectors. make(): one more vector.
template <class Vector, class Targets, class Make>
void make_own_vectors(const Room& room, std::vector<Vector>& vectors, Targets& targets, const Make& make) {
    const size_t wanted = size_t(room.vector_count());
    if (wanted != vectors.size()) {
        vectors.resize(std::min(wanted, vectors.size()));
        while (vectors.size() < wanted) vectors.push_back(make());
        std::erase_if(targets, [](const auto& entry) {
            return std::ranges::any_of(entry.first, [](int v) { return v >= vector::first_own; });
        });
    }
    for (size_t v = vector::first_own; v < wanted; ++v) vectors[v].clear();
}

/// The program of an update. `elements`: "map_elements" or "texel_elements" in shaders/optimize.
Program make_update(Update which, const std::string& vertex_file, const std::string& elements, const Defines& defines);

}  // namespace radiafit
