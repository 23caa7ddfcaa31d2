#pragma once
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "capture/calibration.h"
#include "capture/coverage.h"
#include "capture/gains.h"
#include "capture/import.h"
#include "capture/picture_facts.h"
#include "geometry/camera.h"
#include "geometry/mesh.h"
#include "geometry/raster.h"
#include "image/image_file.h"

/// The photographs of a capture: which there are, their pixels, and what they show of the mesh.
namespace radiafit::tools {

/// One photograph on its way from the model into the dataset.
struct Photograph {
    std::string name;
    std::filesystem::path image, mask;  ///< mask: empty if there are none
    Camera taken;                       ///< as calibrated, scaled to the file's size
    std::optional<Lens> lens;           ///< of `taken`; none: a pinhole
    std::filesystem::path same_camera;  ///< the photograph whose file's size `taken` has
    std::array<int, 2> full_size{};     ///< width and height that were calibrated
    Camera calibrated;                  ///< the pinhole that is made of `taken`; without a lens the same
    Camera camera;                      ///< `calibrated` after max_size
    bool held_out = false;
    double given_gain = 1;                  ///< of a table
    bool inverted_mask = false;             ///< its file has black for the object
    std::string exif_orientation = "auto";  ///< ImportOptions::exif_orientation
    // Found by the survey:
    int bits = 8;
    bool linear = false;  ///< of 8 and 16 bits: the values are linear light, not sRGB
    PictureFacts facts;
    int largest_mask_value = 255;            ///< in the mask's file, of 255
    bool mask_of_labels = false;             ///< see MaskFile
    std::array<int, 4> crop = {0, 0, 0, 0};  ///< x, y, width, height
    bool has_mask = false, sees_mesh = false, seen_in_mask = false;
    Coverage coverage;
    std::vector<GainSample> gain_samples;
};

struct LoadedPhotograph {
    ImageFile image;               ///< at the size of Photograph::camera
    std::vector<uint8_t> mask;     ///< [height][width] of that size: the object, and where a pixel shows something;
                                   ///< empty: all
    bool has_mask = false;         ///< of the object: a file or alpha
    int largest_mask_value = 255;  ///< of the mask's file
    bool mask_of_labels = false;
    PictureFacts facts = {};
};

/// The camera of the photograph scaled to a longest side of max_size pixels; 0: as it is.
Camera scaled_camera(const Camera& camera, int max_size);

/// The photographs of the calibration, which are located, with their masks, nothing surveyed yet. held_out: one per
/// image. What a user should know of the masks' names, lenses and scaled cameras goes to the report. Photographs with
/// the ratio of sides that was calibrated, to one pixel, and at most 0.9 or at least 1.1 of the size, get their
/// intrinsics scaled. Throws UserError for masks that are missing, photographs that are unreadable, of another ratio,
/// or larger than the rasterizer can draw, and for lenses that leave less than half of the picture.
std::vector<Photograph> list_photographs(const ImportOptions& options, const Calibration& calibration,
                                         const std::vector<uint8_t>& held_out, ImportReport& report);

/// Reads a photograph with its mask, and undistorts and scales both. Masks may have the size that was calibrated, too.
/// Throws UserError, also for another size than `taken`.
LoadedPhotograph load_photograph(const Photograph& photograph, const Calibration& calibration);

/// What the image shows of the mesh: the crop rectangle, and samples for the gains if points are given.
void survey(Photograph& photograph, const LoadedPhotograph& loaded, const Mesh& mesh, const GainPoints* points,
            Rasterizer& raster);

}  // namespace radiafit::tools
