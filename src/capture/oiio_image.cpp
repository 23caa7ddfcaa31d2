#include "capture/oiio_image.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <memory>

#include "base/error.h"
#include "capture/tiff_header.h"

namespace radiafit {
namespace {

namespace oiio = OIIO;

using Input = std::unique_ptr<oiio::ImageInput>;

const char* reader_name(ImageFormat format) {
    return format == ImageFormat::jpeg ? "jpeg" : format == ImageFormat::tiff ? "tiff" : "openexr";
}

/// `memory` must outlive the input.
Input open_memory(const std::filesystem::path& file, oiio::Filesystem::IOMemReader& memory, ImageFormat format) {
    Input input = oiio::ImageInput::create(reader_name(format));
    if (!input) throw SystemError(fmt::format("OpenImageIO has no reader for {}", reader_name(format)));
    oiio::ImageSpec config, spec;
    config["oiio:UnassociatedAlpha"] = 1;
    input->set_ioproxy(&memory);
    if (!input->open(file.filename().string(), spec, config)) fail_damaged_image(file, input->geterror());
    return input;
}

/// read_image writes as many values as the specification says: it must be what memory was taken for.
void check_alike(const std::filesystem::path& file, const oiio::ImageSpec& spec, const ImageHeader& header) {
    if (spec.width < 1 || uint64_t(spec.width) != header.width || uint64_t(spec.height) != header.height ||
        spec.depth != 1 || spec.nchannels < 1 || spec.alpha_channel >= spec.nchannels)
        fail_damaged_image(file, "the picture differs from its header");
}

/// libjpeg fills what is missing with grey and only warns: a warning counts.
template <class Channel>
std::vector<Channel> read_values(const std::filesystem::path& file, oiio::ImageInput& input, oiio::TypeDesc type) {
    const oiio::ImageSpec& spec = input.spec();
    std::vector<Channel> values(size_t(spec.width) * size_t(spec.height) * size_t(spec.nchannels));
    const bool complete = input.read_image(0, 0, 0, spec.nchannels, type, values.data());
    if (!complete || input.has_error()) fail_damaged_image(file, input.geterror());
    return values;
}

}  // namespace

RawImage read_oiio_pixels(const std::filesystem::path& file, std::string bytes, const ImageHeader& header) {
    if (header.format == ImageFormat::tiff) bytes = plain_tiff(file, std::move(bytes));
    oiio::Filesystem::IOMemReader memory(bytes.data(), bytes.size());
    const Input input = open_memory(file, memory, header.format);
    const oiio::ImageSpec& spec = input->spec();
    check_alike(file, spec, header);
    RawImage image{spec.width, spec.height, spec.nchannels, spec.alpha_channel, false, {}};
    if (spec.format == oiio::TypeDesc::UINT8)
        image.values = read_values<uint8_t>(file, *input, oiio::TypeDesc::UINT8);
    else if (spec.format == oiio::TypeDesc::UINT16)
        image.values = read_values<uint16_t>(file, *input, oiio::TypeDesc::UINT16);
    else if (spec.format == oiio::TypeDesc::HALF || spec.format == oiio::TypeDesc::FLOAT)
        image.values = read_values<float>(file, *input, oiio::TypeDesc::FLOAT);
    else
        throw UserError(
            fmt::format("{}: channels are of type {}, neither 8 or 16 bits nor float: convert the image to PNG",
                        file.string(), spec.format.c_str()));
    return image;
}

}  // namespace radiafit
