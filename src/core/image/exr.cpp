#include "image/exr.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>
#include <half.h>

#include <algorithm>
#include <exception>
#include <fstream>
#include <stdexcept>

#include "base/atomic_file.h"
#include "base/error.h"
#include "image/exr_header.h"

namespace radiafit {
namespace {

/// No codec shrinks further: what claims more is damaged.
constexpr uint64_t most_pixels_per_byte = 2000;

// The part of a library message that fits on our one line.
std::string first_line(const std::exception& e) {
    const std::string what = e.what();
    return what.substr(0, what.find('\n'));
}

/// The file's bytes in memory: OpenEXR writes its last ones in a destructor, where it can report no error.
class MemoryStream : public Imf::OStream {
public:
    explicit MemoryStream(const std::string& name) : Imf::OStream(name.c_str()) {}
    const std::string& bytes() const { return bytes_; }

    void write(const char c[], int n) override {
        const size_t end = at_ + size_t(n);
        if (end > bytes_.size()) bytes_.resize(end);
        std::copy_n(c, n, bytes_.begin() + ptrdiff_t(at_));
        at_ = end;
    }
    uint64_t tellp() override { return at_; }
    void seekp(uint64_t pos) override { at_ = pos; }

private:
    std::string bytes_;
    size_t at_ = 0;
};

using ExpectedSize = std::optional<std::array<int, 2>>;

void check_size(const std::filesystem::path& path, int64_t width, int64_t height, const ExpectedSize& size) {
    if (size && (width != (*size)[0] || height != (*size)[1]))
        throw UserError(fmt::format("{}: {} x {} pixels where {} x {} belong; restore the file or fit again",
                                    path.string(), width, height, (*size)[0], (*size)[1]));
    const uint64_t bytes = std::filesystem::file_size(path);
    if (width < 1 || height < 1 || uint64_t(width) * uint64_t(height) / most_pixels_per_byte > bytes)
        throw UserError(fmt::format("{}: {} x {} pixels cannot be in {} bytes; restore the file or write it again",
                                    path.string(), width, height, bytes));
}

/// Before OpenEXR takes memory for what the header claims.
void check_header(const std::filesystem::path& path, const ExpectedSize& size) {
    std::ifstream in(path, std::ios::binary);
    const ExrHeader header = walk_exr_header(in, std::filesystem::file_size(path));
    if (!header.plain) throw std::runtime_error("it holds several or deep images");
    check_size(path, header.width, header.height, size);
}

}  // namespace

void write_exr(const std::filesystem::path& path, const ExrImage& image, ExrType type) {
    const size_t channels = image.channels.size();
    const size_t pixels = size_t(image.width) * size_t(image.height);
    if (image.width < 1 || image.height < 1 || channels == 0 || image.values.size() != pixels * channels)
        throw UserError(fmt::format("{}: an image of {} x {} with {} channels cannot be written from {} values",
                                    path.string(), image.width, image.height, channels, image.values.size()));
    std::vector<half> halves;
    if (type == ExrType::float16) halves.assign(image.values.begin(), image.values.end());
    MemoryStream bytes_of_file(path.string());
    try {
        Imf::Header header(image.width, image.height);
        header.compression() = Imf::ZIP_COMPRESSION;
        header.zipCompressionLevel() = 1;  // float maps hardly shrink further at higher levels
        for (const auto& [name, value] : image.notes) header.insert(name, Imf::StringAttribute(value));
        Imf::FrameBuffer frame;
        const Imf::PixelType pixel_type = type == ExrType::float32 ? Imf::FLOAT : Imf::HALF;
        const size_t bytes = type == ExrType::float32 ? sizeof(float) : sizeof(half);
        char* base = type == ExrType::float32 ? reinterpret_cast<char*>(const_cast<float*>(image.values.data()))
                                              : reinterpret_cast<char*>(halves.data());
        for (size_t c = 0; c < channels; ++c) {
            header.channels().insert(image.channels[c], Imf::Channel(pixel_type));
            frame.insert(image.channels[c], Imf::Slice(pixel_type, base + c * bytes, channels * bytes,
                                                       channels * bytes * size_t(image.width)));
        }
        Imf::OutputFile file(bytes_of_file, header);
        file.setFrameBuffer(frame);
        file.writePixels(image.height);
    } catch (const std::exception& e) {
        throw SystemError(fmt::format("OpenEXR cannot make {}: {}", path.string(), first_line(e)));
    }
    write_file(path, bytes_of_file.bytes());
}

ExrImage read_exr(const std::filesystem::path& path, const std::vector<std::string>& channels, ExpectedSize size) {
    if (!std::filesystem::is_regular_file(path))
        throw UserError(fmt::format("{}: no such file; restore it or write it again", path.string()));
    ExrImage image;
    image.channels = channels;
    try {
        check_header(path, size);
        Imf::InputFile file(path.string().c_str());
        const Imf::Header& header = file.header();
        const Imath::Box2i window = header.dataWindow();
        image.width = window.max.x - window.min.x + 1;
        image.height = window.max.y - window.min.y + 1;
        const Imf::ChannelList& present = header.channels();
        if (channels.empty())
            for (auto c = present.begin(); c != present.end(); ++c) image.channels.push_back(c.name());
        for (const std::string& name : image.channels)
            if (!present.findChannel(name)) throw std::runtime_error("channel " + name + " is missing");
        for (auto a = header.begin(); a != header.end(); ++a)
            if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&a.attribute()))
                image.notes[a.name()] = text->value();
        const size_t count = image.channels.size();
        image.values.resize(size_t(image.width) * size_t(image.height) * count);
        // OpenEXR addresses pixels by their place in the data window, which need not start at (0, 0).
        const ptrdiff_t column = ptrdiff_t(count * sizeof(float)), row = column * image.width;
        Imf::FrameBuffer frame;
        for (size_t c = 0; c < count; ++c)
            frame.insert(image.channels[c], Imf::Slice(Imf::FLOAT,
                                                       reinterpret_cast<char*>(image.values.data() + c) -
                                                           window.min.x * column - window.min.y * row,
                                                       size_t(column), size_t(row)));
        file.setFrameBuffer(frame);
        file.readPixels(window.min.y, window.max.y);
    } catch (const UserError&) {
        throw;
    } catch (const std::exception& e) {
        throw UserError(fmt::format("{}: cannot be read as OpenEXR ({}); restore it or write it again", path.string(),
                                    first_line(e)));
    }
    return image;
}

}  // namespace radiafit
