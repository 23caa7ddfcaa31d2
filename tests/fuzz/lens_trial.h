#pragma once
#include "capture/calibration.h"
#include "capture/undistort.h"
#include "target.h"

namespace radiafit::fuzz {

/// What an import does with a lens, on a small picture.
inline void try_lens(const tools::CalibratedImage& image) {
    const Camera& taken = image.camera;
    if (!image.lens || taken.width > 64 || taken.height > 64) return;
    const Camera pinhole = tools::undistorted_camera(taken, *image.lens);
    tools::undistortion_loss(taken, *image.lens, pinhole);
    ImageFile picture;
    picture.width = taken.width, picture.height = taken.height;
    picture.rgb8.assign(3 * size_t(taken.width) * size_t(taken.height), 100);
    tools::undistort(picture, taken, *image.lens, pinhole);
}

}  // namespace radiafit::fuzz
