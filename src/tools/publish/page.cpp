#include "publish/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/output_claims.h"
#include "publish/embedded_viewer.h"

namespace radiafit::tools {
namespace {

namespace fs = std::filesystem;

constexpr const char* mark = "<meta name=\"generator\" content=\"radiafit-page\">";  // is in web/index.html
constexpr const char* index_name = "index.html";
constexpr const char* program_name = "viewer.js";
constexpr const char* data_name = "data";

std::string_view viewer_text(std::string_view file) {
    return std::ranges::find(embedded_viewer(), file, &EmbeddedText::file)->text;
}

std::string base64(std::string_view bytes) {
    constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    out.reserve((bytes.size() + 2) / 3 * 4);
    for (size_t i = 0; i < bytes.size(); i += 3) {
        uint32_t group = 0;
        for (size_t k = i; k < i + 3; ++k) group = group << 8 | (k < bytes.size() ? uint8_t(bytes[k]) : 0u);
        for (size_t k = 0; k < 4; ++k) out += k > bytes.size() - i ? '=' : digits[group >> (18 - 6 * k) & 63];
    }
    return out;
}

std::string replaced(std::string text, std::string_view from, std::string_view to) {
    for (size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
        text.replace(at, from.size(), to);
    return text;
}

/// Text that ends no script element and begins no comment in one.
std::string in_script(std::string_view text) {
    return replaced(replaced(std::string(text), "</script", "<\\/script"), "<!--", "<\\!--");
}

std::string in_text(std::string text) {
    return replaced(replaced(replaced(std::move(text), "&", "&amp;"), "<", "&lt;"), "\"", "&quot;");
}

/// web/index.html with what its places hold: title, first picture, style and scripts.
std::string html(const Page& page, const std::string& scripts) {
    std::string out(viewer_text(index_name));
    out = replaced(std::move(out), "@PICTURE@", "data:image/webp;base64," + base64(page.picture));
    out = replaced(std::move(out), "@TITLE@", in_text(page.title));
    out = replaced(std::move(out), "/*STYLE*/", viewer_text("style.css"));
    return replaced(std::move(out), "<!--SCRIPTS-->", scripts);
}

std::string page_script(const Page& page) { return "window.radiafit_page = " + in_script(page.json) + ";\n"; }

std::string whole_html(const Page& page) {
    std::string scripts = "<script>" + page_script(page) + "</script>\n";
    scripts += "<script>" + in_script(viewer_text(program_name)) + "</script>\n";  // it begins before the rest is here
    for (const auto& [name, bytes] : page.blobs)
        scripts += fmt::format("<script type=\"text/plain\" id=\"data-{}\">{}</script>\n", name, base64(bytes));
    const std::string made = made_by_remark();
    if (made.empty()) return html(page, scripts);
    return replaced(html(page, scripts), mark,
                    fmt::format("{}\n<meta name=\"radiafit-made\" content=\"{}\">", mark, made));
}

std::string start_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    std::string text(4096, '\0');
    stream.read(text.data(), std::streamsize(text.size()));
    return text;
}

bool is_page(const fs::path& html) {
    std::error_code error;
    return fs::is_regular_file(html, error) && start_of(html).find(mark) != std::string::npos;
}

[[noreturn]] void refuse(const fs::path& place, const std::string& why) {
    throw UserError(fmt::format("{}: {}; remove it or choose another name for the page", place.string(), why));
}

/// Whether a page has a file of this name, relative to its folder.
bool is_own(const fs::path& name) {
    if (name == made_by_name || name == index_name || name == program_name || name == data_name) return true;
    return name.parent_path() == data_name && name.extension() == ".js";
}

}  // namespace

uint64_t Page::written_bytes() const {
    uint64_t bytes = json.size() + (picture.size() + 2) / 3 * 4;
    for (const auto& [name, blob] : blobs) bytes += (blob.size() + 2) / 3 * 4 + name.size() + 50;
    for (const EmbeddedText& text : embedded_viewer()) bytes += text.text.size();
    return bytes;
}

void require_viewer() {
    if (viewer_text(program_name).empty())
        throw UserError(
            "this radiafit was built without the viewer of pages, for want of node, npm or a network to get npm's "
            "packages from; install nodejs and npm, and build it again");
}

void check_page_target(const fs::path& place, bool single_file) {
    std::error_code error;
    if (!fs::exists(fs::symlink_status(place, error))) return;
    if (single_file) {
        if (!is_page(place)) refuse(place, "is there, and is no page of radiafit");
        return;
    }
    if (!fs::is_directory(place, error)) refuse(place, "a file is there");
    if (fs::is_empty(place, error)) return;
    if (!is_page(place / index_name)) refuse(place, "is no page of radiafit");
    for (const auto& entry : fs::recursive_directory_iterator(place, error)) {
        const fs::path name = entry.path().lexically_relative(place);
        if (!is_own(name)) refuse(place, fmt::format("holds {}, which is no part of a page", name.string()));
    }
}

void write_page(const fs::path& place, bool single_file, const Page& page) {
    check_page_target(place, single_file);
    if (single_file) return write_file(place, whole_html(page));
    AtomicFolder folder(place, AtomicFolder::Existing::replace);
    std::error_code error;
    fs::create_directory(folder.path() / data_name, error);  // writing into it says what is wrong
    for (const auto& [name, bytes] : page.blobs)
        write_file(folder.path() / data_name / (name + ".js"),
                   fmt::format("radiafit_data(\"{}\", \"{}\");\n", name, base64(bytes)));
    write_file(folder.path() / data_name / "page.js", page_script(page));
    write_file(folder.path() / program_name, viewer_text(program_name));
    write_file(folder.path() / index_name,
               html(page, "<script src=\"data/page.js\"></script>\n<script src=\"viewer.js\"></script>"));
    folder.commit();
}

}  // namespace radiafit::tools
