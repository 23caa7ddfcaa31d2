#pragma once
#include <optional>

#include "compute/sample_sweeps.h"
#include "fragment/image_passes.h"
#include "fragment/sls_mesh.h"

namespace radiafit {

/// Images that stream past sweeps in compute shaders, one at a time, each distributed anew: the item buffer is drawn by
/// the rasterizer, and every vertex's look-up in its view map is found and done. The number of a vertex is also that of
/// its pair with the image.
class PixelStream {
public:
    /// dataset and atlas must outlive it. Throws UserError for an atlas whose triangles' sides differ.
    PixelStream(const SweepResources& resources, const Dataset& dataset, const TriangleAtlas& atlas,
                std::vector<uint32_t> views, const StreamOptions& options);

    Defines defines() const { return mesh_.defines(); }
    /// Binds and sets all textures, buffers and uniforms of a program that stay as they are.
    void bind_to(const Program& program) const;
    /// body(image) for each image, on the device: its items, its views of the vertices' view maps of the vector `maps`,
    /// and along d if asked for.
    template <class Body>
    void run(int maps, bool along, const Body& body) {
        images_.run(
            [&](const std::vector<ImageOnDevice>& images) {
                begin(images.front(), maps, along);
                body(images.front());
            },
            [&] { mesh_.select({}); });
    }
    /// The samples of all images: every pixel adds itself to its tile's.
    TileStatistics count();
    /// An invocation for each pixel of an image.
    void dispatch_pixels(const Program& pass, const ImageOnDevice& image) const;
    /// Sets a program's uniforms for the image at hand.
    static void set_image(const Program& program, const ImageOnDevice& image);

    const std::vector<uint32_t>& drawn_tiles() const { return mesh_.drawn_tiles(); }
    const Texture& pairs() const { return pairs_.texture; }
    float scale16() const { return images_.scale16(); }
    const SweepTimes& times() const { return images_.times(); }

private:
    void draw(const ImageOnDevice& image);
    void begin(const ImageOnDevice& image, int maps, bool along);

    SweepResources r_;
    size_t vertices_;
    uint32_t texels_per_tile_;
    ImageSweep images_;
    SlsMesh mesh_;
    std::optional<ItemBuffer> items_;
    FetchedBuffer positions_;  ///< [vertex][4]: position, tangent, bitangent, normal
    FetchedBuffer pairs_, pair_values_, pair_slopes_;
    Program footprint_, look_up_, look_up_along_;
};

}  // namespace radiafit
