#pragma once
#include <memory>

#include "fragment/image_sweep.h"
#include "fragment/texel_arrays.h"
#include "fragment/texel_start.h"

namespace radiafit {

/// What the passes over images add to. Each belongs to one verb of the engine.
struct TexelAccumulators {
    TexelSumLayers gradient;  ///< maps of the gradient; the first's alpha: sum of r^2
    TexelSumLayers diagonal;  ///< of J'J, four numbers a layer
    TexelSumLayers line;      ///< one layer: sum of a^2, of a^2 + r b along d
    TexelSumLayers count;     ///< t u_z and u_z^2; samples
};

/// Sums over the samples of images, one or several at a time: the part of the engine that is written twice, once as
/// the paper has it and once with passes combined. Everything is added; the engine clears.
class TexelPasses {
public:
    virtual ~TexelPasses() = default;
    /// Images that one call takes; the last of a sweep may take fewer.
    virtual int batch() const = 0;
    virtual void count(const std::vector<ImageOnDevice>& images) = 0;
    /// One window of one group of a StartLayout into `sums`, as many layers as the window has targets.
    virtual void start(const std::vector<ImageOnDevice>& images, int group, int window, const TexelSumLayers& sums) = 0;
    /// At x: the gradient's sums, and on request the diagonal's.
    virtual void gradient_pass(const std::vector<ImageOnDevice>& images, const TexelVector& x, bool diagonal) = 0;
    /// At x along d.
    virtual void directional_pass(const std::vector<ImageOnDevice>& images, const TexelVector& x,
                                  const TexelVector& d) = 0;
    /// Ends a sweep of one of the above: only now must every image's samples be in the sums.
    virtual void finish() {}
};

/// What shaders/reflect/sample.glsl knows of a view: lamp, exposure, camera_centre. scale: linear value of a unit of 16
/// bits. clip_above: of TexelOptions; 0 where the dataset's encoding has no largest value.
std::array<float, 12> view_numbers(const View& view, float scale, float clip_above);

/// What every implementation of TexelPasses is made from. All references outlive it.
struct TexelPassResources {
    const TexelShape& shape;
    SlsMesh* mesh;  ///< null: a grid, whose texels are pixels
    PassRunner& run;
    const Texture& surface;  ///< shaders/reflect/site.glsl
    const TexelAccumulators& sums;
    const Dataset& dataset;
    const ImageSweep& images;
    Storage storage;
    float clip_above;  ///< of TexelOptions; 0 where the dataset's encoding has no largest value

    /// For programs that look into words of colour.
    Defines colour() const { return {{"COLOUR", std::to_string(images.bits())}}; }
    std::array<float, 12> numbers_of(const View& view) const {
        return view_numbers(view, images.scale16(), clip_above);
    }
    /// Where a grid's programs find pixels in a stack of so many images.
    void set_stack(const Program& program, int images_in_it) const;
    /// The shapes of a group's candidates, for start.frag.
    void set_shapes(const Program& program, int group) const;
};

/// Section 5 as printed: one image at a time; residuals in SLS first, then every map of the gradient by blending; one
/// render target a pass.
std::unique_ptr<TexelPasses> make_paper_texel_passes(const TexelPassResources& resources);
/// The same sums in one program that loops over as many images as memory holds at a time, with up to 8 render targets
/// (Section 6.5's proposal).
std::unique_ptr<TexelPasses> make_combined_texel_passes(const TexelPassResources& resources, int images_per_pass);
/// Images of one loop: layers of what texels took over a mesh, a stack over a grid. images_per_pass: of
/// FragmentOptions.
int combined_texel_images(const Atlas& atlas, size_t views, int bits, int images_per_pass);

}  // namespace radiafit
