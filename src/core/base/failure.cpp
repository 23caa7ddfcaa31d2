#include "base/failure.h"

#include <fmt/format.h>

#include <filesystem>
#include <new>
#include <system_error>

#include "base/error.h"

namespace radiafit {
namespace {

bool is_users_mistake(const std::error_code& code) {
    for (const std::errc known :
         {std::errc::too_many_symbolic_link_levels, std::errc::filename_too_long, std::errc::permission_denied,
          std::errc::operation_not_permitted, std::errc::no_such_file_or_directory, std::errc::not_a_directory,
          std::errc::is_a_directory, std::errc::file_exists, std::errc::directory_not_empty,
          std::errc::read_only_file_system})
        if (code == known) return true;
    return false;
}

}  // namespace

Failure describe(const std::exception& error) {
    const int status = dynamic_cast<const UserError*>(&error) ? 2 : 1;
    if (const auto* refused = dynamic_cast<const std::filesystem::filesystem_error*>(&error))
        return {is_users_mistake(refused->code()) ? 2 : 1,
                fmt::format("{}: {}; check the path and its permissions", refused->path1().string(),
                            refused->code().message())};
    if (dynamic_cast<const std::bad_alloc*>(&error))
        return {1, "out of memory; close other programs, or use less data"};
    return {status, error.what()};
}

}  // namespace radiafit
