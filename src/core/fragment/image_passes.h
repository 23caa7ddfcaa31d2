#pragma once
#include <memory>

#include "fragment/gathers.h"
#include "fragment/image_sweep.h"
#include "fragment/problem_textures.h"

namespace radiafit {

/// What the passes over images work on: N-texel arrays, sums, and where they accumulate.
class MapSums {
public:
    std::vector<Framebuffer> surface_targets, view_targets;
    MapSums() = default;
    MapSums(const MapShape& shape, Sums sums);
    void clear(PassRunner& run) const;
    const Texture& surface() const { return surface_; }  ///< layers as MapVector's
    const Texture& view() const { return view_; }

private:
    Texture surface_, view_;
};

/// Sums over the samples of images, one or several at a time: the part of the engine that is written twice, once as
/// the paper has it and once with passes combined. Everything accumulates; the engine clears.
class ImagePasses {
public:
    virtual ~ImagePasses() = default;
    /// Most images that one call may take.
    virtual int batch() const { return 1; }
    /// Around every sweep over images; the sums that gradient_pass() will be given, if any, and always the same ones.
    virtual void begin_sweep(MapSums*, MapSums*) {}
    virtual void end_sweep() {}
    /// Sum::target: sum of L t, and samples in alpha.
    virtual void count(const std::vector<ImageOnDevice>& images) = 0;
    /// At x: Sum::residual and the gradient sums; squares, if not null: diag(J'J).
    virtual void gradient_pass(const std::vector<ImageOnDevice>& images, const MapVector& x, MapSums& gradient,
                               MapSums* squares) = 0;
    /// At x along d: Sum::gauss_newton and curvature, with `quartic` also third and fourth.
    virtual void directional_pass(const std::vector<ImageOnDevice>& images, const MapVector& x, const MapVector& d,
                                  bool quartic) = 0;
};

/// What every implementation of ImagePasses is made from. All references outlive it.
struct PassResources {
    const MapShape& shape;
    SlsMesh& mesh;
    PassRunner& run;
    Gathers& gathers;
    ProblemTextures& problems;
    const Texture& vertices;  ///< 4 layers: position, tangent, bitangent, normal
    Passes passes;
    Storage storage;
    Sums sums;
    ViewLookup lookup;
    int max_width, max_height;  ///< of the images
    int bits;                   ///< per channel
    int images_per_pass;        ///< see FragmentOptions
    size_t kept_images = 0;     ///< whose samples stay on the device; 0: all are distributed in every sweep
};

/// The camera's centre for shaders/gather/footprint.frag: each coordinate as the sum of two floats.
void set_camera_centre(const Program& program, const Camera& camera);

/// Section 5 as printed: one image at a time; item buffer; residuals in SLS for each corner; gradients by blending
/// and gather. One render target a pass, but for footprints, which with Passes::r300 have two passes.
std::unique_ptr<ImagePasses> make_paper_passes(const PassResources& resources);
/// Images that a combined pass takes at a time; images_per_pass: see FragmentOptions.
int combined_batch(int terms, int bits, int varying_components, int images_per_pass);
/// The same sums in few passes: several images at a time, up to 8 render targets (Section 6.5's proposal).
std::unique_ptr<ImagePasses> make_combined_passes(const PassResources& resources);

}  // namespace radiafit
