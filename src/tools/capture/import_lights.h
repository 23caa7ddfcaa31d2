#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

/// What `radiafit import lights` calls: images that show the same surface at the same pixels, each under its own lamp.
namespace radiafit::tools {

/// World space: origin at the middle of the images, x right, y up, z towards the camera; the images' plane is z = 0.
/// Text files: see capture/light_file.h. Empty paths: not given.
struct LightImportOptions {
    std::filesystem::path images;           ///< folder; 8 or 16 bits or floats, all alike
    std::filesystem::path lights;           ///< directions to distant lamps: .lp, or one per line
    std::filesystem::path light_positions;  ///< in its place: where near lamps are; needs sample_width
    std::string spheres;                ///< in its place: lamps are found (capture/lamp_calibration.h): SphereChoice
    double sphere_radius = 0;           ///< world units; in place of sample_width: says what an image's width covers
    double refine_lamps = 0;            ///< lights or light_positions are off by so many degrees; 0: by none
    std::filesystem::path names;        ///< images in the order of the lights; empty: those of the folder, sorted
    std::string light_axes;             ///< the file's axes that are the world's ("x,-y,z": y down); empty: as it is
    bool by_order = false;              ///< whatever names an .lp file has, as if it had none
    std::filesystem::path intensities;  ///< per image or one for all (see Light::intensity); empty: 1
    std::filesystem::path camera_positions;  ///< per image or one for all; empty: far away along +z. Needs sample_width
    std::filesystem::path mask;              ///< one for all images, white = object
    std::filesystem::path normals;           ///< see capture/normal_file.h; "flat": the plane's; empty: from the lights
    double sample_width = 0;                 ///< what an image's width covers, world units; 0: a pixel is one unit
    std::string transfer = "auto";           ///< see ImageSetFormat::transfer
    int max_size = 0;                        ///< longest side of an image, pixels; 0: as it is
    int depth = 0;                           ///< bits per channel that the images must have: 8, 16, 32; 0: any
    std::string holdout = "every:8";         ///< see capture/split.h; in the order of the lights
    std::string name;                        ///< of the dataset; empty: the output folder's
    bool force = false;                      ///< go on where memory or disk will not suffice
};

struct LightImportReport {
    size_t training = 0, held_out = 0;      ///< images written
    std::vector<std::string> notes;         ///< what the user should know, one line each
    std::vector<std::string> remarks = {};  ///< what a user may want to know, and is no cause to worry
    bool computed_normals = false;          ///< from the training images (model/photometric_stereo.h)
};

/// Lamps that were calibrated here are told in the dataset's lamps.csv, and spheres in its lamps.png (docs/formats.md).
///
/// Packs the images into a dataset over a grid (dataset/grid.h), pixels as they are stored but for 16-bit sRGB, which
/// becomes u16-linear, and scaled to max_size as means of linear light. Without a file of normals, they are computed
/// from the training images if those have distant lamps, three at least and not in one plane. A pixel is left out of an
/// image by the mask or by the image's alpha; a texel is left out of the grid by the mask, by a sphere, or for want of
/// a normal. Throws UserError; nothing is left at `out` then.
LightImportReport import_lights(const LightImportOptions& options, const std::filesystem::path& out);

}  // namespace radiafit::tools
