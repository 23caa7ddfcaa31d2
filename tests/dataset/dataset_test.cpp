// Packed datasets: what is written comes back, in every encoding, and the writer keeps what stands there until it is
// done.
#include "dataset/dataset.h"

#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <csignal>
#include <cstring>
#include <limits>

#include "dataset/checksums.h"
#include "dataset/image_stream.h"
#include "dataset_fixture.h"

namespace radiafit {
namespace {

double reference_decode(double x) { return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4); }
double reference_encode(double x) { return x <= 0.0031308 ? x * 12.92 : 1.055 * std::pow(x, 1 / 2.4) - 0.055; }

/// The target by the words of image_stream.h, in double.
double reference_target(Encoding encoding, TargetSpace space, double gain, double stored) {
    if (encoding != Encoding::u8_srgb) return gain * stored;
    const double light = gain * reference_decode(stored);
    return space == TargetSpace::linear ? light : reference_encode(light);
}

struct EncodingCase {
    Encoding encoding;
    TargetSpace space;
    StreamSource source;
    Gain gain;  ///< of some views
};

class EncodingTest : public DatasetTest, public ::testing::WithParamInterface<EncodingCase> {};

TEST_P(EncodingTest, RoundTrip) {
    const auto [encoding, space, source, gain] = GetParam();
    const bool gains = gain != 1;
    // Widths around the mask's bytes, the vector width and a page; with and without a mask; taller and wider.
    const std::vector<Shape> shapes = {
        {1, 1, true, 1}, {7, 90, true, gain}, {8, 61, false, gains ? 0.6 : 1}, {13, 41, true, gain}, {641, 3, true, 1}};
    const fs::path folder = root_ / "set";
    const Truth truth = write_random(folder, encoding, shapes);
    const Dataset dataset = open_dataset(folder);
    EXPECT_EQ(dataset.name, truth.header.name);
    EXPECT_EQ(dataset.description, truth.header.description);
    EXPECT_EQ(dataset.source, truth.header.source);
    EXPECT_EQ(dataset.encoding, encoding);
    EXPECT_EQ(dataset.mesh.positions, truth.header.mesh.positions);
    EXPECT_EQ(dataset.mesh.triangles, truth.header.mesh.triangles);
    EXPECT_EQ(dataset.split(true), (std::vector<uint32_t>{1, 3}));
    EXPECT_EQ(dataset.split(false), (std::vector<uint32_t>{0, 2, 4}));
    ASSERT_EQ(dataset.views.size(), shapes.size());
    uint64_t raw_bytes = 0;
    for (const Shape& s : shapes) raw_bytes += uint64_t(s.width * s.height * 3 * bytes_per_channel(encoding));
    EXPECT_EQ(dataset.image_bytes(), raw_bytes);

    ImageStream first(dataset, source, space);
    ImageStream second = first.another();
    const bool as_bytes =
        !gains && (encoding == Encoding::u8_linear || (encoding == Encoding::u8_srgb && space == TargetSpace::stored));
    EXPECT_EQ(first.bits(), as_bytes ? 8 : 16);
    double largest = 0;
    for (size_t i = 0; i < shapes.size(); ++i)
        for (const double v : truth.stored[i])
            largest = std::max(largest, reference_target(encoding, space, shapes[i].gain.most(), v));
    // Integer encodings reserve room for their full range; random halves and floats are measured.
    const double full = reference_target(encoding, space, std::max(1.0, gain.most()), 1);
    const bool measured = encoding == Encoding::f16_linear || encoding == Encoding::f32_linear;
    const double scale = as_bytes ? 1 / 255.0 : (measured ? largest : full) / 65535;
    EXPECT_NEAR(first.scale(), scale, scale * 1e-6);  // float against double

    TargetImage image;
    for (ImageStream* stream : {&first, &second, &first})  // a reused buffer must not remember the last image
        for (uint32_t i = 0; i < shapes.size(); ++i) {
            stream->load(i, image);
            ASSERT_EQ(image.width, shapes[i].width);
            ASSERT_EQ(image.height, shapes[i].height);
            const size_t pixels = size_t(image.width) * size_t(image.height);
            ASSERT_EQ(as_bytes ? image.rgba8.size() : image.rgba16.size(), 4 * pixels);
            EXPECT_EQ(as_bytes ? image.rgba16.size() : image.rgba8.size(), 0u);
            const double unit = double(image.scale16());
            for (size_t p = 0; p < pixels; ++p) {
                const auto rgba = image.channel16(p);
                for (size_t c = 0; c < 3; ++c) {
                    const double target =
                        std::max(0.0, reference_target(encoding, space, shapes[i].gain[c], truth.stored[i][3 * p + c]));
                    // Bytes are exact (to the float scale); 16 bits round to nearest, in float arithmetic.
                    const double tolerance = as_bytes ? 1e-6 : 0.52 * unit;
                    ASSERT_NEAR(rgba[c] * unit, target, tolerance)
                        << "view " << i << " pixel " << p << " channel " << c;
                }
                const bool inside = truth.masks[i].empty() || truth.masks[i][p] != 0;
                ASSERT_EQ(rgba[3], inside ? 65535 : 0) << "view " << i << " pixel " << p;
                ASSERT_EQ(image.masked_in(p), inside);
            }
        }
    std::vector<float> values, some;
    ImageStream exact(dataset, source, space);
    TargetImage whole, mask;
    EXPECT_THROW(exact.values_at({}, nullptr), std::logic_error);
    for (uint32_t i = 0; i < shapes.size(); ++i) {
        exact.load_values(i, values);
        ASSERT_EQ(values.size(), truth.stored[i].size());
        for (size_t k = 0; k < values.size(); ++k) {
            const double target = reference_target(encoding, space, shapes[i].gain[k % 3], truth.stored[i][k]);
            ASSERT_NEAR(values[k], target, 2e-7 * (1 + std::abs(target)));  // rounded to float once
        }
        // row by row: the same bytes
        exact.load(i, whole);
        const auto* bytes = as_bytes ? whole.rgba8.data() : reinterpret_cast<const uint8_t*>(whole.rgba16.data());
        const size_t row_bytes = size_t(whole.width) * size_t(exact.bits() / 2);
        for (const bool by_all_threads : {false, true}) {
            std::vector<std::atomic<int>> came(size_t(whole.height));
            exact.load_rows(i, by_all_threads, [&](int y, const uint8_t* row, int) {
                ASSERT_EQ(0, std::memcmp(row, bytes + size_t(y) * row_bytes, row_bytes))
                    << "view " << i << " row " << y;
                ASSERT_TRUE(y % (by_all_threads ? ImageStream::band_rows : whole.height) == 0 || came[size_t(y - 1)])
                    << "rows come in order, or those of a band";
                ++came[size_t(y)];
            });
            ASSERT_TRUE(std::ranges::all_of(came, [](int times) { return times == 1; }));
        }
        // single pixels, backwards: the same bits, and the same mask
        exact.load_mask(i, mask);
        const auto count = uint32_t(values.size() / 3);
        std::vector<uint32_t> pixels;
        for (uint32_t p = count; p-- > 0;) pixels.push_back(p);
        some.assign(values.size(), -1);
        ImageStream copy = exact.another();
        copy.values_at(pixels, some.data());
        ASSERT_EQ(mask.bits, 8);
        for (uint32_t p = 0; p < count; ++p) {
            ASSERT_EQ(mask.masked_in(p), whole.masked_in(p)) << "view " << i << " pixel " << p;
            ASSERT_EQ(0, std::memcmp(&values[3 * p], &some[3 * (count - 1 - p)], 3 * sizeof(float)));
        }
    }
    EXPECT_GT(first.seconds(), 0);
    if (source == StreamSource::disk) {
        uint64_t masks = 0, blocks = 0;  // the first time, an image comes with all that its checksum is of
        for (const Shape& s : shapes) masks += s.mask ? uint64_t((s.width + 7) / 8 * s.height) : 0;
        for (const View& view : dataset.views) blocks += image_block_bytes(view, encoding);
        EXPECT_EQ(first.bytes_read(), (blocks + masks) + (raw_bytes + masks));
    }
}

std::vector<EncodingCase> all_cases() {
    std::vector<EncodingCase> cases;
    for (const Encoding e :
         {Encoding::u8_srgb, Encoding::u8_linear, Encoding::u16_linear, Encoding::f16_linear, Encoding::f32_linear})
        for (const TargetSpace space : {TargetSpace::stored, TargetSpace::linear})
            for (const StreamSource source : {StreamSource::disk, StreamSource::memory})
                for (const Gain& gain : {Gain(1), Gain(1.7), Gain({0.9, 0.6, 1.7})})
                    cases.push_back({e, space, source, gain});
    return cases;
}

INSTANTIATE_TEST_SUITE_P(All, EncodingTest, ::testing::ValuesIn(all_cases()), [](const auto& info) {
    const EncodingCase& c = info.param;
    std::string name = to_string(c.encoding) + (c.space == TargetSpace::linear ? "_linear" : "_stored") +
                       (c.source == StreamSource::disk ? "_disk" : "_memory") +
                       (c.gain == 1        ? ""
                        : c.gain.uniform() ? "_gains"
                                           : "_channel_gains");
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
});

TEST_F(DatasetTest, CamerasAndInformationSurviveExactly) {
    const Truth truth =
        write_random(root_ / "set", Encoding::u8_srgb, {{9, 4, true, Gain({1.1, 0.3, 1})}, {5, 6, false, 1}});
    const Dataset dataset = open_dataset(root_ / "set");
    for (size_t i = 0; i < truth.header.views.size(); ++i) {
        const View& read = dataset.views[i];
        const View& written = truth.header.views[i];
        EXPECT_EQ(read.name, written.name);
        EXPECT_EQ(read.gain, written.gain);
        EXPECT_EQ(read.crop_origin, written.crop_origin);
        EXPECT_EQ(read.full_size, written.full_size);
        EXPECT_EQ(read.camera.fx, written.camera.fx);
        EXPECT_EQ(read.camera.fy, written.camera.fy);
        EXPECT_EQ(read.camera.cx, written.camera.cx);
        EXPECT_EQ(read.camera.cy, written.camera.cy);
        EXPECT_EQ(read.camera.cam_from_world_rotation, written.camera.cam_from_world_rotation);
        EXPECT_EQ(read.camera.cam_from_world_translation, written.camera.cam_from_world_translation);
        EXPECT_EQ(read.pixel_offset % 4096, 0u);
    }
}

TEST(Transfer, MatchesTheStandardAndInverts) {
    // IEC 61966-2-1: the two branches meet, and mid-grey 0.5 is 0.2140 linear.
    EXPECT_NEAR(srgb_decode(0.5), 0.21404, 1e-5);
    EXPECT_NEAR(srgb_decode(0.04045), srgb_decode(0.04045 + 1e-9), 1e-6);
    for (double x = -1.5; x <= 2; x += 0.01) EXPECT_NEAR(srgb_decode(srgb_encode(x)), x, 1e-7) << x;
    EXPECT_EQ(srgb_encode(-0.3), -srgb_encode(0.3));
}

// --- the writer ----------------------------------------------------------------------------------------------------

View small_view() {
    View view;
    view.name = "one";
    view.camera = Camera::look_at({0, -3, 0}, {0, 0, 0}, {0, 0, 1}, 0.6, 4, 4);
    return view;
}

void add_one(DatasetWriter& writer, uint8_t value) {
    writer.add(small_view(), std::vector<uint8_t>(48, value).data(), {});
}

Dataset header_named(const std::string& name) {
    Dataset header;
    header.name = name;
    header.mesh = tetrahedron();
    return header;
}

TEST_F(DatasetTest, AnUnfinishedWriterLeavesNothing) {
    {
        DatasetWriter writer(root_ / "set");
        add_one(writer, 1);
        EXPECT_FALSE(fs::exists(root_ / "set"));
    }
    EXPECT_EQ(entries(), 0u);
}

TEST_F(DatasetTest, ReplacingKeepsTheOldSetUntilTheNewOneIsWhole) {
    const fs::path folder = root_ / "set";
    {
        DatasetWriter writer(folder);
        add_one(writer, 1);
        writer.finish(header_named("old"));
    }
    {
        DatasetWriter writer(folder);
        add_one(writer, 2);
        EXPECT_EQ(open_dataset(folder).name, "old");
    }
    EXPECT_EQ(open_dataset(folder).name, "old");
    {
        DatasetWriter writer(folder);
        add_one(writer, 2);
        Dataset header = header_named("new");
        header.mesh.triangles.clear();
        EXPECT_THROW(writer.finish(header), UserError);
    }
    EXPECT_EQ(open_dataset(folder).name, "old");
    EXPECT_EQ(entries(), 1u);

    fs::create_directory_symlink(folder, root_ / "link");
    {
        DatasetWriter writer(root_ / "link" / "");
        add_one(writer, 2);
        writer.finish(header_named("new"));
    }
    EXPECT_TRUE(fs::is_symlink(root_ / "link"));
    EXPECT_EQ(open_dataset(folder).name, "new");
    EXPECT_EQ(entries(), 2u);

    write_text(folder / "dataset.json", "{ damaged");  // the advice of open_dataset must work
    DatasetWriter writer(folder);
    add_one(writer, 3);
    writer.finish(header_named("newer"));
    EXPECT_EQ(open_dataset(folder).name, "newer");
}

TEST_F(DatasetTest, WhatIsNoDatasetIsNeverReplaced) {
    const fs::path folder = root_ / "photographs";
    fs::create_directories(folder);
    { DatasetWriter accepts_an_empty_folder(folder); }
    EXPECT_TRUE(fs::exists(folder));
    write_text(folder / "images.bin", "precious");
    expect_in("choose another name", complaint([&] { DatasetWriter writer(folder); }));
    write_text(folder / "dataset.json", "{}");
    write_text(folder / "notes.txt", "precious");
    expect_in("notes.txt", complaint([&] { DatasetWriter writer(folder); }));
    expect_in("a file", complaint([&] { DatasetWriter writer(folder / "notes.txt"); }));
    EXPECT_EQ(read_text(folder / "notes.txt"), "precious");
    EXPECT_EQ(entries(), 1u);
}

TEST_F(DatasetTest, UnwritableOutputIsOneLine) {
    write_text(root_ / "file", "");
    expect_in("cannot write", complaint([&] { DatasetWriter writer(root_ / "file" / "set"); }));
    if (geteuid() != 0) {  // root may write anywhere
        fs::permissions(root_, fs::perms::owner_read | fs::perms::owner_exec);
        expect_in("writable", complaint([&] { DatasetWriter writer(root_ / "set"); }));
    }
}

TEST_F(DatasetTest, AFullDiskIsOneLine) {
    // A limit on the file size is the full disk that a test can make: write() fails half-way.
    rlimit old_limit{};
    getrlimit(RLIMIT_FSIZE, &old_limit);
    const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
    rlimit limit = old_limit;
    limit.rlim_cur = 10000;
    setrlimit(RLIMIT_FSIZE, &limit);
    const std::string text = complaint([&] {
        DatasetWriter writer(root_ / "set");
        for (int i = 0; i < 5; ++i) add_one(writer, 1);
        writer.finish(header_named("full"));
    });
    setrlimit(RLIMIT_FSIZE, &old_limit);
    std::signal(SIGXFSZ, old_handler);
    expect_in("cannot write " + (root_ / "set" / "images.bin").string() + ": ", text);
    expect_in("make room", text);
    EXPECT_EQ(entries(), 0u);
}

TEST_F(DatasetTest, WriterRefusesWhatCannotBeFitted) {
    DatasetWriter writer(root_ / "set");
    EXPECT_THROW(writer.finish(header_named("empty")), UserError);
    View view = small_view();
    view.camera.cx = std::numeric_limits<double>::quiet_NaN();
    const std::vector<uint8_t> pixels(48);
    expect_in("one", complaint([&] { writer.add(view, pixels.data(), {}); }));
    view = small_view();
    for (const Gain& gain : {Gain(-1), Gain({1, 1e13, 1})}) {
        view.gain = gain;
        expect_in("gain", complaint([&] { writer.add(view, pixels.data(), {}); }));
    }
    view.gain = Gain({1, 1, 1.1});
    view.light = Light();
    expect_in("light's intensity", complaint([&] { writer.add(view, pixels.data(), {}); }));
    writer.set_encoding(Encoding::f16_linear);
    std::vector<uint16_t> halves(48, 0);
    halves[5] = 0x7c00;  // infinity
    expect_in("channel 2 of pixel 1", complaint([&] { writer.add(small_view(), halves.data(), {}); }));
    EXPECT_THROW(writer.add(small_view(), pixels.data(), std::vector<uint8_t>(3)), std::logic_error);
    writer.add(small_view(), std::vector<uint16_t>(48).data(), {});
    EXPECT_THROW(writer.set_encoding(Encoding::u8_srgb), std::logic_error);
}

}  // namespace
}  // namespace radiafit
