// What stereo reads and writes: points of COLMAP models, depth and normal maps in its stereo folder.
#include <gtest/gtest.h>

#include "capture/colmap.h"
#include "capture/colmap_points.h"
#include "capture_fixture.h"
#include "stereo/stereo_folder.h"
#include "stereo_scene.h"

namespace radiafit {
using namespace tools;
namespace {

using namespace testing;

class ColmapPoints : public FolderTest {
protected:
    void SetUp() override {
        write_bytes(root_ / "text/cameras.txt", "1 PINHOLE 64 48 60 61 32 24\n");
        write_bytes(root_ / "text/images.txt", "9 1 0 0 0 0 0 2 1 b.png\n\n4 1 0 0 0 0 1 2 1 a.png\n\n");
    }
    std::vector<SparsePoint> points(const std::string& text) {
        write_bytes(root_ / "text/points3D.txt", text);
        return read_colmap_points(root_ / "text", read_colmap(root_ / "text"));
    }
};

TEST_F(ColmapPoints, TextAndBinaryAreTheSame) {
    const auto text = points("# comment\n7 0.5 -1 2.25 255 0 9 0.75 9 0 4 3 9 8\n8 1 2 3 0 0 0 1.5 4 1\n");
    ASSERT_EQ(text.size(), 2u);
    EXPECT_EQ(text[0].position, Vec3d(0.5, -1, 2.25));
    EXPECT_EQ(text[0].error, 0.75);
    EXPECT_EQ(text[0].images, (std::vector<uint32_t>{0, 1}));  // by place among the sorted names, each once
    EXPECT_EQ(text[1].images, std::vector<uint32_t>{0});

    Bytes cameras, images, binary;
    cameras.put(uint64_t{1}).put(uint32_t{1}).put(int32_t{1}).put(uint64_t{64}).put(uint64_t{48});
    for (const double p : {60.0, 61.0, 32.0, 24.0}) cameras.put(p);
    images.put(uint64_t{2});
    for (const uint32_t id : {9u, 4u}) {
        images.put(id);
        for (const double p : {1.0, 0.0, 0.0, 0.0, 0.0, id == 4 ? 1.0 : 0.0, 2.0}) images.put(p);
        images.put(uint32_t{1});
        images.text += id == 4 ? "a.png" : "b.png";
        images.put('\0').put(uint64_t{0});
    }
    binary.put(uint64_t{2});
    const auto put_point = [&](uint64_t id, Vec3d at, double error, std::vector<uint32_t> track) {
        binary.put(id).put(at.x()).put(at.y()).put(at.z()).put('\1').put('\2').put('\3').put(error);
        binary.put(uint64_t(track.size()));
        for (const uint32_t image : track) binary.put(image).put(uint32_t{5});
    };
    put_point(7, {0.5, -1, 2.25}, 0.75, {9, 4, 9});
    put_point(8, {1, 2, 3}, 1.5, {4});
    write_bytes(root_ / "bin/cameras.bin", cameras.text);
    write_bytes(root_ / "bin/images.bin", images.text);
    write_bytes(root_ / "bin/points3D.bin", binary.text);
    const auto read = read_colmap_points(root_ / "bin", read_colmap(root_ / "bin"));
    ASSERT_EQ(read.size(), text.size());
    for (size_t i = 0; i < read.size(); ++i) {
        EXPECT_EQ(read[i].position, text[i].position);
        EXPECT_EQ(read[i].error, text[i].error);
        EXPECT_EQ(read[i].images, text[i].images);
    }
    write_bytes(root_ / "bin/points3D.bin", binary.text.substr(0, binary.text.size() - 1));
    expect_in("points3D.bin: truncated",
              complaint([&] { read_colmap_points(root_ / "bin", read_colmap(root_ / "bin")); }));
}

TEST_F(ColmapPoints, WhatIsWrongIsSaid) {
    const auto refused = [&](const std::string& text, const std::string& part) {
        expect_in(part, complaint([&] { points(text); }));
    };
    refused("7 0 0 0 1 1 1 0.5 5 0\n", "points3D.txt:1: a point is seen by image 5, which");
    refused("7 0 0 0 1 1 1 0.5\n", "points3D.txt:1: a point has no track");
    refused("7 0 0 0 1 1 1 0.5 4\n", "points3D.txt:1: expected POINT3D_ID X Y Z R G B ERROR");
    refused("7 0 nan 0 1 1 1 0.5 4 0\n", "points3D.txt:1: a coordinate is 'nan'");
    fs::remove(root_ / "text/points3D.txt");
    expect_in("points3D.txt: no such file",
              complaint([&] { read_colmap_points(root_ / "text", read_colmap(root_ / "text")); }));
}

class StereoFolder : public FolderTest {
protected:
    Camera camera_ = cameras_around(1, 0, 40)[0];
    fs::path depths(const std::string& name) const { return root_ / "depth_maps" / (name + ".geometric.bin"); }
    fs::path normals(const std::string& name) const { return root_ / "normal_maps" / (name + ".geometric.bin"); }
};

TEST_F(StereoFolder, ComesBackAsItWas) {
    const PlaneMap map = planes_of_sphere(camera_);
    write_planes(root_, "sub/a.jpg", map);
    const PlaneMap read = read_planes(root_, "sub/a.jpg", camera_);
    size_t known = 0;
    for (size_t i = 0; i < map.planes.size(); ++i) {
        const Vec3f ray = ray_of(camera_, double(i % 40), double(i / 40));
        if (!(map.planes[i].dot(ray) > 0)) {
            EXPECT_FALSE(read.known(i));
            continue;
        }
        known += read.known(i);
        EXPECT_LT((read.planes[i] - map.planes[i]).norm(), 1e-5f * map.planes[i].norm());
    }
    EXPECT_GT(known, 500u);
}

TEST_F(StereoFolder, IsAsColmapWritesIt) {
    // One pixel of a plane parallel to the image at depth 4: COLMAP's pixel (x, y) is at (x, y), and its normals face
    // us.
    PlaneMap map{camera_, std::vector<InversePlane>(1600, InversePlane::Zero())};
    map.planes[3 * 40 + 7] = {0, 0, 0.25f};
    write_planes(root_, "a.jpg", map);
    const std::string depth = read_bytes(depths("a.jpg")), normal = read_bytes(normals("a.jpg"));
    ASSERT_EQ(depth.size(), 8 + 4 * 1600u);
    EXPECT_EQ(depth.substr(0, 8), "40&40&1&");
    ASSERT_EQ(normal.size(), 8 + 12 * 1600u);
    EXPECT_EQ(normal.substr(0, 8), "40&40&3&");
    const auto number = [](const std::string& bytes, size_t at) {
        float value;
        std::memcpy(&value, bytes.data() + 8 + 4 * at, 4);
        return value;
    };
    EXPECT_EQ(number(depth, 3 * 40 + 7), 4);
    EXPECT_EQ(number(depth, 3 * 40 + 8), 0);
    EXPECT_EQ(number(normal, 2 * 1600 + 3 * 40 + 7), -1);
    EXPECT_EQ(number(normal, 3 * 40 + 7), 0);
    write_fusion_list(root_, {"a.jpg", "sub/b.jpg"});
    EXPECT_EQ(read_bytes(root_ / "fusion.cfg"), "a.jpg\nsub/b.jpg\n");
}

TEST_F(StereoFolder, WhatIsWrongIsSaid) {
    write_planes(root_, "a.jpg", planes_of_sphere(camera_));
    const std::string depth = read_bytes(depths("a.jpg")), normal = read_bytes(normals("a.jpg"));
    const auto refused = [&](const fs::path& file, const std::string& bytes, const std::string& part) {
        write_bytes(depths("a.jpg"), depth);
        write_bytes(normals("a.jpg"), normal);
        write_bytes(file, bytes);
        expect_in(part, complaint([&] { read_planes(root_, "a.jpg", camera_); }));
    };
    const auto patched = [](std::string bytes, size_t at, float value) {
        std::memcpy(bytes.data() + 8 + 4 * at, &value, 4);
        return bytes;
    };
    const size_t middle = 20 * 40 + 20;
    refused(depths("a.jpg"), "", "does not begin with WIDTH&HEIGHT&CHANNELS&");
    refused(depths("a.jpg"), "40&40&1", "does not begin with WIDTH&HEIGHT&CHANNELS&");
    refused(depths("a.jpg"), "99999999999&40&1&", "does not begin with WIDTH&HEIGHT&CHANNELS&");
    refused(depths("a.jpg"), normal, "its size is not 40 x 40 with 1 channels");
    refused(depths("a.jpg"), depth.substr(0, 900), "bytes of values, not 6400");
    refused(depths("a.jpg"), depth + "x", "holds 6401 bytes of values, not 6400");
    refused(depths("a.jpg"), patched(depth, middle, -1), "pixel (20, 20) has depth -1");
    refused(depths("a.jpg"), patched(depth, middle, NAN), "pixel (20, 20) has depth nan");
    refused(normals("a.jpg"), patched(normal, 2 * 1600 + middle, 1), "the normal of pixel (20, 20) is no unit vector");
    refused(normals("a.jpg"), patched(normal, 2 * 1600 + middle, NAN),
            "the normal of pixel (20, 20) is no unit vector");
    EXPECT_EQ(complaint([&] { read_planes(root_, "b.jpg", camera_); }).find(depths("b.jpg").string()), 0u);
    for (const char* name : {"../a.jpg", "/a.jpg", "sub/../../a.jpg"})
        expect_in("leads out of the output folder",
                  complaint([&] { write_planes(root_, name, planes_of_sphere(camera_)); }));
}

}  // namespace
}  // namespace radiafit
