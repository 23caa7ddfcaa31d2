#pragma once
#include <vector>

#include "base/embedded_text.h"

namespace radiafit::tools {

/// index.html, style.css and viewer.js, the bundle of web/src and three.js, as they were when the library was built
/// (cmake/bundle_viewer.cmake). viewer.js is empty where npm was not there to bundle it.
const std::vector<EmbeddedText>& embedded_viewer();

}  // namespace radiafit::tools
