#include "capture/lamp_calibration.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "base/log.h"
#include "base/parallel.h"
#include "base/range.h"
#include "base/statistics.h"
#include "base/wording.h"
#include "capture/light_file.h"
#include "lamps/refine_lamps.h"

namespace radiafit::tools {
namespace fs = std::filesystem;
namespace {

constexpr double disc_margin = 1.1;  // radii: an outline's blur, and what a near camera makes of a circle
constexpr size_t least_images = 3;
constexpr size_t least_refined = 6;           // images: a pixel's samples that lamps/refine_lamps.h asks for
constexpr double unlike_radii = 0.05;         // as a share
constexpr double far_off = 0.02;              // of a radius: highlights that no lamp explains
constexpr const char* automatic = "auto";     // up to two spheres
constexpr const char* automatic_n = "auto:";  // and their number

size_t spheres_wanted(const std::string& spheres) {
    if (spheres == automatic) return 2;
    constexpr Range<int> count{1, most_spheres};
    return size_t(parse_number(option_name("spheres") + " " + automatic_n + "N", spheres.substr(5), count));
}
bool is_automatic(const std::string& spheres) { return spheres == automatic || spheres.starts_with(automatic_n); }

/// Of all images at once: edges of spheres, and the brightest light.
struct Overview {
    SphereFinder finder;
    LuminanceImage brightest;
};
Overview look_over(const LitImages& images, const LitReader& reader) {
    Overview out;
    const size_t batch = size_t(thread_count());
    std::vector<LuminanceImage> read(batch);
    Progress progress("spheres", images.files.size());
    for (size_t first = 0; first < images.files.size(); first += batch) {
        const size_t count = std::min(batch, images.files.size() - first);
        parallel_for(count, 1, [&](size_t i, int) { read[i] = reader.luminance(reader.read(first + i)); });
        for (size_t i = 0; i < count; ++i) {
            out.finder.add(read[i]);
            if (out.brightest.values.empty()) {
                out.brightest = std::move(read[i]);
            } else {
                for (size_t p = 0; p < read[i].values.size(); ++p)
                    out.brightest.values[p] = std::max(out.brightest.values[p], read[i].values[p]);
            }
            progress.advance();
        }
    }
    return out;
}

std::vector<Circle> found_spheres(const LitImages& images, const std::string& spheres, const SphereFinder& finder,
                                  std::vector<std::string>& notes) {
    const size_t wanted = spheres_wanted(spheres);
    std::vector<Circle> found = finder.find(wanted);
    if (found.empty())
        throw UserError(
            fmt::format("{}: no glossy sphere was found in these images: say where one is ({} FILE, a line "
                        "x y radius for each), or give the lamps ({})",
                        images.folder.string(), option_name("spheres"), option_name("lights")));
    if (spheres != automatic && found.size() < wanted)
        notes.push_back(fmt::format("{}: {} of the {} spheres that {} asks for were found", images.folder.string(),
                                    found.size(), wanted, option_name("spheres")));
    return found;
}

/// given: x, y, radius.
std::vector<Circle> refined_spheres(const std::vector<Vec3d>& given, const std::string& file,
                                    const SphereFinder& finder) {
    std::vector<Circle> out;
    for (const Vec3d& c : given) {
        const std::optional<Circle> refined = finder.refined({c.head<2>(), c.z(), 0});
        if (!refined)
            throw UserError(
                fmt::format("{}: no outline of a sphere is seen near the circle at ({:g}, {:g}) of radius "
                            "{:g}: correct its line, to a sixth of the radius, or take it out",
                            file, c.x(), c.y(), c.z()));
        out.push_back(*refined);
    }
    return out;
}

/// What an image covers if the spheres have that radius.
double width_by_radius(const std::vector<Circle>& spheres, double radius, const LitImages& images,
                       std::vector<std::string>& notes) {
    double mean = 0, least = spheres[0].radius, most = least;
    for (const Circle& c : spheres) {
        mean += c.radius / double(spheres.size());
        least = std::min(least, c.radius);
        most = std::max(most, c.radius);
    }
    if (most > (1 + unlike_radii) * least)
        notes.push_back(
            fmt::format("the spheres' outlines have radii from {:.1f} to {:.1f} pixels, but {} means them "
                        "alike: give {} if they are not",
                        least, most, option_name("sphere-radius"), option_name("sample-width")));
    // A near camera sees a sphere, which rises above the plane, larger than it is there.
    double pixel = radius / mean;
    for (int step = 0; images.eye && step < 30; ++step) {
        const PictureFrame frame{images.format.file_width, images.format.file_height, pixel, images.eye};
        double seen = 0;
        for (const Circle& c : spheres) seen += sphere_of(c, frame).radius / double(spheres.size());
        pixel *= radius / seen;
    }
    return pixel * images.format.file_width;
}

/// "a.png, b.png and 3 more".
std::string name_some(const std::vector<fs::path>& files, const std::vector<uint32_t>& which) {
    constexpr size_t most = 8;
    std::string text;
    for (size_t i = 0; i < std::min(most, which.size()); ++i)
        text += (i ? ", " : "") + files[which[i]].filename().string();
    return which.size() > most ? fmt::format("{} and {} more", text, which.size() - most) : text;
}

void leave_out_unseen(const LitImages& images, const SphereLamps& found, LampCalibration& out) {
    std::vector<uint32_t> unseen;
    for (uint32_t i = 0; i < images.files.size(); ++i)
        if (!std::ranges::binary_search(found.images, i)) unseen.push_back(i);
    if (found.images.size() < least_images)
        throw UserError(fmt::format(
            "{}: the lamps of only {} of {} images are seen on {}: say where the spheres are ({} FILE, a line x y "
            "radius for each), or give the lamps' directions ({})",
            images.folder.string(), found.images.size(), images.files.size(),
            found.near ? "two spheres" : "the spheres", option_name("spheres"), option_name("lights")));
    if (!unseen.empty())
        out.notes.push_back(fmt::format("{} of {} images are left out, as {} not shown on {} where {} should be: {}",
                                        unseen.size(), images.files.size(),
                                        unseen.size() == 1 ? "its lamp is" : "their lamps are",
                                        found.near ? "two spheres" : "the spheres", unseen.size() == 1 ? "it" : "they",
                                        name_some(images.files, unseen)));
}

double median_of(const std::vector<CalibratedLamp>& lamps, double (CalibratedLamp::*deviation)() const) {
    std::vector<double> values;
    for (const CalibratedLamp& lamp : lamps) values.push_back((lamp.*deviation)());
    return median(values);
}

void tell_spheres(const SphereLamps& found, LampCalibration& out) {
    std::string places;
    double radius = 0;
    for (const Circle& c : out.spheres) {
        places += fmt::format("{}({:.1f}, {:.1f}) of radius {:.1f}", places.empty() ? "" : " and ", c.centre.x(),
                              c.centre.y(), c.radius);
        radius += c.radius / double(out.spheres.size());
    }
    out.remarks.push_back(fmt::format("{} {}, in pixels of the files at {}; left out of the surface, {} radii around",
                                      out.spheres.size(), out.spheres.size() == 1 ? "sphere" : "spheres", places,
                                      disc_margin));
    std::vector<double> residuals;
    for (const CalibratedLamp& lamp : found.lamps)
        if (lamp.spheres > 1) residuals.push_back(lamp.residual);
    if (out.spheres.size() > 1 && !found.near)
        out.remarks.push_back("the spheres do not tell how far away the lamps are: directions are taken");
    if (!residuals.empty() && median(residuals) > std::max(1.0, far_off * radius))
        out.notes.push_back(
            fmt::format("lamps and their highlights on several spheres disagree by {:.1f} pixels in the median: see in "
                        "lamps.png whether the spheres are where it says; {} FILE says where they are",
                        median(residuals), option_name("spheres")));
}

void tell_lamps(const LampCalibration& calibration, const char* how, std::vector<std::string>& remarks) {
    const auto& lamps = calibration.lamps;
    const bool near = std::ranges::any_of(lamps, [](const auto& l) { return l.light.kind == Light::Kind::near; });
    std::string text = fmt::format("{} of {} lamps {}, with standard deviations (median) of {:.2f} degrees",
                                   near ? "places" : "directions", lamps.size(), how,
                                   median_of(lamps, &CalibratedLamp::deviation_degrees));
    if (near)
        text +=
            fmt::format(", {:.2f} % of the distance", 100 * median_of(lamps, &CalibratedLamp::deviation_of_distance));
    std::vector<double> strengths;
    for (const Vec3d& d : calibration.deviations) strengths.push_back(d.maxCoeff());
    if (!strengths.empty()) text += fmt::format(", {:.2f} % of the strength", 100 * median(strengths));
    remarks.push_back(text + "; each is in lamps.csv");
}

void take_intensities(const LitImages& images, LampCalibration& out) {
    for (size_t k = 0; k < out.lamps.size(); ++k)
        out.lamps[k].light.intensity = images.intensities.empty() ? Vec3d::Ones() : images.intensities[out.images[k]];
}

/// Moves lamps, by whose steps' covariance (empty: held), and finds their strengths unless intensities are known.
void refine(const LitImages& images, const SurfaceSamples& samples, const Eigen::MatrixXd& covariance,
            LampCalibration& out) {
    const RefinedLamps refined = refine_lamps(out.lamps, covariance, samples);
    out.lamps = refined.lamps;
    take_intensities(images, out);
    if (!images.intensities.empty()) return;
    for (size_t k = 0; k < out.lamps.size(); ++k)
        out.lamps[k].light.intensity = intensity_of(out.lamps[k].light, refined.strengths[k]);
    out.deviations = refined.deviations;
}

}  // namespace

void check_spheres(const std::string& spheres) {
    if (is_automatic(spheres)) spheres_wanted(spheres);
}

LampCalibration calibrate_by_spheres(const LitImages& images, const SphereChoice& choice) {
    const std::vector<Vec3d> given =
        is_automatic(choice.spheres)
            ? std::vector<Vec3d>()
            : read_circles(choice.spheres, images.format.file_width, images.format.file_height);
    const LitReader reader(images);
    LampCalibration out;
    Overview overview = look_over(images, reader);
    const std::vector<Circle> circles = given.empty()
                                            ? found_spheres(images, choice.spheres, overview.finder, out.notes)
                                            : refined_spheres(given, choice.spheres, overview.finder);
    out.brightest = std::move(overview.brightest);
    out.width = choice.radius > 0 ? width_by_radius(circles, choice.radius, images, out.notes) : images.width;
    PictureFrame frame = images.frame();
    frame.pixel = out.width / frame.width;

    const size_t count = images.files.size();
    SurfacePixels surface(images, circles);
    out.highlights.resize(count);
    Progress progress("highlights", count);
    parallel_for(count, 1, [&](size_t i, int) {
        const PackedImage image = reader.read(i);
        const LuminanceImage luminance = reader.luminance(image);
        for (const Circle& c : circles) out.highlights[i].push_back(find_highlight(luminance, c));
        surface.take(i, reader, image);
        progress.advance();
    });
    progress.finish();

    SphereLamps found = lamps_by_spheres(circles, out.highlights, frame);
    leave_out_unseen(images, found, out);
    out.images = found.images;
    out.lamps = found.lamps;
    out.spheres = found.outlines;
    tell_spheres(found, out);
    take_intensities(images, out);
    // One sphere says how lamps stand from where it lies, which the surface as a whole need not agree with.
    const bool places = out.spheres.size() > 1, strengths = images.intensities.empty();
    if (out.images.size() < least_refined) {
        if (strengths)
            out.notes.push_back(fmt::format(
                "how bright lamps are is told from {} images on: these count as equally bright; {} says more",
                least_refined, option_name("intensities")));
    } else if (places || strengths) {
        try {
            refine(images, surface.samples(out.images, frame), places ? found.covariance : Eigen::MatrixXd(), out);
        } catch (const UserError& error) {
            if (strengths)
                throw UserError(
                    fmt::format("{}: {}: give {}", images.folder.string(), error.what(), option_name("intensities")));
            out.notes.push_back(fmt::format("{}, which are where the spheres show them", error.what()));
        }
    }
    tell_lamps(out, "by the spheres", out.remarks);
    return out;
}

LampCalibration refine_on_surface(const LitImages& images, const std::vector<Light>& said, double degrees) {
    if (images.files.size() < least_refined)
        throw UserError(fmt::format("{}: {} images are too few for {}, which takes {}: leave it out",
                                    images.folder.string(), images.files.size(), option_name("refine-lamps"),
                                    least_refined));
    const double radians = degrees * std::numbers::pi / 180;
    LampCalibration out;
    out.width = images.width;
    Eigen::VectorXd variance = Eigen::VectorXd::Zero(Eigen::Index(3 * said.size()));
    for (const Light& light : said) {
        const Eigen::Index at = Eigen::Index(3 * out.images.size());
        variance.segment<2>(at).setConstant(radians * radians);
        if (light.kind == Light::Kind::near) variance[at + 2] = std::pow(radians / light.place.norm(), 2);
        out.images.push_back(uint32_t(out.images.size()));
        out.lamps.push_back({.light = light});
    }
    const LitReader reader(images);
    SurfacePixels surface(images, {});
    Progress progress("lamps on the surface", said.size());
    parallel_for(said.size(), 1, [&](size_t i, int) {
        surface.take(i, reader, reader.read(i));
        progress.advance();
    });
    progress.finish();
    try {
        refine(images, surface.samples(out.images, images.frame()), variance.asDiagonal(), out);
    } catch (const UserError& error) {
        throw UserError(
            fmt::format("{}: {}: leave {} out", images.folder.string(), error.what(), option_name("refine-lamps")));
    }
    tell_lamps(out, "refined on the surface", out.remarks);
    return out;
}

std::vector<uint8_t> without_spheres(std::vector<uint8_t> mask, const std::vector<Circle>& spheres, int width,
                                     int height) {
    if (spheres.empty()) return mask;
    mask.resize(size_t(width) * size_t(height), 255);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            if (within(spheres, Vec2d(x + 0.5, y + 0.5), disc_margin)) mask[size_t(y) * size_t(width) + size_t(x)] = 0;
    return mask;
}

}  // namespace radiafit::tools
