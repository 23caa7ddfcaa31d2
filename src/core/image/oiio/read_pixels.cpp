#include "image/oiio/read_pixels.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <memory>

namespace radiafit {
namespace {

namespace oiio = OIIO;

/// A file's bytes. OpenImageIO's own reader of memory takes offsets that a file states, such as -1, as they are.
class BoundedMemory : public oiio::Filesystem::IOMemReader {
public:
    explicit BoundedMemory(std::string_view bytes) : IOMemReader(bytes.data(), bytes.size()) {}
    bool seek(int64_t offset) override { return within(offset) && IOMemReader::seek(offset); }
    size_t pread(void* to, size_t bytes, int64_t offset) override {
        return within(offset) ? IOMemReader::pread(to, std::min(bytes, size() - size_t(offset)), offset) : 0;
    }

private:
    bool within(int64_t offset) const { return offset >= 0 && uint64_t(offset) <= size(); }
};

/// read_image writes as many values as the specification says: it must be what memory was taken for.
bool alike(const oiio::ImageSpec& spec, const ImageHeader& header) {
    return spec.width >= 1 && uint64_t(spec.width) == header.width && uint64_t(spec.height) == header.height &&
           spec.depth == 1 && spec.nchannels >= 1 && spec.alpha_channel < spec.nchannels;
}

/// libjpeg fills what is missing with grey and only warns: a warning counts.
template <class Channel>
void read_values(oiio::ImageInput& input, oiio::TypeDesc type, OiioPixels& out) {
    const oiio::ImageSpec& spec = input.spec();
    std::vector<Channel> values(size_t(spec.width) * size_t(spec.height) * size_t(spec.nchannels));
    const bool complete = input.read_image(0, 0, 0, spec.nchannels, type, values.data());
    out.image = {spec.width, spec.height, spec.nchannels, spec.alpha_channel, false, std::move(values), {}};
    out.image.names = spec.channelnames;
    if (!complete || input.has_error()) out.damage = input.geterror();
}

void read_pixels(const std::string& name, std::string_view bytes, const ImageHeader& header, const char* reader,
                 OiioPixels& out) {
    BoundedMemory memory(bytes);
    const std::unique_ptr<oiio::ImageInput> input = oiio::ImageInput::create(reader);
    if (!input) {
        out.failure = std::string("OpenImageIO has no reader for ") + reader;
        return;
    }
    oiio::ImageSpec config, spec;
    config["oiio:UnassociatedAlpha"] = 1;
    input->set_ioproxy(&memory);
    if (!input->open(name, spec, config))
        out.damage = input->geterror();
    else if (!alike(input->spec(), header))
        out.damage = "the picture differs from its header";
    else if (input->spec().format == oiio::TypeDesc::UINT8)
        read_values<uint8_t>(*input, oiio::TypeDesc::UINT8, out);
    else if (input->spec().format == oiio::TypeDesc::UINT16)
        read_values<uint16_t>(*input, oiio::TypeDesc::UINT16, out);
    else if (input->spec().format == oiio::TypeDesc::HALF || input->spec().format == oiio::TypeDesc::FLOAT)
        read_values<float>(*input, oiio::TypeDesc::FLOAT, out);
    else
        out.channel_type = input->spec().format.c_str();
}

}  // namespace
}  // namespace radiafit

extern "C" radiafit::ReadOiioPixels radiafit_read_oiio_pixels;  // NOLINT: its name is looked up

extern "C" void radiafit_read_oiio_pixels(const std::string& name, std::string_view bytes,
                                          const radiafit::ImageHeader& header, const char* reader,
                                          radiafit::OiioPixels& out) {
    radiafit::read_pixels(name, bytes, header, reader, out);
}
