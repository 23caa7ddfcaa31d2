#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace radiafit {

inline constexpr size_t largest_profile = size_t(4) << 20;  ///< bytes; beyond any profile of a camera or a screen

/// What a picture's file says of its colours. read_image() applies nothing of it: capture/picture_colors.h does.
struct ColorTags {
    std::string profile;  ///< the bytes of an ICC profile, not looked into yet; empty: none
    std::string damage;   ///< why a profile that the file announces cannot be taken out of it; empty: nothing is wrong
    std::string srgb;     ///< what says that values are sRGB, such as "the chunk sRGB"; empty: nothing
    /// PNG's chunk gAMA, or what HEIF or EXIF say: the stored value is light to this power; 0: none.
    double gamma = 0;
    /// x and y of red, green, blue and white (PNG's cHRM, an EXR's attribute, HEIF's or EXIF's); all 0: none.
    std::array<double, 8> chromaticities = {};
    std::string numbers_by;  ///< what says gamma and chromaticities, where PNG's chunks do not

    bool has_chromaticities() const { return chromaticities != std::array<double, 8>{}; }
    bool has_profile() const { return !profile.empty() || !damage.empty(); }
};

/// The numbers by which PNG's chunk cICP and a HEIF's colr box name primaries and curve (ITU-T H.273, tables 2 and 3).
struct ColorNumbers {
    int primaries = 2, curve = 2;  ///< 2: unspecified
};

/// Replaces what `tags` say by the numbers, `by` which name they came. BT.709's curve counts as sRGB's, as it does in
/// practice. Returns what kind of picture the numbers name where it is none that could be read: PQ, HLG, logarithms.
std::string take_numbers(const ColorNumbers& numbers, const char* by, ColorTags& tags);

/// x and y of red, green, blue and white. Sources: IEC 61966-2-1; Adobe RGB (1998), 4.3.1.
inline constexpr std::array<double, 8> srgb_chromaticities = {0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.329};
inline constexpr std::array<double, 8> adobe_rgb_chromaticities = {0.64, 0.33, 0.21, 0.71, 0.15, 0.06, 0.3127, 0.329};

/// Puts a JPEG's pieces of a profile together: the contents of its APP2 segments behind "ICC_PROFILE\0", in the order
/// of the file. Source: ICC.1:2010, B.4.
void join_profile(const std::vector<std::string_view>& pieces, ColorTags& tags);

/// A PNG's compressed profile: the content of its iCCP chunk. Source: PNG specification, 11.3.3.3.
void unpack_profile(std::string_view chunk, ColorTags& tags);

/// A profile as it stands in the file.
void take_profile(std::string_view bytes, ColorTags& tags);

}  // namespace radiafit
