#pragma once
#include <optional>
#include <string>
#include <vector>

#include "capture/lit_images.h"

/// Where the lamps of a set of images are, and how bright, by the images themselves: by glossy spheres that they show,
/// and by the surface that they light.
namespace radiafit::tools {

struct LampCalibration {
    std::vector<uint32_t> images;       ///< those whose lamps are known
    std::vector<CalibratedLamp> lamps;  ///< of these images; with intensities
    /// [images] of the intensities, as shares of them: standard deviations. Empty: the intensities were not found here.
    std::vector<Vec3d> deviations = {};
    double width = 0;  ///< what an image covers, world units
    std::vector<Circle> spheres = {};
    std::vector<std::vector<std::optional<Highlight>>> highlights = {};  ///< [all images][sphere]
    LuminanceImage brightest = {};          ///< over all images, at the files' size; of spheres alone
    std::vector<std::string> notes = {};    ///< what the user should know, one line each
    std::vector<std::string> remarks = {};  ///< what a user may want to know, and is no cause to worry
};

struct SphereChoice {
    /// "auto": up to two are found; "auto:N": up to N; or a file of circles (capture/light_file.h), which are refined.
    std::string spheres;
    double radius = 0;  ///< of each sphere, world units, which then says what an image covers; 0: LitImages::width says
};

/// Throws UserError for a choice of spheres that is none: "auto:" and no number.
void check_spheres(const std::string& spheres);

/// Two spheres or more tell where lamps are, if these are near enough (lamps_by_spheres()), and one tells directions.
/// Then strengths, and places or directions by several spheres, are refined on the surface (refine_lamps()), which is
/// what the mask has and no sphere. Images whose lamps the spheres don't show have none. Throws UserError: no sphere,
/// fewer than three images left, a surface that tells no strengths.
LampCalibration calibrate_by_spheres(const LitImages& images, const SphereChoice& choice);

/// Lamps that are known roughly, refined on the surface with their strengths: each direction has this standard
/// deviation in either angle, and near lamps' distances the same in radians, as a share. Throws UserError for fewer
/// than six images, and for a surface that tells nothing.
LampCalibration refine_on_surface(const LitImages& images, const std::vector<Light>& said, double degrees);

/// The mask of a surface without the spheres on it, with a margin.
std::vector<uint8_t> without_spheres(std::vector<uint8_t> mask, const std::vector<Circle>& spheres, int width,
                                     int height);

}  // namespace radiafit::tools
