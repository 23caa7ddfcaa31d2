#pragma once
#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "image/color_tags.h"

/// Colour profiles, by Little CMS: what a picture's values are in linear light of sRGB's primaries.
namespace radiafit::tools {

/// Values from 0 to 1 as stored, to linear light. One of the two: curves and a matrix, or a function of whole rows.
struct ColorConversion {
    std::string name;   ///< of the profile, printable; empty: it has none
    bool grey = false;  ///< the profile is of grey pictures
    /// Light of each channel's stored value; out of range, clamped.
    std::function<float(int channel, float stored)> curve;
    std::array<float, 9> matrix = {1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< rows
    /// In place of both: `pixels` triples of floats, in place.
    std::function<void(float* rgb, size_t pixels)> transform;
    std::string refusal;  ///< why the profile cannot be used, a few words; empty: it can
};

/// Of an ICC profile, which is checked before the library sees it: places and sizes of everything that it reads, and
/// tables no larger than the profile. Throws nothing of a bad one, but tells it in `refusal`.
ColorConversion read_icc_profile(const std::string& bytes);

/// Of chromaticities (all 0: sRGB's) and the power of stored values by ColorTags::gamma (0: sRGB's curve; 1: linear).
ColorConversion make_conversion(const std::array<double, 8>& chromaticities, double gamma);

}  // namespace radiafit::tools
