#include "gl/functions.h"

#include "base/error.h"

namespace radiafit {

void GlFunctions::load(void* (*resolve)(const char*), const std::string& library) {
#define RADIAFIT_GL_LOAD(function)                                                           \
    function.name = "gl" #function;                                                          \
    function.pointer = reinterpret_cast<decltype(&::gl##function)>(resolve("gl" #function)); \
    if (!function.pointer) throw SystemError(library + " has no entry point gl" #function "; update the driver");
    RADIAFIT_GL_FUNCTIONS(RADIAFIT_GL_LOAD)
#undef RADIAFIT_GL_LOAD
}

}  // namespace radiafit
