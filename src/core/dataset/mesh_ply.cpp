#include "dataset/mesh_ply.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cstring>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/wording.h"

namespace radiafit {
namespace fs = std::filesystem;
namespace {

static_assert(std::endian::native == std::endian::little, "files are little-endian and read as they are");

constexpr size_t vertex_bytes = 3 * sizeof(float);
constexpr size_t face_bytes = 1 + 3 * sizeof(uint32_t);

[[noreturn]] void damaged(const fs::path& path, const std::string& what) {
    throw UserError(fmt::format("{}: {}; {}", path.string(), what,
                                at_command_line("run radiafit generate or import again", "make the dataset again")));
}

struct Header {
    size_t vertices = 0, faces = 0, bytes = 0;
};

/// Type names of PLY's original description and of later writers mean the same.
std::string canonical(const std::string& line) {
    static const std::array<std::array<const char*, 2>, 4> synonyms = {
        {{"float32", "float"}, {"uint8", "uchar"}, {"uint32", "uint"}, {"vertex_index", "vertex_indices"}}};
    std::istringstream in(line);
    std::string word, out;
    while (in >> word) {
        for (const auto& [other, ours] : synonyms)
            if (word == other) word = ours;
        out += out.empty() ? word : " " + word;
    }
    return out;
}

Header read_header(std::istream& in, const fs::path& path) {
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line) && lines.size() < 1000;) {
        line = canonical(line);
        if (!line.starts_with("comment")) lines.push_back(line);
        if (line == "end_header") break;
    }
    Header header;
    const auto count = [&](size_t i, const std::string& prefix) {
        const std::string digits = lines[i].substr(prefix.size());
        if (digits.empty() || digits.size() > 10 || digits.find_first_not_of("0123456789") != std::string::npos)
            damaged(path, fmt::format("the PLY header counts \"{}\"", lines[i]));
        return static_cast<size_t>(std::stoull(digits));
    };
    static const std::array<std::string, 9> expected = {"ply",
                                                        "format binary_little_endian 1.0",
                                                        "element vertex ",
                                                        "property float x",
                                                        "property float y",
                                                        "property float z",
                                                        "element face ",
                                                        "property list uchar uint vertex_indices",
                                                        "end_header"};
    for (size_t i = 0; i < expected.size(); ++i) {
        const bool counts = expected[i].ends_with(' ');
        const bool fits = i < lines.size() && (counts ? lines[i].starts_with(expected[i]) : lines[i] == expected[i]);
        if (!fits) {
            const std::string found = i < lines.size() ? lines[i].substr(0, 60) : "the end of the file";
            damaged(path, fmt::format("the PLY header has \"{}\" where \"{}\" belongs", found, expected[i]));
        }
        if (counts) (i == 2 ? header.vertices : header.faces) = count(i, expected[i]);
    }
    header.bytes = static_cast<size_t>(in.tellg());
    return header;
}

}  // namespace

void write_ply(const Mesh& mesh, const fs::path& path, const std::string& comment) {
    std::string data = fmt::format(
        "ply\nformat binary_little_endian 1.0\n{}"
        "element vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
        "element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
        comment.empty() ? "" : "comment " + comment + "\n", mesh.vertex_count(), mesh.triangle_count());
    size_t at = data.size();
    data.resize(at + mesh.vertex_count() * vertex_bytes + mesh.triangle_count() * face_bytes);
    for (const Vec3f& p : mesh.positions) {
        std::memcpy(data.data() + at, p.data(), vertex_bytes);
        at += vertex_bytes;
    }
    for (const auto& triangle : mesh.triangles) {
        data[at] = 3;
        std::memcpy(data.data() + at + 1, triangle.data(), sizeof(triangle));
        at += face_bytes;
    }
    write_file(path, data);
}

Mesh read_ply(const fs::path& path) {
    std::error_code ignored;
    if (!fs::is_regular_file(path, ignored)) damaged(path, "the file is missing or cannot be read");
    std::ifstream in(path, std::ios::binary);
    if (!in) damaged(path, "the file is missing or cannot be read");
    const Header header = read_header(in, path);
    const size_t body = header.vertices * vertex_bytes + header.faces * face_bytes;
    const size_t size = fs::file_size(path);
    if (size != header.bytes + body)
        damaged(path, fmt::format("{} vertices and {} triangles need {} bytes, but the file has {}", header.vertices,
                                  header.faces, header.bytes + body, size));
    std::vector<char> data(body);
    if (!in.read(data.data(), static_cast<std::streamsize>(body))) damaged(path, "the file cannot be read whole");

    Mesh mesh;
    mesh.positions.resize(header.vertices);
    mesh.triangles.resize(header.faces);
    const char* at = data.data();
    for (Vec3f& p : mesh.positions) {
        std::memcpy(p.data(), at, vertex_bytes);
        at += vertex_bytes;
    }
    for (size_t t = 0; t < header.faces; ++t) {
        if (*at != 3) damaged(path, fmt::format("face {} has {} corners, not 3", t, static_cast<uint8_t>(*at)));
        std::memcpy(mesh.triangles[t].data(), at + 1, sizeof(mesh.triangles[t]));
        at += face_bytes;
    }
    check_mesh(mesh, path.string());
    return mesh;
}

}  // namespace radiafit
