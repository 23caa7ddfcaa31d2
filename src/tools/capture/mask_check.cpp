#include "capture/mask_check.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "capture/coverage.h"

namespace radiafit::tools {
namespace {

std::string describe_inverted(std::span<const SmallView> views, std::span<const std::vector<uint8_t>> shown) {
    std::vector<std::string> names;
    for (size_t i = 0; i < views.size(); ++i)
        if (!views[i].mask.empty() && count_pixels(shown[i], views[i].mask).inverted(views[i].mask.size()))
            names.push_back(views[i].name);
    if (names.empty()) return "";
    constexpr size_t most = 8;
    const size_t all = names.size();
    if (all > most) names.resize(most);
    return fmt::format(
        "the masks of {} photographs are black where the mesh shows, and white is to mean object: {}{}: invert them",
        all, fmt::join(names, ", "), all > most ? ", ..." : "");
}

/// Of neighbours in the list, whose masks are exchanged where names or numbers went one astray.
std::string describe_shifted(std::span<const SmallView> views, std::span<const std::vector<uint8_t>> shown) {
    constexpr size_t least_views = 5;
    Coverage given, before, behind;
    size_t compared = 0;
    for (size_t i = 1; i + 1 < views.size(); ++i) {
        const size_t size = views[i].mask.size();
        if (size == 0 || views[i - 1].mask.size() != size || views[i + 1].mask.size() != size) continue;
        given += count_pixels(shown[i], views[i].mask);
        before += count_pixels(shown[i], views[i - 1].mask);
        behind += count_pixels(shown[i], views[i + 1].mask);
        ++compared;
    }
    if (compared < least_views) return "";
    const Coverage& best = before.overlap() > behind.overlap() ? before : behind;
    const double lacking = 1 - given.overlap();
    // Where neighbouring outlines are alike, masks that are a little wide or narrow must not be taken for others.
    if (lacking < 0.03 || 1 - best.overlap() > 0.5 * lacking) return "";
    return fmt::format(
        "the masks fit the photographs {} them in the list better: {:.0f} % of mesh and masks overlap then, not {:.0f} "
        "%: name each mask as its photograph",
        &best == &before ? "behind" : "before", 100 * best.overlap(), 100 * given.overlap());
}

}  // namespace

std::vector<std::string> check_single_masks(std::span<const SmallView> views,
                                            std::span<const std::vector<uint8_t>> shown) {
    std::vector<std::string> notes;
    for (std::string note : {describe_inverted(views, shown), describe_shifted(views, shown)})
        if (!note.empty()) notes.push_back(std::move(note));
    return notes;
}

}  // namespace radiafit::tools
