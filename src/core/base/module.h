#pragma once
#include <string>

namespace radiafit {

/// Opens a module of the program, a shared library that links a large one so that the program need not: a file in lib
/// or lib/radiafit beside the folder of the program, or of the shared library that this code is a part of, or one
/// folder further up; else where dlopen() looks. flags: dlopen()'s. Null: dlerror() says why. It is looked for by its
/// whole path, since an RPATH is searched for every other library, too.
void* open_module(const std::string& name, int flags);

}  // namespace radiafit
