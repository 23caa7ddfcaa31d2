#include "capture/capture_check.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/parallel.h"
#include "base/statistics.h"
#include "base/wording.h"
#include "capture/mask_check.h"
#include "dataset/view_directions.h"
#include "image/orientation.h"

namespace radiafit::tools {
namespace {

constexpr size_t point_count = 6000, neighbours = 4;
constexpr size_t searched_views = 16;
constexpr size_t least_views = 5;  // of fewer none is unlike the others

/// Half of them spread over the list, and of each its nearest neighbour, so that colours can be compared.
std::vector<SmallView> views_to_search(std::span<const SmallView> views, const Vec3d& centre) {
    if (views.size() <= searched_views) return {views.begin(), views.end()};
    std::vector<size_t> chosen;
    for (size_t k = 0; k < searched_views / 2; ++k) chosen.push_back(k * views.size() / (searched_views / 2));
    for (size_t k = 0; k < searched_views / 2; ++k) {
        const Vec3d towards = (views[chosen[k]].camera.center() - centre).normalized();
        size_t nearest = views.size();
        double most = -2;
        for (size_t j = 0; j < views.size(); ++j) {
            if (std::ranges::count(chosen, j)) continue;
            const double cosine = towards.dot((views[j].camera.center() - centre).normalized());
            if (cosine > most) most = cosine, nearest = j;
        }
        chosen.push_back(nearest);
    }
    std::vector<SmallView> result;
    for (const size_t i : chosen) result.push_back(views[i]);
    return result;
}

/// Whether what is black in the masks is where the mesh shows.
bool inverted(const Mesh& mesh, std::span<const SmallView> views) {
    Coverage coverage;
    uint64_t pixels = 0;
    Rasterizer raster;
    for (const SmallView& view : views) {
        if (view.mask.empty()) continue;
        raster.draw(mesh, view.camera);
        coverage += count_pixels(raster, view.mask);
        pixels += view.mask.size();
    }
    return coverage.inverted(pixels);
}

/// A photograph's pixels turned, as EXIF numbers orientations: the value that would turn them back.
struct Turn {
    int exif;
    const char* words;
};
constexpr std::array<Turn, 7> turns = {{{3, "turned by 180 degrees"},
                                        {6, "turned by 90 degrees clockwise"},
                                        {8, "turned by 90 degrees counterclockwise"},
                                        {2, "mirrored left to right"},
                                        {4, "mirrored top to bottom"},
                                        {5, "mirrored and turned"},
                                        {7, "mirrored and turned"}}};

/// None where that changes the size.
std::optional<SmallView> turned(const SmallView& view, int exif) {
    const auto width = size_t(view.camera.width), height = size_t(view.camera.height);
    if (swaps_sides(exif) && width != height) return {};
    return SmallView{view.name, view.camera, turn_upright(view.rgb, exif, width, height, 3),
                     turn_upright(view.mask, exif, width, height, 1)};
}

/// Compares each photograph with its neighbours.
class SingleViews {
public:
    SingleViews(const Mesh& mesh, std::span<const SmallView> views, const Vec3d& centre)
        : mesh_(mesh),
          views_(views),
          points_(surface_points(mesh, point_count)),
          pairs_(neighbour_pairs(views, centre, neighbours)),
          samples_(views.size()),
          shown_(views.size()),
          partners_(views.size()) {
        std::vector<Rasterizer> rasters(static_cast<size_t>(thread_count()));
        parallel_for(views.size(), 1, [&](size_t i, int worker) {
            Rasterizer& raster = rasters[size_t(worker)];
            samples_[i] = draw_and_observe(views_[i], raster);
            if (views_[i].mask.empty()) return;
            shown_[i].reserve(raster.pixels().size());
            for (const auto& pixel : raster.pixels()) shown_[i].push_back(pixel.triangle != no_triangle);
        });
        for (const auto& [a, b] : pairs_) {
            partners_[a].push_back(b), partners_[b].push_back(a);
            all_ += compare(samples_[a], samples_[b]);
        }
        for (size_t i = 0; i < views.size(); ++i)
            if (const auto own = agreement(i, samples_[i])) values_[i] = *own;
    }

    const SharedColours& all() const { return all_; }
    std::vector<std::string> check_masks() const { return check_single_masks(views_, shown_); }

    void find_unlike(CaptureCheck& check) const {
        if (values_.size() < least_views) return;
        std::vector<double> values, distances;
        for (const auto& [view, value] : values_) values.push_back(value);
        const double usual = median(values);
        for (const double value : values) distances.push_back(std::abs(value - usual));
        const double least = usual - std::max(0.3, 5 * 1.4826 * median(distances));
        if (usual < 0.4) return;  // they agree so little that no one stands out
        std::vector<size_t> unlike;
        for (const auto& [view, value] : values_)
            if (value < least) unlike.push_back(view);
        if (2 * unlike.size() > values_.size()) return;
        explain(unlike, usual, usual - 0.5 * (usual - least), check);
    }

private:
    std::vector<ColourSample> draw_and_observe(const SmallView& view, Rasterizer& raster) const {
        raster.draw(mesh_, view.camera);
        return observe(points_, view, &raster);
    }

    /// The second-best correlation with a neighbour, since some of them may be those that are wrong.
    std::optional<double> agreement(size_t view, const std::vector<ColourSample>& samples) const {
        std::vector<double> values;
        for (const size_t other : partners_[view])
            if (const SharedColours shared = compare(samples, samples_[other]); shared.pairs && shared.vary())
                values.push_back(shared.correlation());
        if (values.size() < 2) return {};
        std::ranges::sort(values, std::greater<>());
        return values[1];
    }

    /// Whether the photograph, taken by the view's camera, would.
    bool agrees(size_t view, SmallView photograph, double enough) const {
        const Camera& camera = views_[view].camera;
        if (photograph.camera.width != camera.width || photograph.camera.height != camera.height) return false;
        photograph.camera = camera;
        Rasterizer raster;
        const auto value = agreement(view, draw_and_observe(photograph, raster));
        return value && *value >= enough;
    }

    void explain(const std::vector<size_t>& unlike, double usual, double enough, CaptureCheck& check) const {
        std::map<std::string, std::vector<std::string>> turned_by;
        std::vector<size_t> left;
        for (const size_t i : unlike) {
            const Turn* found = nullptr;
            for (const Turn& turn : turns) {
                const auto attempt = turned(views_[i], turn.exif);
                if (!found && attempt && agrees(i, *attempt, enough)) found = &turn;
            }
            if (found)
                turned_by[found->words].push_back(views_[i].name);
            else
                left.push_back(i);
        }
        for (const auto& [how, names] : turned_by) {
            check.named.insert(check.named.end(), names.begin(), names.end());
            check.notes.push_back(
                fmt::format("{}: {} {} would show what the neighbours do: {} not stored as {} calibrated (EXIF "
                            "orientation?): turn {}, or calibrate as stored",
                            fmt::join(names, ", "), how, names.size() == 1 ? "it" : "they",
                            names.size() == 1 ? "it is" : "they are", names.size() == 1 ? "it was" : "they were",
                            names.size() == 1 ? "it" : "them"));
        }
        for (size_t a = 0; a < left.size(); ++a)
            for (size_t b = a + 1; b < left.size(); ++b)
                if (agrees(left[a], views_[left[b]], enough) && agrees(left[b], views_[left[a]], enough)) {
                    check.notes.push_back(fmt::format(
                        "{} and {} are exchanged: each shows what the other's neighbours do: name them the other way",
                        views_[left[a]].name, views_[left[b]].name));
                    check.named.insert(check.named.end(), {views_[left[a]].name, views_[left[b]].name});
                    left.erase(left.begin() + ptrdiff_t(b));
                    left.erase(left.begin() + ptrdiff_t(a));
                    --a;
                    break;
                }
        // Gloss may be reason enough for some difference that nothing else explains.
        std::vector<std::string> names;
        for (const size_t i : left)
            if (values_.at(i) < 0.65 * usual) names.push_back(views_[i].name);
        check.named.insert(check.named.end(), names.begin(), names.end());
        if (!names.empty())
            check.notes.push_back(fmt::format(
                "{}: {} other colours than the neighbours at the same places of the mesh: the pose is wrong, or the "
                "photograph is another's; calibrate again, or leave {} out{}",
                fmt::join(names, ", "), names.size() == 1 ? "shows" : "show", names.size() == 1 ? "it" : "them",
                at_command_line(" (radiafit fit --leave-out-outliers)", "")));
    }

    const Mesh& mesh_;
    std::span<const SmallView> views_;
    std::vector<SurfacePoint> points_;
    Pairs pairs_;
    std::vector<std::vector<ColourSample>> samples_;
    std::vector<std::vector<uint8_t>> shown_;  ///< which pixels see the mesh; empty of views without masks
    std::vector<std::vector<size_t>> partners_;
    std::map<size_t, double> values_;  ///< of those views that share enough with two others
    SharedColours all_;
};

}  // namespace

CaptureCheck check_capture(const Mesh& mesh, std::span<const SmallView> views, const FrameHints& hints) {
    CaptureCheck check;
    if (views.empty() || mesh.triangles.empty()) return check;
    const Vec3d centre = surface_centre(mesh, {});
    const std::vector<SmallView> searched = views_to_search(views, centre);
    check.masks_inverted = inverted(mesh, searched);
    if (!check.masks_inverted) check.misplacement = find_misplacement(mesh, searched, hints);
    const SingleViews single(mesh, views, centre);
    if (!check.masks_inverted && !check.misplacement) {
        check.notes = single.check_masks();
        single.find_unlike(check);
    }
    const SharedColours& all = single.all();
    constexpr double poor = 0.5, coarse = 20.0 / 255;
    if (!check.masks_inverted && !check.misplacement && check.named.empty() && all.pairs && all.vary() &&
        all.correlation() < poor && all.mean_difference() > coarse)
        check.notes.push_back(
            "neighbouring photographs show other colours at the same places of the mesh, and none of the usual "
            "mistakes explains it: check that poses, mesh and photographs belong together, their order, units and "
            "axes; a fit "
            "of this will be blurred");
    check.summary = all.pairs
                        ? fmt::format(
                              "neighbouring photographs differ by {:.1f} of 255 at the same places of the "
                              "mesh, their colours' correlation is {:.2f}",
                              255 * all.mean_difference(), all.correlation())
                        : "no two photographs show enough of the same places of the mesh to compare their colours";
    return check;
}

}  // namespace radiafit::tools
