#include "base/temporary_name.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <chrono>

namespace radiafit {
namespace fs = std::filesystem;

namespace {
uint64_t first_number() {
    using namespace std::chrono;
    static const auto first = uint64_t(duration_cast<milliseconds>(system_clock::now().time_since_epoch()).count());
    return first;
}
}  // namespace

fs::path temporary_name(const fs::path& folder, const std::string& name, std::string_view prefix) {
    static std::atomic<uint64_t> next{first_number()};
    return folder / fmt::format("{}-{}-{}-{}", prefix, getpid(), next++, name);
}

bool TemporaryName::made_by_this_process() const { return process == getpid() && number >= first_number(); }

TemporaryName parse_temporary_name(std::string_view file_name, std::string_view prefix) {
    const auto take = [&](std::string_view text) {
        const bool there = file_name.starts_with(text);
        if (there) file_name.remove_prefix(text.size());
        return there;
    };
    const auto take_number = [&](auto& number) {
        const auto [end, error] = std::from_chars(file_name.data(), file_name.data() + file_name.size(), number);
        file_name.remove_prefix(size_t(end - file_name.data()));
        return error == std::errc{};
    };
    pid_t process = 0;
    uint64_t count = 0;
    if (!take(prefix) || !take("-") || !take_number(process) || !take("-") || !take_number(count) || !take("-") ||
        process <= 0)
        return {};
    return {process, count, std::string(file_name)};
}

fs::path final_path(const fs::path& path) {
    fs::path result;
    for (const fs::path& part : path) {
        const TemporaryName temporary = parse_temporary_name(part.string(), unfinished_prefix);
        if (temporary.process == 0)
            result /= part;
        else if (!temporary.name.empty())
            result /= temporary.name;
    }
    return result;
}

bool within_unfinished_folder(const fs::path& path) {
    const fs::path folder = path.parent_path();
    return std::any_of(folder.begin(), folder.end(), [](const fs::path& part) {
        return parse_temporary_name(part.string(), unfinished_prefix).process != 0;
    });
}

}  // namespace radiafit
