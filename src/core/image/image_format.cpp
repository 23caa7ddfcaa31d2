#include "image/image_format.h"

#include <algorithm>
#include <cctype>

#include "image/codecs.h"

namespace radiafit {
namespace {

using namespace std::string_view_literals;

RawImage read_jpeg_pixels(const std::filesystem::path& file, std::string bytes, const ImageHeader& header) {
    return read_oiio_pixels(file, bytes, header, "jpeg");
}

}  // namespace

std::span<const ImageFormat> image_formats() {
    // OpenEXR and PFM hold floats.
    static const std::vector<ImageFormat> formats = {
        {"PNG", {".png"}, {{"\x89PNG"sv}}, true, true, false, read_png_header, read_png_pixels},
        {"JPEG", {".jpg", ".jpeg"}, {{"\xff\xd8"sv}}, true, true, true, read_jpeg_header, read_jpeg_pixels},
        {"TIFF",
         {".tif", ".tiff"},
         {{"II*\0"sv}, {"MM\0*"sv}, {"II+\0"sv}, {"MM\0+"sv}},
         true,
         true,
         false,
         read_tiff_header,
         read_tiff_pixels},
        {"OpenEXR", {".exr"}, {{"\x76\x2f\x31\x01"sv}}, true, false, false, read_exr_header, read_exr_pixels},
        {"HEIF",
         {".heic", ".heif", ".hif", ".avif"},
         {{"ftyphei"sv, 4}, {"ftyphev"sv, 4}, {"ftypmif1"sv, 4}, {"ftypmsf1"sv, 4}, {"ftypavi"sv, 4}},
         true,
         false,
         true,
         read_heif_header,
         read_heif_pixels},
        {"PFM", {".pfm"}, {{"PF"sv}, {"Pf"sv}}, false, false, false, read_pfm_header, read_pfm_pixels},
        // Met in folders of pictures, and refused rather than passed over.
        {"Radiance", {".hdr"}, {}},
        {"BMP", {".bmp"}, {}}};
    return formats;
}

const ImageFormat* format_of_name(const std::filesystem::path& file) {
    std::string ending = file.extension().string();
    std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return std::tolower(c); });
    const auto named = [&](const ImageFormat& format) { return std::ranges::count(format.endings, ending) > 0; };
    const auto formats = image_formats();
    const auto found = std::ranges::find_if(formats, named);
    return found == formats.end() ? nullptr : &*found;
}

}  // namespace radiafit
