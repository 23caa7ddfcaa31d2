#include "compute/pixel_stream.h"
#include "compute/scatter_sums.h"

namespace radiafit {
namespace {

/// An invocation is a pixel: what a sweep costs follows the images, whatever the number of texels.
class StreamedScatter final : public SampleSweeps {
public:
    StreamedScatter(const SweepResources& resources, const Dataset& dataset, const TriangleAtlas& atlas,
                    std::vector<uint32_t> views, const StreamOptions& stream, Accumulate accumulate);
    Defines sums() const override { return sums_.reading_defines(); }
    void bind_to(const Program& program) const override { sums_.bind_to(program); }
    TileStatistics count() override { return pixels_.count(); }
    void gradient_pass(bool diagonal) override;
    void directional_pass() override;
    const SweepTimes& times() const override { return pixels_.times(); }

private:
    Program scatter(int maps, const Defines& more) const;

    SweepResources r_;
    PixelStream pixels_;
    ScatterSums sums_;
    Program gradient_[2], line_;
};

StreamedScatter::StreamedScatter(const SweepResources& resources, const Dataset& dataset, const TriangleAtlas& atlas,
                                 std::vector<uint32_t> views, const StreamOptions& stream, Accumulate accumulate)
    : r_(resources),
      pixels_(r_, dataset, atlas, std::move(views), stream),
      sums_(r_, accumulate, r_.layout.problem_count(), pixels_.scale16()) {
    gradient_[0] = scatter(vector::trial, sums_.defines());
    gradient_[1] = scatter(vector::trial, sums_.defines() + Defines{{"DIAGONAL", ""}});
    line_ = scatter(vector::p, sums_.defines() + line_defines(r_.options));
}

Program StreamedScatter::scatter(int maps, const Defines& more) const {
    Program made = r_.program("scatter_pixels.comp", pixels_.defines() + more);
    pixels_.bind_to(made);
    sums_.bind_to(made);
    made.bind_if_used("maps", r_.vectors[size_t(maps)].texture);
    return made;
}

void StreamedScatter::gradient_pass(bool diagonal) {
    sums_.begin_gradient(diagonal);
    pixels_.run(vector::trial, false, [&](const ImageOnDevice& image) {
        pixels_.dispatch_pixels(gradient_[diagonal], image);
        sums_.spread(pixels_.pairs(), diagonal);
    });
}

void StreamedScatter::directional_pass() {
    sums_.begin_line();
    pixels_.run(vector::p, true, [&](const ImageOnDevice& image) { pixels_.dispatch_pixels(line_, image); });
}

}  // namespace

std::unique_ptr<SampleSweeps> make_streamed_scatter(const SweepResources& resources, const Dataset& dataset,
                                                    const TriangleAtlas& atlas, std::vector<uint32_t> views,
                                                    const StreamOptions& stream, Accumulate accumulate) {
    return std::make_unique<StreamedScatter>(resources, dataset, atlas, std::move(views), stream, accumulate);
}

}  // namespace radiafit
