#pragma once
#include "gl/image_passes.h"

namespace radiafit {

/// The passes over N-texel arrays that come once per sweep, not once per image: penalties, the finished gradient and
/// preconditioner, dot products and updates. One render target a pass but for the last, which writes four arrays.
class MapPasses {
public:
    MapPasses(const MapShape& shape, const SlsMesh& mesh, PassRunner& run, Gathers& gathers, ProblemTextures& problems,
              const LfmOptions& options, Storage storage);

    struct Vectors {
        MapVector p, trial, g, trial_g, precondition, fresh, d;
    };
    /// Makes the framebuffers. The vectors must stay where they are.
    void prepare(const Vectors& v);

    /// trial_g = sums / S-bar + penalties at x, zero for terms outside [first_term, last_term); adds the penalties to
    /// Sum::penalty.
    void finish_direction(const MapVector& x, const MapSums& sums, int first_term, int last_term);
    /// fresh = floored preconditioner.
    void finish_precondition(const MapSums& squares);
    /// Sum::penalty_curvature at x along d.
    void finish_line(const MapVector& x, const MapVector& d);
    /// Sum::norm, cross and conjugate; z = g / precondition, or g if null.
    void project(const Vectors& v, const MapVector* precondition);
    void update_direction(const Vectors& v, bool preconditioned, bool fresh);
    void advance(const Vectors& v);

private:
    enum Site { surface, view };
    struct Pair {  // the same pass over surface maps and over view maps
        Program program[2];
    };
    void set_term(const Pair& pair, int term);
    /// laplacian of `maps` at `term` into smoothed_
    void laplacian(const MapVector& maps, int term);
    /// One value per texel by `pair`, gathered and blended into `sum`. bind(site) puts the arrays in place.
    template <class Bind>
    void gather_pass(const Pair& pair, const Framebuffer& sum, Gather gather, int term, const Bind& bind);
    /// One value per texel by `pair` into `targets`.
    template <class Bind>
    void store_pass(const Pair& pair, const std::vector<Framebuffer> (&targets)[2], int term, const Bind& bind);

    const MapShape& shape_;
    PassRunner& run_;
    Gathers& gathers_;
    ProblemTextures& problems_;
    LfmOptions options_;
    Texture smoothed_[2], product_[2];  // [site]: 3 corners, or 1 layer of view maps
    std::vector<Framebuffer> smoothed_targets_[2], product_targets_[2];
    std::vector<Framebuffer> gradient_targets_[2], fresh_targets_[2], trial_targets_[2], update_targets_[2];
    Pair laplacian_, penalty_error_, penalty_curvature_, gradient_, precondition_, floored_, dot_[3], update_, advance_;
};

}  // namespace radiafit
