#pragma once
#include <string>

namespace radiafit {

/// Two ways to a core 4.5 context without a window system.
enum class ContextKind { egl, osmesa };
std::string to_string(ContextKind kind);
ContextKind context_kind_from(const std::string& name);  ///< throws UserError that lists the names

/// Where neither OSMesa nor a number is asked for, RADIAFIT_OPENGL=osmesa, or the number of one of EGL's devices, says
/// which.
struct ContextOptions {
    ContextKind kind = ContextKind::egl;
    int device = -1;  ///< EGL: index as list_devices() gives it; -1: a GPU if there is one, else software
    /// KHR_debug: a failing call throws SystemError that quotes it; Program checks names. Also by RADIAFIT_GL_DEBUG=1.
    bool debug = false;
    int minimum_version = 45;  ///< 10 * major + minor; tests ask for more than exists
};

}  // namespace radiafit
