// What meshes are made of: polygons of any form, strips, STL, glTF, and where they are placed.
#include <fmt/format.h>

#include <cmath>

#include "capture/mesh_file.h"
#include "capture_fixture.h"

namespace radiafit {
using namespace tools;
namespace {

using namespace testing;
using MeshShapes = testing::FolderTest;

double area(const Mesh& mesh) {
    double sum = 0;
    for (const auto& t : mesh.triangles) {
        const Vec3d a = mesh.positions[t[0]].cast<double>(), b = mesh.positions[t[1]].cast<double>(),
                    c = mesh.positions[t[2]].cast<double>();
        sum += (b - a).cross(Vec3d(c - a)).norm() / 2;
    }
    return sum;
}

TEST_F(MeshShapes, PolygonsAreCutInTheirPlane) {
    const auto expect_area = [&](const std::vector<Vec3d>& corners, double wanted, size_t notes) {
        const auto n = corners.size();
        for (size_t first = 0; first < n; ++first)
            for (const bool ply : {false, true}) {
                std::string vertices, face;
                for (const Vec3d& p : corners)
                    vertices += fmt::format("{}{} {} {}\n", ply ? "" : "v ", p.x(), p.y(), p.z());
                for (size_t k = 0; k < n; ++k) face += fmt::format(" {}", (first + k) % n + (ply ? 0 : 1));
                write_bytes(root_ / "x.obj", vertices + "f" + face + "\n");
                write_bytes(
                    root_ / "x.ply",
                    fmt::format("ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\n"
                                "property double z\nelement face 1\nproperty list int int vertex_index\n"
                                "end_header\n{}{}{}\n",
                                n, vertices, n, face));
                const MeshFile file = read_mesh_file(root_ / (ply ? "x.ply" : "x.obj"));
                EXPECT_NEAR(area(file.mesh), wanted, 1e-5 * wanted) << "from corner " << first;
                EXPECT_EQ(file.mesh.triangle_count(), n - 2);
                size_t unsound = 0;
                for (const std::string& note : file.notes) unsound += note.find("cross themselves") != note.npos;
                EXPECT_EQ(unsound, notes);
            }
    };
    expect_area({{0, 0, 0}, {4, 0, 0}, {1, 1, 0}, {0, 4, 0}}, 4, 0);  // an arrowhead
    expect_area({{3, 0, 0}, {1, 1, 1}, {0, 3, 3}, {-1, 1, 1}, {-3, 0, 0}, {-1, -1, -1}, {0, -3, -3}, {1, -1, -1}},
                12 * std::sqrt(2), 0);  // a star of four points
    // A comb, in a tilted plane: twelve corners; its teeth turn inward four times.
    std::vector<Vec3d> comb = {{0, 0, 0}, {5, 0, 0}};
    for (int tooth = 2; tooth >= 0; --tooth) {
        comb.emplace_back(2 * tooth + 1, 3, 6);
        comb.emplace_back(2 * tooth, 3, 6);
        if (tooth > 0) comb.emplace_back(2 * tooth, 1, 2), comb.emplace_back(2 * tooth - 1, 1, 2);
    }
    expect_area(comb, (5 * 1 + 3 * 2) * std::sqrt(5), 0);
    // A square of 4 with a hole of 2, joined by an edge to and fro.
    expect_area(
        {{0, 0, 1}, {4, 0, 1}, {4, 4, 1}, {0, 4, 1}, {0, 0, 1}, {1, 1, 1}, {1, 3, 1}, {3, 3, 1}, {3, 1, 1}, {1, 1, 1}},
        12, 0);
    // Collinear and repeated corners of a T.
    expect_area({{0, 2, 0},
                 {1, 2, 0},
                 {1, 1, 0},
                 {1, 0, 0},
                 {2, 0, 0},
                 {2, 2, 0},
                 {3, 2, 0},
                 {3, 3, 0},
                 {1, 3, 0},
                 {0, 3, 0},
                 {0, 3, 0}},
                5, 0);
}

TEST_F(MeshShapes, CrossingPolygonsAreCounted) {
    write_bytes(root_ / "x.obj", "v 0 0 0\nv 4 0 0\nv 4 1 0\nv 0 4 0\nf 1 3 2 4\nv 0 0 9\nv 1 0 9\nv 0 1 9\nf 5 6 7\n");
    const MeshFile file = read_mesh_file(root_ / "x.obj");
    ASSERT_FALSE(file.notes.empty());
    expect_in("1 polygons that cross themselves", file.notes[0]);
}

TEST_F(MeshShapes, StripsOfPly) {
    // Two strips: a band of four triangles, and one that starts anew with the first order of corners.
    const std::string vertices = "0 0 0\n0 1 0\n1 0 0\n1 1 0\n2 0 0\n2 1 0\n";
    const auto file = [&](const std::string& strips) {
        return "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n"
               "element tristrips 1\nproperty list int int vertex_indices\nend_header\n" +
               vertices + strips;
    };
    write_bytes(root_ / "x.ply", file("10 0 2 1 3 -1 3 2 5 4 -1\n"));
    const MeshFile read = read_mesh_file(root_ / "x.ply");
    const std::vector<std::array<uint32_t, 3>> wanted = {{0, 2, 1}, {1, 2, 3}, {3, 2, 5}, {5, 2, 4}};
    EXPECT_EQ(read.mesh.triangle_count(), 4u);
    EXPECT_NEAR(area(read.mesh), 2, 1e-6);
    EXPECT_EQ(read.mesh.triangles[0], wanted[0]);
    write_bytes(root_ / "x.ply", file("7 0 2 1 3 3 5 4\n"));  // a corner twice joins strips
    EXPECT_NEAR(area(read_mesh_file(root_ / "x.ply").mesh), 1.5, 1e-6);
    write_bytes(root_ / "x.ply", file("4 0 2 1 6\n"));
    expect_in("refers to vertex 6", complaint([&] { read_mesh_file(root_ / "x.ply"); }));
    write_bytes(root_ / "x.ply", file("4 0 2 1 -2\n"));
    expect_in("refers to vertex -2", complaint([&] { read_mesh_file(root_ / "x.ply"); }));
}

TEST_F(MeshShapes, CommentsBehindObjStatements) {
    write_bytes(root_ / "x.obj",
                "# C:\\models\\\nv 0 0 0 # origin\nv 1 0 0#east\nv 0 1 \\\n 0 # north\nf 1 2 3 # tri\nf 3 2 1#back");
    EXPECT_EQ(read_mesh_file(root_ / "x.obj").mesh.triangle_count(), 2u);
}

std::string binary_stl(const std::vector<std::array<Vec3f, 3>>& triangles, const char* header = "solid x") {
    Bytes bytes;
    bytes.text = header;
    bytes.text.resize(80, ' ');
    bytes.put(uint32_t(triangles.size()));
    for (const auto& t : triangles) {
        for (int k = 0; k < 3; ++k) bytes.put(0.0f);
        for (const Vec3f& p : t)
            for (int k = 0; k < 3; ++k) bytes.put(p[k]);
        bytes.put(uint16_t(0));
    }
    return bytes.text;
}

TEST_F(MeshShapes, Stl) {
    const std::vector<std::array<Vec3f, 3>> square = {{Vec3f(0, 0, 0), Vec3f(2, 0, 0), Vec3f(2, 2, 0)},
                                                      {Vec3f(0, 0, 0), Vec3f(2, 2, 0), Vec3f(0, 2, 0)}};
    std::string text = "solid a name\n";
    for (const auto& t : square) {
        text += " facet normal 0 0 1\n  outer loop\n";
        for (const Vec3f& p : t) text += fmt::format("   vertex {} {} {}\n", p.x(), p.y(), p.z());
        text += "  endloop\n endfacet\n";
    }
    for (const std::string& content : {binary_stl(square), binary_stl(square, "by hand"), text + "endsolid a name\n"}) {
        write_bytes(root_ / "x.stl", content);
        const MeshFile file = read_mesh_file(root_ / "x.stl");
        EXPECT_EQ(file.mesh.vertex_count(), 4u);
        EXPECT_NEAR(area(file.mesh), 4, 1e-9);
        ASSERT_EQ(file.remarks.size(), 1u);
        expect_in("no unit", file.remarks[0]);
        for (size_t bytes = 1; bytes + 16 < content.size(); ++bytes) {
            write_bytes(root_ / "x.stl", content.substr(0, bytes));
            EXPECT_NE(complaint([&] { read_mesh_file(root_ / "x.stl"); }), "") << bytes;
        }
    }
    auto broken = square;
    broken[1][2].y() = std::nanf("");
    write_bytes(root_ / "x.stl", binary_stl(broken));
    expect_in("triangle 1 of 2: a position is not finite", complaint([&] { read_mesh_file(root_ / "x.stl"); }));
    write_bytes(root_ / "x.stl", binary_stl(square, "by hand") + "more");
    expect_in("188 bytes, but its 2 triangles take 184", complaint([&] { read_mesh_file(root_ / "x.stl"); }));
    write_bytes(root_ / "x.stl", binary_stl(square).substr(0, 150));  // "solid", as if it were text
    expect_in("150 bytes, but its 2 triangles take 184", complaint([&] { read_mesh_file(root_ / "x.stl"); }));
}

/// A unit square in binary: four positions, then six indices of 16 bits.
std::string square_bytes() {
    Bytes bytes;
    for (const float x : {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}) bytes.put(x);
    for (const uint16_t index : {0, 1, 2, 0, 2, 3}) bytes.put(index);
    return bytes.text;
}

std::string square_json(const std::string& uri) {
    return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
"nodes":[{"children":[1,2],"scale":[2,2,2]},{"mesh":0},{"mesh":0,"matrix":[-1,0,0,0,0,1,0,0,0,0,1,0,0,0,5,1]}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},
{"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}],
"buffers":[{)" +
           uri + R"("byteLength":60}]})";
}

std::string glb(std::string json, const std::string& binary) {
    while (json.size() % 4) json += ' ';
    Bytes bytes;
    bytes.text = "glTF";
    bytes.put(uint32_t(2)).put(uint32_t(28 + json.size() + binary.size())).put(uint32_t(json.size()));
    bytes.text += "JSON" + json;
    bytes.put(uint32_t(binary.size()));
    bytes.text += std::string("BIN\0", 4) + binary;
    return bytes.text;
}

TEST_F(MeshShapes, Gltf) {
    write_bytes(root_ / "x.glb", glb(square_json(""), square_bytes()));
    write_bytes(root_ / "x y.bin", square_bytes());
    write_bytes(root_ / "x.gltf", square_json("\"uri\":\"x%20y.bin\","));
    for (const char* name : {"x.glb", "x.gltf"}) {
        const MeshFile file = read_mesh_file(root_ / name);
        EXPECT_EQ(file.mesh.vertex_count(), 8u);
        EXPECT_NEAR(area(file.mesh), 8, 1e-9);  // two squares of 2 by 2
        EXPECT_EQ(file.mesh.positions[4], Vec3f(0, 0, 10));
        for (const auto& t : file.mesh.triangles) {  // the mirrored one faces up as well
            const Vec3f a = file.mesh.positions[t[0]];
            EXPECT_GT((file.mesh.positions[t[1]] - a).cross(Vec3f(file.mesh.positions[t[2]] - a)).z(), 0);
        }
        expect_in("y up", file.remarks.at(0));
    }
    // Primitives of a mesh, such as those of its materials, share their vertices.
    std::string shared = square_json("");
    const std::string primitive = R"({"attributes":{"POSITION":0},"indices":1})";
    shared.replace(shared.find(primitive), primitive.size(), primitive + "," + primitive);
    write_bytes(root_ / "x.glb", glb(shared, square_bytes()));
    EXPECT_EQ(read_mesh_file(root_ / "x.glb").mesh.vertex_count(), 8u);
    EXPECT_NEAR(area(read_mesh_file(root_ / "x.glb").mesh), 16, 1e-9);
    const auto refused = [&](const std::string& part, const std::string& other, const char* what) {
        std::string json = square_json("");
        json.replace(json.find(part), part.size(), other);
        write_bytes(root_ / "x.glb", glb(json, square_bytes()));
        expect_in(what, complaint([&] { read_mesh_file(root_ / "x.glb"); }));
    };
    refused("\"count\":4", "\"count\":5", "more numbers than bytes");
    refused("\"count\":4", "\"count\":18446744073709551615", "more numbers than bytes");
    refused("\"count\":4", "\"count\":3", "refers to vertex 3");
    refused("\"count\":4", "\"sparse\":{},\"count\":4", "sparse");
    refused("\"byteLength\":48}", "\"byteLength\":4800}", "outside of the buffer");
    refused("\"byteLength\":60", "\"byteLength\":64", "60 of its 64 bytes");
    refused("\"children\":[1,2]", "\"children\":[1,1]", "below two others");
    refused("\"children\":[1,2]", "\"children\":[0]", "below two others");
    refused("\"children\":[1,2]", "\"children\":[7]", "no entry 7 of 'nodes'");
    refused("\"type\":\"VEC3\"", "\"type\":3", "malformed glTF");
    refused("\"scene\":0", "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"]", "without compression");
    refused("\"scene\":0", "\"extensionsRequired\":[\"EXT_meshopt_compression\"]", "without compression");
    refused("\"scene\":0", "\"scene\":", "no glTF in it, or a damaged one");
    const std::string whole = glb(square_json(""), square_bytes());
    for (size_t bytes = 1; bytes < whole.size(); bytes += 3) {
        write_bytes(root_ / "x.glb", whole.substr(0, bytes));
        EXPECT_NE(complaint([&] { read_mesh_file(root_ / "x.glb"); }), "") << bytes;
    }
}

TEST_F(MeshShapes, PlacementsAndFarOrigins) {
    const std::string one = "f 1 2 3\n";
    write_bytes(root_ / "x.obj", "v 0 0 0\nv 1 0 0\nv 0 0 2\n" + one);
    const MeshFile turned = read_mesh_file(root_ / "x.obj", parse_placement("x,z,-y", 10, "0,0,0.5", false));
    EXPECT_EQ(turned.mesh.positions[1], Vec3f(10, 0, 0.5f));
    EXPECT_EQ(turned.mesh.positions[2], Vec3f(0, 20, 0.5f));
    const MeshPlacement mirrored = parse_placement("-x,y,z", 1, "", false);
    const std::array<uint32_t, 3> over = {0, 2, 1};
    EXPECT_EQ(read_mesh_file(root_ / "x.obj", mirrored).mesh.triangles[0], over);
    EXPECT_EQ(read_mesh_file(root_ / "x.obj", parse_placement("", 1, "", true)).mesh.triangles[0], over);
    EXPECT_NE(read_mesh_file(root_ / "x.obj", parse_placement("-x,y,z", 1, "", true)).mesh.triangles[0], over);
    EXPECT_EQ(describe_placement(parse_placement("", 1, "", false)), "");
    expect_in("x,z,-y", describe_placement(parse_placement("x,z,-y", 0.01, "1,-2.5,3", true)));
    expect_in("0.01", describe_placement(parse_placement("x,z,-y", 0.01, "1,-2.5,3", true)));
    expect_in("1,-2.5,3", describe_placement(parse_placement("x,z,-y", 0.01, "1,-2.5,3", true)));
    for (const char* bad : {"x,y", "x,x,z", "x,y,w", "x,y,z,x", "xy,z,x", "x,,z", ","})
        expect_in("each axis once", complaint([&] { parse_placement(bad, 1, "", false); }));
    for (const char* bad : {"1,2", "1,2,x", "1,2,inf", "1,2,3,4", "1;2;3"})
        expect_in("three numbers", complaint([&] { parse_placement("", 1, bad, false); }));

    // UTM coordinates, where floats have steps of half a metre: as text and as doubles.
    write_bytes(root_ / "far.obj",
                "v 448262.109415 5411933.550521 112.27\nv 448263.109415 5411933.550521 112.27\n"
                "v 448262.109415 5411935.550521 112.27\n" +
                    one);
    const MeshFile far = read_mesh_file(root_ / "far.obj", {}, Origin::moved);
    EXPECT_NEAR(area(far.mesh), 1, 1e-6);
    const Vec3d first = far.mesh.positions[0].cast<double>() + far.origin;
    EXPECT_LT((first - Vec3d(448262.109415, 5411933.550521, 112.27)).norm(), 1e-6);
    ASSERT_EQ(far.notes.size(), 1u);
    expect_in("becomes the origin", far.notes[0]);
    expect_in("do not resolve", complaint([&] { read_mesh_file(root_ / "far.obj"); }));
    // Shifted back it is near, and the origin stays.
    EXPECT_TRUE(read_mesh_file(root_ / "far.obj", parse_placement("", 1, "-448262,-5411933,-112", false), Origin::moved)
                    .origin.isZero(0));
}

TEST_F(MeshShapes, OrientationOfClosedMeshes) {
    const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
    const auto orientation = [&](const std::string& faces) {
        write_bytes(root_ / "x.obj", corners + faces);
        return find_orientation(read_mesh_file(root_ / "x.obj").mesh);
    };
    const Orientation outward = orientation("f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    EXPECT_TRUE(outward.closed);
    EXPECT_NEAR(outward.signed_volume, 1.0 / 6, 1e-9);
    EXPECT_NEAR(orientation("f 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n").signed_volume, -1.0 / 6, 1e-9);
    const Orientation mixed = orientation("f 1 2 3\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    EXPECT_FALSE(mixed.closed);
    EXPECT_EQ(mixed.disagreeing_edges, 3u);
    EXPECT_EQ(orientation("f 1 3 2\nf 1 2 4\nf 1 4 3\n").border_edges, 3u);
}

}  // namespace
}  // namespace radiafit
