#pragma once
#include <dlfcn.h>

#include <vector>

#include "gl/context.h"

/// The kinds of contexts that tests may make: a machine with a graphics chip need not have OSMesa.
namespace radiafit {

inline bool has_osmesa() {
    static const bool found = dlopen("libOSMesa.so.8", RTLD_LAZY | RTLD_LOCAL) != nullptr;  // never closed
    return found;
}

/// EGL, and OSMesa where it is installed.
inline std::vector<ContextKind> context_kinds() {
    if (has_osmesa()) return {ContextKind::egl, ContextKind::osmesa};
    return {ContextKind::egl};
}

/// For tests that need any context, most of which have EGL's: OSMesa where it is installed, else EGL.
inline ContextKind second_kind() { return context_kinds().back(); }

}  // namespace radiafit
