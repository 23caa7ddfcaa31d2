// Files of RTI by other programs: .ptm, .rti, relight's info.json.
#include <array>
#include <cstring>

#include "base/error.h"
#include "capture/rti_file.h"
#include "picture_bytes.h"
#include "target.h"

namespace radiafit::fuzz {
namespace {

constexpr int side = 2;
const std::string head = "2\n2\n2 2 2 2 2 2\n160 160 160 127 127 0\n";

std::string plane() { return testing::encode_tiff(testing::tiff_entries(side, side, 1, 8), "abcd"); }

/// Uncompressed, of both kinds; and of planes that are pictures, one of them predicted and put right.
std::vector<std::string> ptm_files(const fs::path&) {
    std::string packed = "PTM_1.2\nPTM_FORMAT_JPEG_LRGB\n" + head + "90\n0 0 1 0 0 0 0 0 0\n";
    packed += "0 0 0 0 0 0 0 0 0\n0 0 0 0 0 0 0 0 0\n0 1 2 3 4 5 6 7 8\n-1 -1 0 -1 -1 -1 -1 -1 -1\n";
    for (int i = 0; i < 9; ++i) packed += std::to_string(plane().size()) + " ";
    packed += "\n0 0 5 0 0 0 0 0 0\n";
    for (int i = 0; i < 9; ++i) packed += plane() + (i == 2 ? std::string("\0\0\0\1z", 5) : "");
    return {"PTM_1.2\nPTM_FORMAT_LRGB\n" + head + std::string(36, 'x'),
            "PTM_1.2\nPTM_FORMAT_RGB\n" + head + std::string(72, 'x'), packed};
}

std::vector<std::string> hsh_files(const fs::path&) {
    const std::array<float, 8> scale_and_bias = {1, 1, 1, 1, 0, 0, 0, 0};
    std::string floats(sizeof scale_and_bias, '\0');
    std::memcpy(floats.data(), scale_and_bias.data(), sizeof scale_and_bias);
    return {"#HSH1.2\r\n3\r\n2 2 3\r\n4 2 1\r\n" + floats + std::string(48, 'x')};
}

std::vector<std::string> info_files(const fs::path& folder) {
    const std::string rgb = testing::encode_tiff(testing::tiff_entries(side, side, 3, 8), "abcdefghijkl");
    for (int i = 0; i < 6; ++i) put_bytes(folder / ("plane_" + std::to_string(i) + ".jpg"), rgb);
    const auto list = [](int count, const std::string& number) {
        std::string text = "[" + number;
        for (int i = 1; i < count; ++i) text += "," + number;
        return text + "]";
    };
    const auto info = [&](const std::string& kind, int planes, const std::string& more) {
        return "{\"width\":2,\"height\":2,\"format\":\"jpg\",\"nplanes\":" + std::to_string(planes) + "," + kind +
               ",\"materials\":[{\"scale\":" + list(planes, "1.5") + ",\"bias\":" + list(planes, "0.5") +
               ",\"range\":" + list(planes, "300") + "}]" + more + "}";
    };
    return {info("\"type\":\"ptm\",\"colorspace\":\"lrgb\"", 9, ""),
            info("\"type\":\"hsh\",\"colorspace\":\"rgb\"", 12, ""),
            info("\"type\":\"bilinear\",\"colorspace\":\"mrgb\"", 2, ",\"resolution\":2,\"basis\":" + list(36, "99")),
            info("\"type\":\"rbf\",\"colorspace\":\"mycc\"", 3,
                 ",\"yccplanes\":[1,1,1],\"sigma\":0.2,\"lights\":[0,0,1,0.6,0,0.8],\"basis\":" + list(24, "99"))};
}

/// Small files may promise large pictures; the program refuses what memory lacks.
void read(const fs::path& file) {
    tools::read_rti(file, [](int width, int height, size_t numbers) {
        if (size_t(width) * size_t(height) * numbers > 10'000'000) throw UserError("too large");
    });
}

Target rti_target(const char* name, const char* file, std::vector<std::string> (*seeds)(const fs::path& folder)) {
    return {name, file, seeds, [file](const fs::path& folder) { read(folder / file); }};
}

}  // namespace

std::vector<Target> rti_targets() {
    return {rti_target("ptm", "a.ptm", ptm_files), rti_target("hsh", "a.rti", hsh_files),
            rti_target("relight", "info.json", info_files)};
}

}  // namespace radiafit::fuzz
