// What `import lights` refuses, and says of it.
#include <sys/stat.h>

#include "lights_fixture.h"

namespace radiafit {
using namespace tools;
namespace {

using namespace testing;

TEST_F(LightsTest, CountsMustAgree) {
    write_sphere();
    fs::remove(options_.images / name(9));
    std::string text = refused();
    expect_in("lights.txt: 10 lights, but", text);
    expect_in("holds 9 images", text);
    expect_in("one line per image", text);
    write_sphere();
    write_bytes(options_.intensities, "1\n2\n");
    expect_in("intensities.txt: 2 intensities, but there are 10 images", refused());
    fs::remove_all(options_.images);
    expect_in("images: no such folder", refused());
    fs::create_directories(options_.images);
    expect_in("images: no images here", refused());
}

TEST_F(LightsTest, LightsMustPointSomewhere) {
    write_sphere();
    const std::string lights = read_bytes(options_.lights);
    write_bytes(options_.lights, "0 0 0\n" + lights);
    expect_in("lights.txt:1: the light's vector (0, 0, 0) has length 0", refused());
    write_bytes(options_.lights, "1 2\n" + lights);
    expect_in("lights.txt:1: a light takes three numbers, here are 2", refused());
    write_bytes(options_.lights, lights);
    for (const char* bad : {"0 0 0\n", "0\n", "1 -1 1\n"}) {
        write_bytes(options_.intensities, bad);
        expect_in("intensities.txt:1: the light's intensity is ", refused());
    }
    options_.lights.clear();
    expect_in("'light_positions'", refused());
}

TEST_F(LightsTest, ImagesMustBeAlike) {
    write_sphere();
    write_bytes(options_.images / name(4), encode_png(width, height, 3, 8, std::vector<uint16_t>(3 * pixels, 9)));
    expect_in("04.png: has 8-bit channels, but", refused());
    write_bytes(options_.images / name(4), encode_png(height, width, 3, 16, std::vector<uint16_t>(3 * pixels, 9)));
    expect_in("04.png: 20 x 24 pixels, but", refused());
    for (int i = 0; i < count; ++i)
        write_bytes(options_.images / name(i), encode_png(width, height, 3, 8, std::vector<uint16_t>(3 * pixels, 9)));
    options_.depth = 16;
    const std::string text = refused();
    expect_in("00.png: has 8-bit channels, but 'depth' 16 was declared", text);
    expect_in("export the image again", text);
    options_.depth = 0;
    options_.transfer = "gamma";
    expect_in("'transfer' gamma", refused());
}

TEST_F(LightsTest, NoImageIsPackedTwice) {
    write_sphere();
    options_.lights = root_ / "dome.lp";
    options_.intensities.clear();
    // Neither folder exists: both lines would mean the same file.
    write_bytes(options_.lights, "2\na/00.png 0 0 1\nb/00.png 0 1 1\n");
    expect_in("dome.lp: 'b/00.png' means", refused());
    write_bytes(options_.lights, "2\n00.png 0 0 1\n./00.png 0 1 1\n");
    expect_in("dome.lp: './00.png' means", refused());
}

TEST_F(LightsTest, PipesAndLoopsAreRefused) {
    write_sphere();
    for (fs::path* input : {&options_.lights, &options_.intensities, &options_.mask, &options_.normals}) {
        const fs::path whole = *input;
        ASSERT_EQ(mkfifo((*input = root_ / "pipe").c_str(), 0600), 0);
        expect_in("pipe: cannot read this", refused());
        fs::remove(*input);
        fs::create_symlink("pipe", *input);
        expect_in("pipe: cannot read this", refused());
        fs::remove(*input);
        *input = whole;
    }
    fs::remove(options_.images / name(3));
    ASSERT_EQ(mkfifo((options_.images / name(3)).c_str(), 0600), 0);
    expect_in("10 lights, but", refused());  // a pipe is no image of the folder
    options_.images = root_ / std::string(300, 'x');
    expect_in("no such folder", refused());
}

TEST_F(LightsTest, NormalsAndMaskMustFit) {
    write_sphere();
    const fs::path normals = options_.normals, mask = options_.mask;
    write_bytes(normals, encode_pfm(height, width, std::vector<float>(3 * pixels, 1)));
    std::string text = refused();
    expect_in("normals.pfm: normals for 20 x 24 pixels, but the images have 24 x 20", text);
    expect_in("at their size", text);
    const std::string whole = encode_pfm(width, height, std::vector<float>(3 * pixels, 1));
    write_bytes(normals, whole.substr(0, whole.size() - 12));
    expect_in("normals.pfm: truncated or corrupt image (the file ends within the picture)", refused());
    std::vector<float> broken(3 * pixels, 0.57f);
    broken[3 * (5 * width + 2) + 2] = nan_value;
    write_bytes(normals, encode_pfm(width, height, broken));
    expect_in("normals.pfm: the normal at column 2, row 5 is not finite", refused());
    write_bytes(normals, encode_pfm(width, height, std::vector<float>(3 * pixels, 0)));
    expect_in("normals.pfm: no pixel has a normal", refused());
    write_shape();
    write_bytes(mask, encode_png(height, width, 1, 8, std::vector<uint16_t>(pixels, 255)));
    expect_in("mask.png: 20 x 24 pixels, but the images have 24 x 20", refused());
    write_bytes(mask, encode_png(width, height, 1, 8, std::vector<uint16_t>(pixels, 0)));
    expect_in("mask.png: the mask is black throughout", refused());
    // Not wrong, but worth a word: a hole in the scan, and a flipped axis.
    options_.mask.clear();
    import();
    ASSERT_EQ(report_.notes.size(), 2u);
    expect_in("pixels have no normal", report_.notes[0]);
    options_.mask = mask;
    for (Vec3f& n : normals_) n.z() = -n.z();
    write_shape();
    import();
    ASSERT_EQ(report_.notes.size(), 2u);
    expect_in("face away", report_.notes[0]);
}

}  // namespace
}  // namespace radiafit
