#pragma once
#include <array>

#include "stereo/grey_image.h"
#include "stereo/plane.h"

namespace radiafit::tools {

inline constexpr float worst_cost = 2;  ///< of values that are opposite; also of what cannot be compared

/// What a photograph shows around a pixel: 32 of the 11 x 11 pixels there, those at odd distances but the corners.
class Patch {
public:
    static constexpr int reach = 5, samples = 32;

    /// False, and nothing to compare, where the patch leaves the image or is nearly flat.
    bool take(const GreyImage& image, int x, int y);

    /// 1 - the normalized cross-correlation with what `source` shows there, from 0 to 2. worst_cost where the patch
    /// leaves the image, is flat, or is shrunk or enlarged more than four times in area.
    float cost(const GreyImage& source, const AffineMap& map) const;

private:
    alignas(32) std::array<float, samples> values_;  ///< of mean 0 and norm 1
};

}  // namespace radiafit::tools
