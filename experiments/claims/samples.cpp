#include <fmt/format.h>
#include <fmt/ranges.h>

#include <set>

#include "base/statistics.h"
#include "rules.h"

namespace radiafit::harness {
namespace {

/// How pixels reach texels, from table1_datasets' rows of one dataset and way to choose sides.
struct Reached {
    double texels_per_pixel;  ///< that face the camera, in the median image
    double dropped;           ///< share of pixels that no texel takes
    double middle;            ///< the median texel's samples
    double without, few;      ///< shares of texels: with none, and with fewer than 10
};

Reached reached(const FinishedRun& run, const std::string& files) {
    const CsvTable images = run.table(files + "_images.csv"), histogram = run.table(files + "_samples_per_texel.csv");
    std::vector<double> density;
    double covered = 0, kept = 0;
    for (size_t k = 0; k < images.row_count(); ++k) {
        covered += images.number(k, "covered_pixels");
        kept += images.number(k, "kept_pixels");
        if (images.number(k, "covered_pixels") > 0)
            density.push_back(images.number(k, "facing_texels") / images.number(k, "covered_pixels"));
    }
    double texels = 0, without = 0, few = 0;
    for (size_t k = 0; k < histogram.row_count(); ++k) {
        const double samples = histogram.number(k, "samples"), count = histogram.number(k, "texels");
        texels += count;
        without += samples == 0 ? count : 0;
        few += samples < 10 ? count : 0;
    }
    double up_to = 0, middle = 0;
    for (size_t k = 0; k < histogram.row_count() && up_to < 0.5 * texels; ++k) {
        up_to += histogram.number(k, "texels");
        middle = histogram.number(k, "samples");
    }
    return {median(density), 1 - kept / covered, middle, without / texels, few / texels};
}

Evidence pixels_and_texels(const FinishedRun& run) {
    const CsvTable t = run.table("datasets.csv");
    Evidence e;
    std::set<std::string> fixed, own_sides;
    std::vector<std::string> found, found_own;
    bool dense = true;
    std::string sparse;
    for (size_t i = 0; i < t.row_count(); ++i) {
        const std::string& name = t.text(i, "dataset");
        const bool own = t.text(i, "sides") == "own";
        const Reached r = reached(run, name + (own ? "_own_sides" : ""));
        e.beside.push_back(fmt::format(
            "{}, {}: {:.3g} texels per covered pixel in the median image, {:g} samples in the median texel; {:.1f} % "
            "of the pixels are dropped, because no texel takes them; {:.1f} % of the texels have no sample, {:.1f} % "
            "fewer than 10; {:g} times a texel took two pixels of one image",
            name, own ? "sides by projected size" : "one side for all", r.texels_per_pixel, r.middle, 100 * r.dropped,
            100 * r.without, 100 * r.few, t.number(i, "shared_texels")));
        if (own) {
            own_sides.insert(name);
            if (r.texels_per_pixel < 1) {
                dense = false;
                sparse += fmt::format("{}{} has {:.3g}", sparse.empty() ? "" : ", ", name, r.texels_per_pixel);
            }
            if (name == "star" || name == "bust")
                found_own.push_back(fmt::format("{} of the {}'s pixels ({:.3g} texels for each)",
                                                percent(1 - r.dropped), name, r.texels_per_pixel));
            e.measure("samples of the median texel, own sides", name + ", samples of the median texel",
                      exact(r.middle));
            e.measure("two pixels in one texel, own sides", name + ", texels that took two pixels of one image",
                      exact(t.number(i, "shared_texels")));
        } else if (name == "star" || name == "bust") {
            fixed.insert(name);
            e.measure("pixels in one texel", name + ", pixels that exactly one texel takes", exact(1 - r.dropped), "%");
            e.measure("texels without a sample", name + ", texels without a sample", exact(r.without), "%");
            e.measure("samples of the median texel", name + ", samples of the median texel", exact(r.middle));
            found.push_back(fmt::format(
                "of the {}'s pixels, for each of which {:.3g} texels face the camera in the median image, {} reach a "
                "texel, {} of its texels have no sample, and the median texel has {:g}",
                name, r.texels_per_pixel, percent(1 - r.dropped), percent(r.without), r.middle));
        }
    }
    e.premise("star and bust", fixed.size() == 2, "star and bust, with surface maps of one side");
    e.premise("star and bust, own sides", own_sides.contains("star") && own_sides.contains("bust"),
              "star and bust, with surface maps of their own sides");
    e.premise("a texel per pixel", dense,
              fmt::format("surfaces with a texel for each covered pixel at least; {}", sparse));
    e.sentence = fmt::format(
        "With surface maps of one side, {}; none reaches more than one, and no texel takes two pixels of an image, by "
        "construction.{}",
        fmt::join(found, "; "),
        found_own.empty() ? ""
                          : fmt::format(" With sides by projected size, which the paper did not have, {} reach one.",
                                        fmt::join(found_own, " and ")));
    return e;
}

}  // namespace

std::span<const ClaimCode> samples_claims() {
    static constexpr ClaimCode table[] = {{"C17", pixels_and_texels}};
    return table;
}

}  // namespace radiafit::harness
