#include "base/cache_folder.h"

#include <cstdlib>

namespace radiafit {

std::filesystem::path cache_folder() {
    const auto given = [](const char* name) {
        const char* text = std::getenv(name);
        return std::filesystem::path(text ? text : "");
    };
    if (const auto cache = given("XDG_CACHE_HOME"); !cache.empty()) return cache / "radiafit";
    if (const auto home = given("HOME"); !home.empty() && home != "/") return home / ".cache" / "radiafit";
    return {};
}

}  // namespace radiafit
