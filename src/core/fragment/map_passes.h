#pragma once
#include <array>
#include <functional>
#include <map>

#include "fragment/image_passes.h"
#include "fragment/problem_numbers.h"

namespace radiafit {

/// The passes over N-texel arrays that come once per sweep, not once per image: penalties, the finished gradient and
/// preconditioner, dot products and updates. One render target a pass but for updates, which write as many arrays as
/// they change, in place; or, where there are spares, each by itself into one of those.
class MapPasses {
public:
    /// vectors: those of optim/verbs.h, and the optimizer's behind them.
    MapPasses(const MapShape& shape, const SlsMesh& mesh, PassRunner& run, Gathers& gathers, ProblemTextures& problems,
              const ProblemNumbers& numbers, std::vector<MapVector>& vectors, const std::vector<MapVector>& spares,
              const LfmOptions& options, Storage storage);

    /// trial_g = sums / S-bar + penalties at x, zero for terms outside [first_term, last_term); adds the penalties to
    /// Sum::penalty.
    void finish_gradient(const MapVector& x, const MapSums& sums, int first_term, int last_term);
    /// fresh = floored preconditioner.
    void finish_precondition(const MapSums& squares);
    /// Sum::penalty_curvature at x along d.
    void finish_directional(const MapVector& x, const MapVector& d);
    /// Into the product's layer.
    void dot(const DotProduct& product);
    /// The caller exchanges spares for what is written.
    void update(Update which, std::initializer_list<int> vectors, std::initializer_list<int> numbers,
                std::initializer_list<float> constants);
    void drop_targets() { targets_.clear(); }  ///< of vectors that will be others

private:
    enum Site { surface, view };
    using Targets = std::array<std::vector<Framebuffer>, 2>;  ///< [site][corner * terms + term]
    struct Pair {                                             // the same pass over surface maps and over view maps
        Program program[2];
    };
    void set_term(const Pair& pair, int term);
    /// A MapVector or MapSums, to each program the part of its site.
    static void bind(const Pair& pair, std::string_view sampler, const auto& arrays, size_t index = 0) {
        pair.program[surface].bind(sampler, arrays.surface(), index);
        pair.program[view].bind(sampler, arrays.view(), index);
    }
    /// laplacian of `maps` at `term` into smoothed_
    void laplacian(const MapVector& maps, int term);
    /// One value per texel by `pair`, gathered and blended into `sum`.
    void gather_pass(const Pair& pair, const Framebuffer& sum, Gather gather, int term);
    /// One value per texel by `pair` into `targets`.
    void store_pass(const Pair& pair, const Targets& targets, int term);
    void draw(const Pair& pair, int site, const Framebuffer& target, size_t corner = 0);
    Pair make(const std::function<Program(const std::string& vertex_file, const Defines& defines)>& program) const;
    const std::vector<Pair>& update_pairs(Update which);  ///< compiled when they are first asked for
    /// Render targets of these vectors together.
    const Targets& targets(std::span<const MapVector* const> vectors);

    const MapShape& shape_;
    PassRunner& run_;
    Gathers& gathers_;
    ProblemTextures& problems_;
    const ProblemNumbers& numbers_;
    std::vector<MapVector>& vectors_;
    const std::vector<MapVector>& spares_;
    const SlsMesh& mesh_;
    LfmOptions options_;
    Storage storage_;
    Texture smoothed_[2], product_[2];  // [site]: 3 corners, or 1 layer of view maps
    std::vector<Framebuffer> smoothed_targets_[2], product_targets_[2];
    std::map<TextureList, Targets> targets_;
    std::map<Update, std::vector<Pair>> updates_;
    Pair laplacian_, penalty_error_, penalty_curvature_, gradient_, precondition_, floored_, dot_;
};

}  // namespace radiafit
