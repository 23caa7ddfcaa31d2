#include "capture/obj_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "base/error.h"
#include "base/text_file.h"

namespace radiafit::tools {
namespace {

class ObjReader {
public:
    ObjReader(const std::filesystem::path& file, std::string text) : file_(file), text_(file, std::move(text), 0) {}

    RawMesh read() {
        for (std::string_view line; next_statement(line);) {
            const std::vector<std::string_view> words = split_tokens(line);
            if (words.empty()) continue;
            if (words[0] == "v") add_vertex(words);
            if (words[0] == "f") add_face(words);
            if (words[0] == "l" || words[0] == "p") ++raw_.no_polygons;
        }
        if (largest_ > positions().size())
            throw UserError(fmt::format("{}:{}: refers to vertex {}, but the file has only {}: export the mesh again",
                                        file_.string(), largest_line_, largest_, positions().size()));
        raw_.cut_polygons();
        sort_by_use();
        return std::move(raw_);
    }

private:
    std::vector<Vec3d>& positions() { return raw_.positions; }

    bool next_line(std::string_view& line) {
        if (!text_.next_line(line)) return false;
        line = line.substr(0, line.find('#'));  // a comment may stand behind anything
        return true;
    }

    /// A line, with those that a backslash at its end joins to it.
    bool next_statement(std::string_view& line) {
        if (!next_line(line)) return false;
        if (!line.ends_with('\\')) return true;
        joined_.clear();
        for (bool more = true; more;) {
            more = line.ends_with('\\');
            joined_ += line.substr(0, line.size() - (more ? 1 : 0));
            joined_ += ' ';
            if (more && !next_line(line)) text_.fail("a backslash joins no line to this one: export the mesh again");
        }
        line = joined_;
        return true;
    }

    void add_vertex(const std::vector<std::string_view>& words) {
        if (words.size() < 4) text_.fail("a vertex takes three numbers: export the mesh again");
        positions().emplace_back(to_coordinate(text_, words[1], "x"), to_coordinate(text_, words[2], "y"),
                                 to_coordinate(text_, words[3], "z"));  // a weight or a colour may follow
    }

    void add_face(const std::vector<std::string_view>& words) {
        corners_.clear();
        for (size_t k = 1; k < words.size(); ++k) corners_.push_back(corner(words[k]));
        if (corners_.size() < 3 && !text_.ended()) text_.fail("a face takes three corners or more");
        raw_.add_polygon(corners_);
    }

    /// The vertex of v, v/vt, v//vn or v/vt/vn, from 0 on. Files count from 1 on, and back from the last one by -1.
    uint32_t corner(std::string_view word) {
        const int64_t number = text_.to_signed(word.substr(0, word.find('/')), "a face's vertex");
        const auto count = static_cast<int64_t>(positions().size());
        if (number == 0 || number < -count || number > std::numeric_limits<uint32_t>::max())
            text_.fail(fmt::format("refers to vertex {}, which is none of the {} before: export the mesh again", number,
                                   count));
        if (number < 0) return static_cast<uint32_t>(count + number);
        if (uint64_t(number) > largest_) largest_ = uint64_t(number), largest_line_ = text_.line_number();
        return static_cast<uint32_t>(number - 1);
    }

    void sort_by_use() {
        constexpr uint32_t unused = std::numeric_limits<uint32_t>::max();
        std::vector<uint32_t> new_index(positions().size(), unused);
        std::vector<Vec3d> sorted;
        for (auto& triangle : raw_.triangles)
            for (uint32_t& v : triangle) {
                if (new_index[v] == unused) {
                    new_index[v] = static_cast<uint32_t>(sorted.size());
                    sorted.push_back(positions()[v]);
                }
                v = new_index[v];
            }
        raw_.unused_vertices = positions().size() - sorted.size();
        positions() = std::move(sorted);
    }

    std::filesystem::path file_;
    TextFile text_;
    RawMesh raw_;
    std::string joined_;             ///< the statement, if it spans lines
    std::vector<uint32_t> corners_;  ///< of the current face
    uint64_t largest_ = 0;           ///< vertex that a face refers to, as the file counts
    size_t largest_line_ = 0;
};

}  // namespace

RawMesh read_obj_mesh(const std::filesystem::path& file, std::string text) {
    return ObjReader(file, std::move(text)).read();
}

}  // namespace radiafit::tools
