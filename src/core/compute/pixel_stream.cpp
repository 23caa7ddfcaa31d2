#include "compute/pixel_stream.h"

#include "compute/scatter_sums.h"
#include "fragment/map_vector.h"

namespace radiafit {

PixelStream::PixelStream(const SweepResources& resources, const Dataset& dataset, const TriangleAtlas& atlas,
                         std::vector<uint32_t> views, const StreamOptions& options)
    : r_(resources),
      vertices_(r_.layout.problem_count()),
      texels_per_tile_(atlas.texels_per_tile()),
      images_(dataset, std::move(views), options.source, options.space, options.keep_on_device),
      mesh_(atlas) {
    const auto [width, height] = images_.largest();
    items_.emplace(mesh_, width, height, images_.bits());
    images_.set_batch(1);
    const auto frames = vertex_frames(atlas.mesh());
    std::vector<float> positions;
    for (size_t v = 0; v < vertices_; ++v)
        for (const Vec3f* row :
             {&atlas.mesh().positions[v], &frames[v].tangent, &frames[v].bitangent, &frames[v].normal})
            positions.insert(positions.end(), {row->x(), row->y(), row->z(), 0.0f});
    positions_ = FetchedBuffer("frames of vertices", GL_RGBA32F, positions.size() * sizeof(float), positions.data());
    const size_t values = vertices_ * size_t(r_.options.terms);
    pairs_ = FetchedBuffer::written("cameras' views of vertices", 2 * vertices_, GL_RGBA32UI);
    pair_values_ = FetchedBuffer::written("cameras' views of vertices", values);
    pair_slopes_ = FetchedBuffer::written("cameras' views of vertices", values);

    const Defines nearest = r_.options.lookup == ViewLookup::nearest ? Defines{{"NEAREST", ""}} : Defines{};
    footprint_ = r_.program("footprint.comp", nearest);
    footprint_.bind("positions", positions_.texture);
    footprint_.bind("Pairs", pairs_.buffer);
    look_up_ = r_.program("look_up_pair.comp");
    look_up_along_ = r_.program_over(vector::d, "look_up_pair.comp");
    for (const Program* made : {&look_up_, &look_up_along_}) {
        made->bind("pairs", pairs_.texture);
        made->set("pair_count", int(vertices_));
    }
    look_up_.bind("PairValues", pair_values_.buffer);
    look_up_along_.bind("PairValues", pair_slopes_.buffer);
}

void PixelStream::bind_to(const Program& program) const {
    program.bind_if_used("items", items_->items());
    program.bind_if_used("positions", positions_.texture);
    program.bind_if_used("pairs", pairs_.texture);
    program.bind_if_used("pair_values", pair_values_.texture);
    program.bind_if_used("pair_slopes", pair_slopes_.texture);
    program.bind_if_used("direction", r_.vectors[vector::d].texture);
    program.set_if_used("colour_bits", images_.bits());
    program.set_if_used("target_scale", images_.scale16());
}

void PixelStream::set_image(const Program& program, const ImageOnDevice& image) {
    SlsMesh::set_camera(program, *image.camera);
}

void PixelStream::dispatch_pixels(const Program& pass, const ImageOnDevice& image) const {
    set_image(pass, image);
    pass.dispatch(r_.problems.groups(size_t(image.camera->width) * size_t(image.camera->height)));
}

TileStatistics PixelStream::count() {
    const SampleCounter counter(r_.tables, images_.scale16(),
                                1.0 + double(texels_per_tile_) * double(images_.views().size()));
    const Program counting = r_.program("scatter_pixels.comp", defines() + SampleCounter::defines());
    bind_to(counting);
    counter.bind_to(counting);
    images_.run(
        [&](const std::vector<ImageOnDevice>& images) {
            draw(images.front());
            dispatch_pixels(counting, images.front());
        },
        [&] { mesh_.select({}); });
    return counter.read();
}

void PixelStream::draw(const ImageOnDevice& image) {
    mesh_.select({{image.camera}});
    items_->program().bind("image", *image.texture);
    items_->draw(*image.camera);
}

void PixelStream::begin(const ImageOnDevice& image, int maps, bool along) {
    draw(image);
    set_camera_centre(footprint_, *image.camera);
    footprint_.dispatch(r_.problems.groups(vertices_));
    look_up_.bind("maps", r_.vectors[size_t(maps)].texture);
    look_up_.dispatch(r_.problems.groups(vertices_));
    if (along) look_up_along_.dispatch(r_.problems.groups(vertices_));
}

}  // namespace radiafit
