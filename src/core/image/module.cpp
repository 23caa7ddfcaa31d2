#include "image/module.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include "base/error.h"
#include "base/module.h"

namespace radiafit {

void* find_in_module(const char* module, const char* function, std::string_view failure) {
    void* loaded = open_module(module, RTLD_NOW | RTLD_LOCAL);
    void* found = loaded ? dlsym(loaded, function) : nullptr;
    if (!found) throw UserError(fmt::format(fmt::runtime(failure), dlerror()));
    return found;
}

}  // namespace radiafit
