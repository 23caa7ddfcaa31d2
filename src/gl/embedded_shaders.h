#pragma once
#include <string_view>
#include <vector>

namespace radiafit {

/// The folder shaders/ as it was when the library was built (cmake/embed_shaders.cmake).
struct EmbeddedShader {
    std::string_view file;  ///< relative to shaders/
    std::string_view text;
};
const std::vector<EmbeddedShader>& embedded_shaders();

}  // namespace radiafit
