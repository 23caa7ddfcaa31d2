#include <fmt/format.h>

#include "base/error.h"
#include "image/codecs.h"
#include "image/heif/read_heif.h"
#include "image/module.h"

namespace radiafit {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& kind) {
    throw UserError(
        fmt::format("{}: {}, which is not read: convert it to PNG (heif-convert FILE FILE.png)", file.string(), kind));
}

HeifPicture read_heif(const std::filesystem::path& file, std::string_view bytes, bool pixels) {
    static ReadHeif* const read = load_function<ReadHeif>(
        heif_module, heif_function,
        "HEIC, HEIF and AVIF pictures cannot be read ({}): install libheif-dev and build radiafit again, or convert "
        "them to PNG (heif-convert FILE FILE.png)");
    HeifPicture picture;
    read(bytes, pixels, picture);
    if (!picture.damage.empty()) fail_damaged_image(file, picture.damage);
    if (!picture.other.empty()) refuse(file, picture.other);
    return picture;
}

}  // namespace

ImageHeader read_heif_header(const std::filesystem::path& file, std::string_view bytes) {
    HeifPicture picture = read_heif(file, bytes, false);
    ImageHeader header;
    header.width = picture.width;
    header.height = picture.height;
    header.bits_per_pixel = uint64_t(picture.bits) * (picture.alpha ? 4 : 3);
    if (picture.profile_unreadable)
        header.colors.damage = "it cannot be read";
    else if (!picture.profile.empty())
        take_profile(picture.profile, header.colors);
    else if (!picture.numbers)
        header.colors.srgb = "HEIF's default";  // Source: ISO/IEC 23000-22, 7.3.6.4
    else if (const std::string other = take_numbers(*picture.numbers, "HEIF's colour numbers", header.colors);
             !other.empty())
        refuse(file, other);
    return header;
}

RawImage read_heif_pixels(const std::filesystem::path& file, std::string bytes, const ImageHeader& header) {
    HeifPicture picture = read_heif(file, bytes, true);
    if (picture.width != header.width || picture.height != header.height)
        fail_damaged_image(file, "the picture differs from its header");
    return std::move(picture.image);
}

}  // namespace radiafit
