#pragma once
#include <string_view>

namespace radiafit {

/// A file that is part of the program (cmake/embed_texts.cmake).
struct EmbeddedText {
    std::string_view file;  ///< relative to the folder that was embedded
    std::string_view text;
};

}  // namespace radiafit
