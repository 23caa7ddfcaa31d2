#pragma once
#include <functional>
#include <string>
#include <utility>
#include <vector>

/// Texts of shaders, before a driver sees them.
namespace radiafit {

/// Preprocessor definitions put before a shader's text.
using Defines = std::vector<std::pair<std::string, std::string>>;
inline Defines operator+(Defines a, const Defines& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

/// A shader with every #include "…" (relative to shaders/) expanded once, and #line kept, so that errors name the real
/// file. Texts are part of the library; those of a folder named by RADIAFIT_SHADERS replace them all. Where the
/// name of a file is a definition's, that definition takes its place: "model/MODEL.glsl".
struct ShaderText {
    std::string text;
    std::vector<std::string> files;  ///< #line's second number is an index into this
};
/// One file's text. Throws UserError for one that cannot be read.
std::string shader_file(const std::string& file);
/// A text more, for as long as the program runs, as "model/mine.glsl"; made when it is first asked for.
void add_shader(const std::string& file, std::function<std::string()> text);
/// `file` begins with a #version line; `defines` follow it. Throws UserError for a file that cannot be read.
ShaderText expand_shader(const std::string& file, const Defines& defines = {});

}  // namespace radiafit
