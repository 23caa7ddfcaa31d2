// What is noticed of files that changed after they were written, and how datasets without checksums are read.
#include <fcntl.h>

#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "dataset/checksums.h"
#include "dataset/image_stream.h"
#include "dataset/mesh_ply.h"
#include "dataset_fixture.h"

namespace radiafit {
namespace {

using Json = nlohmann::ordered_json;

class ChecksumTest : public DatasetTest {
protected:
    void write(Encoding encoding) { write_random(folder_, encoding, {{16, 9, true, 1}, {7, 5, false, 1}}); }
    void flip(const std::string& name, size_t byte, int bit) {
        std::string bytes = read_text(folder_ / name);
        bytes[byte] = char(bytes[byte] ^ (1 << bit));
        write_text(folder_ / name, bytes);
    }
    void edit_json(const std::function<void(Json&)>& edit) {
        Json json = Json::parse(read_text(folder_ / "dataset.json"));
        edit(json);
        write_text(folder_ / "dataset.json", json.dump());
    }
    /// As versions before 4 wrote it.
    void make_older(int version) {
        edit_json([&](Json& json) {
            json["version"] = version;
            json.erase("checksums");
            for (Json& view : json["views"]) view.erase("checksum");
        });
    }
    void put_float(size_t channel, float value) {
        std::string bytes = read_text(folder_ / "images.bin");
        std::memcpy(bytes.data() + 4 * channel, &value, 4);
        write_text(folder_ / "images.bin", bytes);
    }
    std::string check_complaint() {
        return complaint([&] { check_pixels(open_dataset(folder_)); });
    }

    fs::path folder_ = root_ / "set";
};

TEST_F(ChecksumTest, EveryBitOfImagesIsChecked) {
    write(Encoding::u8_srgb);
    const Dataset dataset = open_dataset(folder_);
    EXPECT_NO_THROW(check_pixels(dataset));
    const size_t mask = *dataset.views[0].mask_offset, second = dataset.views[1].pixel_offset;
    for (const size_t byte : {size_t(0), size_t(431), mask, mask + 17, second - 1, second, second + 4095})
        for (const int bit : {0, 7}) {
            flip("images.bin", byte, bit);
            const std::string text = check_complaint();
            expect_in("images.bin", text);
            expect_in(byte < second ? "view \"view \"0\"\"" : "view \"view \"1\"\"", text);
            flip("images.bin", byte, bit);
        }
    EXPECT_NO_THROW(check_pixels(dataset));
}

TEST_F(ChecksumTest, StreamsNoticeAChangedImageWhenTheyReadIt) {
    write(Encoding::u16_linear);
    const Dataset dataset = open_dataset(folder_);
    flip("images.bin", dataset.views[1].pixel_offset + 3, 2);
    for (const StreamSource source : {StreamSource::disk, StreamSource::disk_cold, StreamSource::memory}) {
        ImageStream stream(dataset, source), another = stream.another();
        TargetImage image;
        std::vector<float> values;
        stream.load(0, image);
        expect_in("view \"view \"1\"\"", complaint([&] { stream.load(1, image); }));
        expect_in("view \"view \"1\"\"", complaint([&] { stream.load_values(1, values); }));
        expect_in("view \"view \"1\"\"", complaint([&] { another.load_mask(1, image); }));
    }
}

/// Each is opened as a whole, though its folder is exchanged for the other while it is read.
TEST_F(ChecksumTest, DatasetsThatAreExchangedAreNotMixed) {
    write(Encoding::u8_srgb);
    const fs::path other = root_ / "other";
    write_random(other, Encoding::u16_linear, {{11, 8, false, 1}});
    std::jthread writer([&](std::stop_token stop) {
        while (!stop.stop_requested()) {
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
            renameat2(AT_FDCWD, folder_.c_str(), AT_FDCWD, other.c_str(), RENAME_EXCHANGE);
        }
    });
    std::set<Encoding> seen;
    for (const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(1);
         std::chrono::steady_clock::now() < end;) {
        const Dataset dataset = open_dataset(folder_);
        EXPECT_EQ(dataset.views.size(), dataset.encoding == Encoding::u8_srgb ? 2u : 1u);
        seen.insert(dataset.encoding);
    }
    EXPECT_EQ(seen.size(), 2u);
}

TEST_F(ChecksumTest, OtherFilesAreCheckedToo) {
    write(Encoding::u8_srgb);
    Mesh mesh = tetrahedron();
    mesh.positions[0].x() += 1e-3f;
    write_ply(mesh, folder_ / "mesh.ply");
    expect_in("mesh.ply: the file is not as it was written", complaint([&] { open_dataset(folder_); }));
}

TEST_F(ChecksumTest, OlderVersionsAreReadAsBefore) {
    for (const int version : {1, 2, 3}) {
        write(Encoding::u8_srgb);
        make_older(version);
        const Dataset dataset = open_dataset(folder_);
        EXPECT_TRUE(dataset.checksums.empty());
        EXPECT_NO_THROW(check_pixels(dataset));
        flip("images.bin", 5, 1);  // nothing tells
        EXPECT_NO_THROW(check_pixels(dataset));
    }
}

TEST_F(ChecksumTest, FloatsWithoutChecksumsAreFiniteAndUpToTheirPeak) {
    write(Encoding::f32_linear);
    make_older(2);
    const Dataset dataset = open_dataset(folder_);
    EXPECT_NO_THROW(check_pixels(dataset));
    const auto streams = [&] {
        ImageStream stream(dataset, StreamSource::disk);
        std::vector<float> values;
        stream.load_values(0, values);
    };
    for (const float value : {std::nanf(""), INFINITY, 1e6f}) {
        put_float(10, value);
        expect_in("channel 1 of pixel 3", check_complaint());
        expect_in("channel 1 of pixel 3", complaint(streams));
    }
    put_float(10, -1e6f);  // fitted as 0
    EXPECT_NO_THROW(streams());
}

TEST_F(ChecksumTest, ViewsHavePlacesOfTheirOwn) {
    write(Encoding::u8_srgb);
    make_older(1);
    edit_json([](Json& json) { json["views"][1]["pixel_offset"] = 0; });
    expect_in("the image of view \"view \"1\"\" overlaps", complaint([&] { open_dataset(folder_); }));
    write(Encoding::u8_srgb);
    edit_json([](Json& json) { json["views"][0]["mask_offset"] = 440; });
    expect_in("starts at byte 440, but its pixels end at 432", complaint([&] { open_dataset(folder_); }));
}

TEST_F(ChecksumTest, IntegersHaveAPeakOf1) {
    write(Encoding::u8_srgb);
    edit_json([](Json& json) { json["views"][1]["peak"] = 100; });
    expect_in("\"views[1].peak\" is 100", complaint([&] { open_dataset(folder_); }));
}

}  // namespace
}  // namespace radiafit
