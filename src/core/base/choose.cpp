#include "base/choose.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/config.h"
#include "base/error.h"

namespace radiafit {

void reject_name(const std::string& what, const std::string& name, const std::vector<std::string>& names) {
    throw UserError(fmt::format("{} '{}' does not exist; choose one of {} (nearest: {})", what, name,
                                fmt::join(names, ", "), nearest(name, names)));
}

}  // namespace radiafit
