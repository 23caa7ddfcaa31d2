#include "image/other_kinds.h"

#include <algorithm>
#include <cctype>
#include <string>

#include "image/image_format.h"

namespace radiafit {
namespace {

using namespace std::string_view_literals;

struct Signature {
    FileMark mark;
    OtherKind kind;
};

constexpr const char* to_png = "convert it to PNG (convert FILE FILE.png)";

constexpr Signature signatures[] = {
    {{"ftypcrx"sv, 4}, {"a camera's raw picture (CR3)", raw_cure}},
    {{"FUJIFILMCCD-RAW"sv}, {"a camera's raw picture (RAF)", raw_cure}},
    {{"IIRO"sv}, {"a camera's raw picture (ORF)", raw_cure}},
    {{"IIRS"sv}, {"a camera's raw picture (ORF)", raw_cure}},
    {{"IIU\0"sv}, {"a camera's raw picture (RW2)", raw_cure}},
    {{"FOVb"sv}, {"a camera's raw picture (X3F)", raw_cure}},
    {{"#?RADIANCE"sv}, {"a Radiance picture", "convert it to OpenEXR (oiiotool FILE -o FILE.exr)"}},
    {{"#?RGBE"sv}, {"a Radiance picture", "convert it to OpenEXR (oiiotool FILE -o FILE.exr)"}},
    {{"WEBP"sv, 8}, {"a WebP picture", "convert it to PNG (dwebp FILE -o FILE.png)"}},
    {{"GIF8"sv}, {"a GIF picture", to_png}},
    {{"BM"sv}, {"a BMP picture", to_png}},
    {{"8BPS"sv}, {"a Photoshop document", "export it as TIFF or PNG"}},
    {{"\xff\x0a"sv}, {"a JPEG XL picture", "convert it to PNG (djxl FILE FILE.png)"}},
    {{"\0\0\0\x0cJXL "sv}, {"a JPEG XL picture", "convert it to PNG (djxl FILE FILE.png)"}},
    {{"\0\0\0\x0cjP  "sv}, {"a JPEG 2000 picture", "convert it to PNG (opj_decompress -i FILE -o FILE.png)"}},
    {{"%PDF"sv}, {"a PDF document", "export its picture as PNG"}},
};

constexpr std::string_view raw_endings[] = {".3fr", ".arw", ".cr2", ".dcr", ".dng", ".erf", ".iiq",
                                            ".k25", ".kdc", ".mef", ".mos", ".nef", ".nrw", ".pef",
                                            ".raw", ".rwl", ".sr2", ".srf", ".srw"};

}  // namespace

const OtherKind* find_other_kind(std::string_view bytes) {
    for (const Signature& s : signatures)
        if (s.mark.in(bytes)) return &s.kind;
    return nullptr;
}

bool is_raw_name(const std::filesystem::path& file) {
    std::string ending = file.extension().string();
    std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return std::tolower(c); });
    return std::ranges::count(raw_endings, ending) > 0;
}

}  // namespace radiafit
