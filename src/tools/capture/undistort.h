#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "capture/lens.h"
#include "geometry/camera.h"
#include "image/image_file.h"

/// Photographs taken through a lens, as a pinhole camera would have taken them.
namespace radiafit::tools {

/// The pinhole that COLMAP's image_undistorter chooses when nothing is asked of it: the same focal lengths and pose,
/// and the largest picture, changed in width and height by factors from 0.2 to 2, that the photograph fills. `taken`:
/// the camera of the photograph as it is, whose pixels `lens` displaces.
Camera undistorted_camera(const Camera& taken, const Lens& lens);

/// How much of two pictures has no counterpart in the other, in [0, 1], from a grid of 64 x 64 points.
struct UndistortionLoss {
    double blank = 0;       ///< of the pinhole's picture: beyond the photograph, or where the lens model folds over
    double no_pinhole = 0;  ///< of the photograph: where the lens model doesn't reach
};
UndistortionLoss undistortion_loss(const Camera& taken, const Lens& lens, const Camera& pinhole);

/// For undistort(). inside: [height][width], 255 where a pixel's centre shows something of the photograph, else 0;
/// empty if all do.
struct UndistortedImage {
    ImageFile image;
    std::vector<uint8_t> inside;
};

/// The photograph as `pinhole` has it, which may be scaled: both changes in one step. Each new pixel is the mean, in
/// linear light, of bilinear look-ups spread evenly over the parallelogram that it covers of the photograph (its
/// Jacobian), so many along each of its sides that they lie 1.25 pixels apart at most; encoded again as the image was.
/// So a uniform area keeps its stored value; where the picture gets smaller, each pixel of the photograph counts alike
/// to 11 % (two bilinear tents 1.25 pixels apart), and exactly where their distance is 1; where it stays as large, a
/// pixel is one bilinear look-up. Pixels that show nothing are black. Floats are averaged as they are, and so is alpha.
/// taken: of the image's size.
UndistortedImage undistort(const ImageFile& image, const Camera& taken, const Lens& lens, const Camera& pinhole);

/// The same for a mask of 0 and 255: 255 where at least half of the area is. Masks may have another size than the
/// photograph.
std::vector<uint8_t> undistort_mask(const std::vector<uint8_t>& mask, int width, int height, const Camera& taken,
                                    const Lens& lens, const Camera& pinhole);

/// The camera with its picture scaled to width x height.
Camera resized_camera(Camera camera, int width, int height);

}  // namespace radiafit::tools
