#include "capture/png_file.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <string_view>

#include "base/atomic_file.h"
#include "base/error.h"

namespace radiafit {

void write_png(const std::filesystem::path& file, int width, int height, const std::vector<uint8_t>& rgb8) {
    namespace oiio = OIIO;
    if (width < 1 || height < 1 || rgb8.size() != size_t(width) * size_t(height) * 3)
        throw SystemError(
            fmt::format("write_png({}): {} bytes for {} x {} pixels", file.string(), rgb8.size(), width, height));
    const auto output = oiio::ImageOutput::create("png");
    if (!output) throw SystemError("OpenImageIO writes no PNG: " + oiio::geterror());
    // To memory: of a file that the disk did not take whole, OpenImageIO says nothing.
    oiio::Filesystem::IOVecOutput memory;
    output->set_ioproxy(&memory);
    oiio::ImageSpec spec(width, height, 3, oiio::TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    if (!output->open("memory.png", spec) || !output->write_image(oiio::TypeDesc::UINT8, rgb8.data()) ||
        !output->close())
        throw SystemError(fmt::format("OpenImageIO cannot make {}: {}", file.string(), output->geterror()));
    const std::vector<unsigned char>& bytes = memory.buffer();
    write_file(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace radiafit
