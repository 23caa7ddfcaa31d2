// Mesh files: what is read from them, whatever their flavour, and what is refused.
#include "capture/mesh_file.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include "capture_fixture.h"

namespace radiafit {
using namespace tools;
namespace {

using namespace testing;
using Meshes = testing::FolderTest;

// A cube of quads, each face with texture coordinates of its own: seams along every edge.
const char* const cube_obj =
    "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
    "vt 0 0\nvt 0.3 0\nvt 0.3 0.3\nvt 0 0.3\nvt 0.5 0.5\nvt 0.9 0.5\nvt 0.9 0.9\nvt 0.5 0.9\nvn 0 0 1\nvn 1 0 0\n"
    "f 1/1/1 4/2/1 3/3/1 2/4/1\nf 5/5/2 6/6/2 7/7/2 8/8/2\nf 1/5/1 2/6/1 6/7/1 5/8/1\n"
    "f 3/1/1 4/2/1 8/3/1 7/4/1\nf 1/2/2 5/3/2 8/4/2 4/1/2\nf 2/8/1 3/7/1 7/6/1 6/5/1\n";

double signed_volume(const Mesh& mesh) {
    double sum = 0;
    for (const auto& t : mesh.triangles) {
        Mat3d m;
        for (int k = 0; k < 3; ++k) m.col(k) = mesh.positions[t[size_t(k)]].cast<double>();
        const Vec3d a = m.col(0), b = m.col(1), c = m.col(2);
        sum += a.x() * (b.y() * c.z() - b.z() * c.y()) + a.y() * (b.z() * c.x() - b.x() * c.z()) +
               a.z() * (b.x() * c.y() - b.y() * c.x());
    }
    return sum / 6;
}

TEST_F(Meshes, SeamsAreWeldedByPosition) {
    write_bytes(root_ / "cube.obj", std::string("mtllib missing.mtl\n") + cube_obj);
    const MeshFile file = read_mesh_file(root_ / "cube.obj");
    EXPECT_EQ(file.mesh.vertex_count(), 8u);
    EXPECT_EQ(file.mesh.triangle_count(), 12u);
    EXPECT_NEAR(signed_volume(file.mesh), 8, 1e-9);  // all faces still turn outward
    EXPECT_TRUE(file.notes.empty());
}

TEST_F(Meshes, SeveralObjectsAreMergedAndNearPositionsStayApart) {
    // The second object shares an edge with the first; its last vertex is one float step off a vertex of the first.
    write_bytes(root_ / "two.obj",
                "o one\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
                "o two\nv -0.0 0 0\nv 0 1 0\nv -1 0 0\nv 1.0000001 0 0\nf 4 5 6\nf 4 7 5\n");
    const MeshFile file = read_mesh_file(root_ / "two.obj");
    EXPECT_EQ(file.mesh.triangle_count(), 3u);
    EXPECT_EQ(file.mesh.vertex_count(), 5u);
}

TEST_F(Meshes, DefectsAreCountedInNotes) {
    write_bytes(root_ / "x.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nf 1 2 3\nf 1 2 2\nf 1 2 4\nl 1 2\n");
    const MeshFile file = read_mesh_file(root_ / "x.obj");
    EXPECT_EQ(file.mesh.triangle_count(), 3u);
    std::string all;
    for (const std::string& note : file.notes) all += note + "\n";
    expect_in("2 degenerate", all);
    expect_in("1 vertices of no triangle", all);
    expect_in("1 points or lines", all);
}

TEST_F(Meshes, MeshesThatCannotBeUsed) {
    const auto reject = [&](const char* name, const std::string& content) {
        write_bytes(root_ / name, content);
        const std::string text = complaint([&] { read_mesh_file(root_ / name); });
        expect_in(name, text);
        return text;
    };
    expect_in("empty mesh", reject("nothing.obj", ""));
    expect_in("mesh", reject("vertices.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n# no face in here\n"));
    expect_in("empty mesh", reject("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\np 1\np 2\np 3\n"));
    expect_in("every triangle is degenerate", reject("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"));
    expect_in("not finite", reject("nan.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n"));
    reject("range.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
    reject("noise.ply", "no ply at all, but a line of text that is long enough");
    expect_in("no such mesh", complaint([&] { read_mesh_file(root_ / "none.obj"); }));
}

TEST_F(Meshes, ObjInAllItsForms) {
    // Corners v, v/vt, v//vn, v/vt/vn; from the start and back from the last vertex; a polygon; a line that goes on.
    write_bytes(
        root_ / "x.OBJ",
        "# by hand\r\nmtllib x.mtl\r\ng top bottom\nv 0 0 0 1.0\nv +1 0 0 0.5 0.5 0.5\nv 1 1 0\nvt 0 0\nvn 0 0 1\n"
        "v 0 1.5e0 1e-60\nv 7 7 7\ns off\nf 1/1 2/1/1 \\\n 3//1 \\\n4\nusemtl a\nf -5 -2 -3\nvp 1 2 3\nl 1 2\np 1\nf 1 "
        "2\n"
        "f 6 7 8\nv 0 0 5\nv 1 0 5\nv 1 1 5\n");
    const MeshFile file = read_mesh_file(root_ / "x.OBJ");
    const std::vector<std::array<uint32_t, 3>> triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 2}, {4, 5, 6}};
    EXPECT_EQ(file.mesh.triangles, triangles);
    ASSERT_EQ(file.mesh.vertex_count(), 7u);  // all but 7 7 7
    EXPECT_EQ(file.mesh.positions[1], Vec3f(1, 0, 0));
    EXPECT_EQ(file.mesh.positions[3], Vec3f(0, 1.5f, 0));
    EXPECT_EQ(file.mesh.positions[6], Vec3f(1, 1, 5));
    ASSERT_EQ(file.notes.size(), 2u);
    expect_in("3 points or lines", file.notes[0]);
    expect_in("1 vertices of no face", file.notes[1]);
}

TEST_F(Meshes, BadObjLinesAreNamed) {
    const std::string good = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    const std::vector<std::array<std::string, 3>> cases = {
        {good + "f 1 2 4\n", "x.obj:5", "vertex 4"},
        {good + "f 1 2 0\n", "x.obj:5", "vertex 0"},
        {good + "f 1 2 -4\n", "x.obj:5", "vertex -4"},
        {good + "f 1 2 99999999999\n", "x.obj:5", "vertex 99999999999"},
        {good + "f 1 2 99999999999999999999\n", "x.obj:5", "no whole number"},
        {good + "f 1 2 x\n", "x.obj:5", "'x'"},
        {good + "f 1 2 3.5\n", "x.obj:5", "'3.5'"},
        {good + "f 1 2 /3\n", "x.obj:5", "''"},
        {good + "v 1 2\n", "x.obj:5", "three numbers"},
        {good + "v 1 2 1,5\n", "x.obj:5", "no number"},
        {good + "v 1 2 1e39\n", "x.obj:5", "not finite"},
        {good + "v inf 2 1\n", "x.obj:5", "not finite"},
        {good + "f 1 2", "x.obj:5", "ends within this line"},
        {good + "f 1 2 x", "x.obj:5", "ends within this line"},
        {good + "f 1 2 \\", "x.obj:5", "joins no line"},
        {good + std::string(100, '\0'), "x.obj", "zero bytes"},
    };
    for (const auto& [content, where, what] : cases) {
        SCOPED_TRACE(content);
        write_bytes(root_ / "x.obj", content);
        const std::string text = complaint([&] { read_mesh_file(root_ / "x.obj"); });
        expect_in(where, text);
        expect_in(what, text);
    }
}

// ---- PLY ----

const std::string ply_vertices = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
const std::string ply_faces = "element face 1\nproperty list uchar int vertex_indices\n";
const std::string ply_square = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";

std::string text_ply(const std::string& elements, const std::string& body) {
    return "ply\nformat ascii 1.0\n" + elements + "end_header\n" + body;
}

std::string binary_ply(const std::string& elements, const std::string& body) {
    return "ply\nformat binary_little_endian 1.0\n" + elements + "end_header\n" + body;
}

TEST_F(Meshes, PlyTextOfAnyEditor) {
    const std::string plain = text_ply(ply_vertices + ply_faces, ply_square);
    std::string cr = plain, wide = "\xff\xfe";
    std::ranges::replace(cr, '\n', '\r');
    for (const char c : plain) wide += std::string{c, '\0'};
    for (const std::string& content : {plain, "\xef\xbb\xbf" + plain, cr, wide}) {
        write_bytes(root_ / "x.ply", content);
        EXPECT_EQ(read_mesh_file(root_ / "x.ply").mesh.triangle_count(), 2u);
    }
    write_bytes(root_ / "x.ply", wide.substr(2));
    expect_in("UTF-16 text without a byte order mark", complaint([&] { read_mesh_file(root_ / "x.ply"); }));
}

TEST_F(Meshes, BadPlyFilesAreNamed) {
    const std::string square = Bytes().put(std::array<float, 12>{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}).text;
    const auto face = [](uint8_t count, const std::vector<int32_t>& corners) {
        Bytes bytes;
        bytes.put(count);
        for (const int32_t corner : corners) bytes.put(corner);
        return bytes.text;
    };
    const std::string all = ply_vertices + ply_faces;
    const auto with = [&](const std::string& part, const std::string& other) {
        std::string text = all;
        return text_ply(text.replace(text.find(part), part.size(), other), ply_square);
    };
    std::string lost = square;
    lost.replace(4, 4, Bytes().put(std::nanf("")).text);
    const std::vector<std::array<std::string, 3>> cases = {
        {with("vertex 4", "vertex 1000000000000"), "x.ply", "promises 1000000000000 entries of 'vertex'"},
        {with("face 1", "face 18446744073709551615"), "x.ply", "entries of 'face'"},
        {with("vertex 4", "vertex 18446744073709551616"), "x.ply:3", "no whole number"},
        {with("vertex 4", "vertex -4"), "x.ply:3", "no whole number"},
        {with("vertex 4", "vertex"), "x.ply:3", "element NAME COUNT"},
        {with("vertex 4", "vertex 5"), "x.ply:14", "more numbers"},
        {with("vertex 4", "vertex 3"), "x.ply:13", "more numbers"},
        {text_ply(all, "0 0 0\n1 0\n1 1 0\n0 1 0\n3 0 1 2\n"), "x.ply:11", "fewer numbers"},
        {with("face 1", "face 2"), "x.ply", "ends before the last 'face'"},
        {with("face 1", "face 0"), "x.ply:14", "more lines"},
        {with("float x", "floot x"), "x.ply:4", "'floot' is no type"},
        {with("float x", "float"), "x.ply:4", "property TYPE NAME"},
        {with("float y", "float x"), "x.ply:5", "second time"},
        {with("float x", "float w"), "x.ply", "no x, y and z"},
        {with("float x", "list uchar float x"), "x.ply", "no x, y and z"},
        {with("list uchar", "list float"), "x.ply:8", "no whole number"},
        {with("face", "vertex"), "x.ply:7", "second time"},
        {with("element face", "elements face"), "x.ply:7", "'elements'"},
        {with("element face 1\n", "element nothing 1000000000000\nelement face 1\n"), "x.ply",
         "'nothing' has no property"},
        {"ply\nformat ascii 2.0\n" + all + "end_header\n" + ply_square, "x.ply:2", "expected 'format'"},
        {"ply\n" + all + "end_header\n" + ply_square, "x.ply", "names no format"},
        {"ply\nformat ascii 1.0\n" + all, "x.ply", "does not end"},
        {text_ply(ply_faces, "4 0 1 2 3\n"), "x.ply", "no vertices"},
        {text_ply(ply_vertices, "0 0 0\n1 0 0\n1 1 0\n0 1 0\n"), "x.ply", "point cloud"},
        {text_ply(all, "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 4\n"), "x.ply:14", "refers to vertex 4"},
        {text_ply(all, "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 -1\n"), "x.ply:14", "refers to vertex -1"},
        {text_ply(all, "0 0 0\n1 0 0\n1 1 0\n0 1 0\n-1 0 1 2\n"), "x.ply:14", "fewer than no items"},
        {text_ply(all, "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 3\n"), "x.ply:14", "more numbers"},
        {text_ply(all, "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1"), "x.ply:14", "ends within this line"},
        {text_ply(all, "0 0 0\n1 nan 0\n1 1 0\n0 1 0\n3 0 1 2\n"), "x.ply:11", "not finite"},
        {binary_ply(all, square + face(4, {0, 1, 2, 4})), "x.ply", "face 0 of 1: refers to vertex 4"},
        {binary_ply(all, square + face(4, {0, 1, 2, -1})), "x.ply", "refers to vertex -1"},
        {binary_ply(all, square + face(4, {0, 1, 2})), "x.ply", "face 0 of 1: the file ends here"},
        {binary_ply(all, square + face(255, {0, 1, 2, 3})), "x.ply", "the file ends here"},
        {binary_ply(all, square + face(3, {0, 1, 2, 3})), "x.ply", "4 bytes follow"},
        {binary_ply(all, lost + face(4, {0, 1, 2, 3})), "x.ply", "vertex 0 of 4: its position is not finite"},
    };
    for (const auto& [content, where, what] : cases) {
        SCOPED_TRACE(content);
        write_bytes(root_ / "x.ply", content);
        const std::string text = complaint([&] { read_mesh_file(root_ / "x.ply"); });
        expect_in(where, text);
        expect_in(what, text);
    }
}

TEST_F(Meshes, OtherFilesAreRefused) {
    write_bytes(root_ / "x.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    expect_in("neither PLY, OBJ, STL, GLB nor glTF", complaint([&] { read_mesh_file(root_ / "x.off"); }));
    expect_in("it is a folder", complaint([&] { read_mesh_file(root_); }));
    ASSERT_EQ(mkfifo((root_ / "pipe.obj").c_str(), 0600), 0);
    expect_in("it is a pipe", complaint([&] { read_mesh_file(root_ / "pipe.obj"); }));
    fs::create_symlink("loop.obj", root_ / "loop.obj");
    expect_in("symbolic links", complaint([&] { read_mesh_file(root_ / "loop.obj"); }));
    expect_in("too long", complaint([&] { read_mesh_file(root_ / std::string(300, 'x')); }));
    // Sparse: it says that it has more bytes than anyone wants to take.
    write_bytes(root_ / "vast.obj", "v 0 0 0\n");
    fs::resize_file(root_ / "vast.obj", uint64_t(1) << 40);
    expect_in("1099511627776 bytes", complaint([&] { read_mesh_file(root_ / "vast.obj"); }));
}

// ---- Random meshes in every flavour ----

struct RandomMesh {
    std::vector<Vec3f> positions;
    std::vector<std::vector<uint32_t>> faces;
    std::vector<std::array<uint32_t, 3>> triangles;  ///< of the faces, as fans
};

/// A bumpy grid of triangles, quads and hexagons; no two positions are equal, and every vertex has a face.
RandomMesh random_mesh(std::mt19937& random) {
    RandomMesh mesh;
    const uint32_t columns = 2 + random() % 8,
                   rows = 2 + random() % 8;  // up to 100 vertices: a signed byte numbers them
    for (uint32_t j = 0; j <= rows; ++j)
        for (uint32_t i = 0; i <= columns; ++i) mesh.positions.emplace_back(i, j, float(random()) * 0x1p-33f);
    for (uint32_t j = 0; j < rows; ++j)
        for (uint32_t i = 0; i < columns; ++i) {
            const uint32_t a = j * (columns + 1) + i, b = a + 1, c = b + columns + 1, d = c - 1;
            const uint32_t kind = random() % 3;
            if (kind == 0) mesh.faces.insert(mesh.faces.end(), {{a, b, c}, {a, c, d}});
            if (kind == 1) mesh.faces.push_back({a, b, c, d});
            if (kind == 2 && i + 1 == columns) mesh.faces.push_back({d, a, b, c});
            if (kind == 2 && i + 1 < columns) mesh.faces.push_back({a, b, b + 1, c + 1, c, d}), ++i;
        }
    for (const auto& face : mesh.faces)
        for (size_t k = 2; k < face.size(); ++k) mesh.triangles.push_back({face[0], face[k - 1], face[k]});
    return mesh;
}

/// Where the corners of all triangles lie, one after another.
std::vector<std::array<float, 3>> corners(const std::vector<Vec3f>& positions,
                                          const std::vector<std::array<uint32_t, 3>>& triangles) {
    std::vector<std::array<float, 3>> result;
    for (const auto& triangle : triangles)
        for (const uint32_t v : triangle) result.push_back({positions[v].x(), positions[v].y(), positions[v].z()});
    return result;
}

/// Cut anywhere, a file is refused in one line, or it is a mesh still: of OBJ, which has no end, that with fewer faces.
void cut_everywhere(const fs::path& file, bool has_end) {
    const std::string whole = read_bytes(file);
    const MeshFile mesh = read_mesh_file(file);
    for (size_t part = 0; part < 50; ++part) {
        write_bytes(file, whole.substr(0, whole.size() * part / 50));
        SCOPED_TRACE(part);
        try {
            EXPECT_LE(read_mesh_file(file).mesh.triangle_count(), mesh.mesh.triangle_count());
            EXPECT_FALSE(has_end);
        } catch (const UserError& error) {
            EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
        }
    }
}

std::string random_obj(const RandomMesh& mesh, std::mt19937& random) {
    std::string text = "o random\nvt 0 0\nvn 0 0 1\n";
    const bool mixed = random() % 2;  // faces between the vertices, as soon as these are there
    size_t written = 0;
    const auto write_vertices = [&](size_t up_to) {
        for (; written < up_to; ++written) {
            const Vec3f& p = mesh.positions[written];
            text += fmt::format("v {}{}{} {}\n", p.x(), random() % 2 ? " " : "\t", p.y(), p.z());
        }
    };
    for (const auto& face : mesh.faces) {
        write_vertices(mixed ? *std::max_element(face.begin(), face.end()) + 1 : mesh.positions.size());
        text += "f";
        for (const uint32_t v : face) {
            const bool back = random() % 2;
            text += random() % 8 ? " " : " \\\n ";
            text += back ? fmt::format("-{}", written - v) : fmt::format("{}", v + 1);
            text += std::array{"", "/1", "//1", "/1/1", "/-1/-1"}[random() % 5];
        }
        text += std::array{"\n", " \n", "\r\n", "\n\n# comment\n", "\nusemtl x\n"}[random() % 5];
    }
    return text;
}

TEST_F(Meshes, RandomObjFilesAreReadAsWritten) {
    for (uint32_t seed = 0; seed < 40; ++seed) {
        SCOPED_TRACE(seed);
        std::mt19937 random(seed);
        const RandomMesh mesh = random_mesh(random);
        write_bytes(root_ / "x.obj", random_obj(mesh, random));
        const Mesh read = read_mesh_file(root_ / "x.obj").mesh;
        EXPECT_EQ(read.vertex_count(), mesh.positions.size());
        EXPECT_EQ(corners(read.positions, read.triangles), corners(mesh.positions, mesh.triangles));
        if (seed < 5) cut_everywhere(root_ / "x.obj", false);
    }
}

/// Writes a mesh as a PLY file of random format and types, with elements and properties that nobody asked for.
class RandomPly {
public:
    explicit RandomPly(std::mt19937& random) : random_(random), format_(random() % 3) {}

    std::string write(const RandomMesh& mesh) {
        describe(mesh);
        std::string text = std::string("ply\nformat ") + formats[format_] + " 1.0\ncomment by a test\n";
        for (const Element& element : elements_) {
            text += fmt::format("element {} {}\n", element.name, element.entries);
            for (const Property& p : element.properties) {
                text += "property ";
                if (p.length) text += fmt::format("list {} ", types[*p.length][random_() % 2]);
                text += fmt::format("{} {}\n", types[p.type][random_() % 2], p.name);
            }
        }
        text += "end_header\n";
        for (const Element& element : elements_)
            for (size_t i = 0; i < element.entries; ++i) text += entry(element, i, mesh);
        return text;
    }

private:
    struct Property {
        std::string name;
        size_t type;                   ///< index into types
        std::optional<size_t> length;  ///< likewise
    };
    struct Element {
        std::string name;
        size_t entries;
        std::vector<Property> properties;
    };
    static constexpr const char* formats[3] = {"ascii", "binary_little_endian", "binary_big_endian"};
    static constexpr const char* types[8][2] = {{"char", "int8"},     {"uchar", "uint8"},   {"short", "int16"},
                                                {"ushort", "uint16"}, {"int", "int32"},     {"uint", "uint32"},
                                                {"float", "float32"}, {"double", "float64"}};

    void describe(const RandomMesh& mesh) {
        Element vertex{"vertex", mesh.positions.size(), {}}, face{"face", mesh.faces.size(), {}};
        for (const char* axis : {"x", "y", "z"}) {
            add_extra(vertex);
            vertex.properties.push_back({axis, 6 + random_() % 2, {}});
        }
        add_extra(vertex);
        add_extra(face);
        face.properties.push_back({random_() % 2 ? "vertex_indices" : "vertex_index", random_() % 6, random_() % 6});
        add_extra(face);
        elements_ = {vertex, face};
        if (random_() % 4 == 0) std::swap(elements_[0], elements_[1]);
        Element other{"edge", random_() % 5, {}};
        while (other.properties.empty()) add_extra(other);
        elements_.insert(elements_.begin() + random_() % 3, other);
    }
    void add_extra(Element& element) {
        while (random_() % 2) {
            Property p{fmt::format("extra{}", element.properties.size()), random_() % 8, {}};
            if (random_() % 3 == 0) p.length = random_() % 6;
            element.properties.push_back(p);
        }
    }

    std::string entry(const Element& element, size_t i, const RandomMesh& mesh) {
        std::string text;
        for (const Property& p : element.properties) {
            std::vector<double> values = {double(random_() % 100)};
            if (element.name == "vertex" && p.name.size() == 1) values = {mesh.positions[i][p.name[0] - 'x']};
            if (p.length) values.resize(random_() % 4, 3);
            if (p.name.starts_with("vertex_ind")) values.assign(mesh.faces[i].begin(), mesh.faces[i].end());
            if (p.length) text += number(double(values.size()), *p.length);
            for (const double v : values) text += number(v, p.type);
        }
        return format_ == 0 ? text + "\n" : text;
    }
    std::string number(double v, size_t type) const {
        if (format_ == 0) return type == 6 ? fmt::format("{} ", float(v)) : fmt::format("{} ", v);
        Bytes bytes;
        if (type < 2) bytes.put(int8_t(v));
        if (type == 2 || type == 3) bytes.put(int16_t(v));
        if (type == 4 || type == 5) bytes.put(int32_t(v));
        if (type == 6) bytes.put(float(v));
        if (type == 7) bytes.put(v);
        if (format_ == 2) std::reverse(bytes.text.begin(), bytes.text.end());
        return bytes.text;
    }

    std::mt19937& random_;
    size_t format_;
    std::vector<Element> elements_;
};

TEST_F(Meshes, RandomPlyFilesAreReadAsWritten) {
    for (uint32_t seed = 0; seed < 120; ++seed) {
        SCOPED_TRACE(seed);
        std::mt19937 random(seed);
        const RandomMesh mesh = random_mesh(random);
        write_bytes(root_ / "x.ply", RandomPly(random).write(mesh));
        const Mesh read = read_mesh_file(root_ / "x.ply").mesh;
        EXPECT_EQ(read.positions, mesh.positions);
        EXPECT_EQ(read.triangles, mesh.triangles);
        if (seed < 15) cut_everywhere(root_ / "x.ply", true);
    }
}

}  // namespace
}  // namespace radiafit
