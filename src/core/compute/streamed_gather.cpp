#include "compute/pixel_stream.h"

namespace radiafit {
namespace {

/// A work group is a tile that the image may see, and an invocation one of its texels, which looks for its pixel: what
/// a sweep costs follows the surface's texels. Each sum has one invocation that makes it, image after image.
class StreamedGather final : public SampleSweeps {
public:
    StreamedGather(const SweepResources& resources, const Dataset& dataset, const TriangleAtlas& atlas,
                   std::vector<uint32_t> views, const StreamOptions& stream);
    Defines sums() const override { return {{"SUMS", "sums_in_place"}}; }
    void bind_to(const Program& program) const override { program.bind_if_used("tile_sums", tile_sums_.texture); }
    TileStatistics count() override { return pixels_.count(); }
    void gradient_pass(bool diagonal) override;
    void directional_pass() override;
    const SweepTimes& times() const override { return pixels_.times(); }

private:
    Program over_tiles(int maps, const std::string& file, const Defines& more) const;
    void dispatch(const Program& pass, const ImageOnDevice& image);
    /// Sums over rings of the image at hand, added to a vector.
    void sum_rings(const Program& pass);

    SweepResources r_;
    PixelStream pixels_;
    FetchedBuffer drawn_tiles_, tile_sums_, group_sums_, group_squares_;
    Program gradient_[2], line_, ring_sums_, ring_squares_;
    int turn_ = 0;
};

StreamedGather::StreamedGather(const SweepResources& resources, const Dataset& dataset, const TriangleAtlas& atlas,
                               std::vector<uint32_t> views, const StreamOptions& stream)
    : r_(resources), pixels_(r_, dataset, atlas, std::move(views), stream) {
    const size_t tiles = r_.tables.tile_count(), corners = 3 * tiles, terms = size_t(r_.options.terms);
    drawn_tiles_ = FetchedBuffer::written("triangles that an image may see", tiles, GL_R32UI);
    tile_sums_ = FetchedBuffer::written("sums of triangles", corners * tile_sums);
    for (FetchedBuffer* sums : {&group_sums_, &group_squares_})
        *sums = FetchedBuffer::written("sums of triangles", corners * terms);
    const Defines all{{"ALL", std::to_string(3 * terms + 3)}};
    gradient_[0] = over_tiles(vector::trial, "tile_pixels.comp", all);
    gradient_[1] = over_tiles(vector::trial, "tile_pixels.comp", all + Defines{{"DIAGONAL", ""}});
    line_ = over_tiles(vector::p, "tile_pixels_line.comp", {{"ALL", std::to_string(3 * tile_sums)}});
    ring_sums_ = r_.program("ring_sums.comp");
    ring_sums_.bind("group_sums", group_sums_.texture);
    ring_sums_.bind("Sums", r_.vectors[vector::trial_g].buffer);
    ring_squares_ = r_.program("ring_sums.comp", {{"SQUARES", ""}});
    ring_squares_.bind("group_sums", group_squares_.texture);
    ring_squares_.bind("Sums", r_.vectors[vector::fresh].buffer);
    for (const Program* made : {&ring_sums_, &ring_squares_}) made->bind("pairs", pixels_.pairs());
}

Program StreamedGather::over_tiles(int maps, const std::string& file, const Defines& more) const {
    Program made = r_.program(file, pixels_.defines() + more);
    pixels_.bind_to(made);
    made.bind("maps", r_.vectors[size_t(maps)].texture);
    made.bind("drawn_tiles", drawn_tiles_.texture);
    made.bind_if_used("Gradient", r_.vectors[vector::trial_g].buffer);
    made.bind_if_used("Fresh", r_.vectors[vector::fresh].buffer);
    made.bind_if_used("GroupSums", group_sums_.buffer);
    made.bind_if_used("GroupSquares", group_squares_.buffer);
    made.bind("TileSums", tile_sums_.buffer);
    return made;
}

void StreamedGather::dispatch(const Program& pass, const ImageOnDevice& image) {
    const std::vector<uint32_t>& drawn = pixels_.drawn_tiles();
    drawn_tiles_.buffer.write(0, drawn.size() * sizeof(uint32_t), drawn.data());
    pass.set("drawn_count", int(drawn.size()));
    turn_ = turn_ % (1 << 24) + 1;  // as a float, too
    pass.set_if_used("turn", float(turn_));
    PixelStream::set_image(pass, image);
    pass.dispatch(drawn.size());
}

void StreamedGather::sum_rings(const Program& pass) {
    pass.set("turn", float(turn_));
    pass.dispatch(r_.problems.groups(r_.layout.problem_count()));
}

void StreamedGather::gradient_pass(bool diagonal) {
    r_.vectors[vector::trial_g].buffer.clear();
    if (diagonal) r_.vectors[vector::fresh].buffer.clear();
    tile_sums_.buffer.clear();
    pixels_.run(vector::trial, false, [&](const ImageOnDevice& image) {
        dispatch(gradient_[diagonal], image);
        sum_rings(ring_sums_);
        if (diagonal) sum_rings(ring_squares_);
    });
}

void StreamedGather::directional_pass() {
    tile_sums_.buffer.clear();
    pixels_.run(vector::p, true, [&](const ImageOnDevice& image) { dispatch(line_, image); });
}

}  // namespace

std::unique_ptr<SampleSweeps> make_streamed_gather(const SweepResources& resources, const Dataset& dataset,
                                                   const TriangleAtlas& atlas, std::vector<uint32_t> views,
                                                   const StreamOptions& stream) {
    return std::make_unique<StreamedGather>(resources, dataset, atlas, std::move(views), stream);
}

}  // namespace radiafit
