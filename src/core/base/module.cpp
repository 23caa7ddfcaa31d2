#include "base/module.h"

#include <dlfcn.h>

#include <filesystem>
#include <system_error>

#include "base/compiled_library.h"

namespace radiafit {

void* open_module(const std::string& name, int flags) {
    std::error_code error;
    std::filesystem::path folder = surrounding_library();
    if (folder.empty()) folder = std::filesystem::read_symlink("/proc/self/exe", error);
    for (int above = 0; above < 3 && folder.has_relative_path(); ++above) {
        folder = folder.parent_path();
        for (const char* lib : {"lib", "lib/radiafit"})
            if (const auto file = folder.parent_path() / lib / name; std::filesystem::exists(file, error))
                return dlopen(file.c_str(), flags);
    }
    return dlopen(name.c_str(), flags);
}

}  // namespace radiafit
