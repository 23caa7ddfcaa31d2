#include "base/resources.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <limits>
#include <string_view>

#include "base/error.h"
#include "base/log.h"
#include "base/wording.h"

namespace radiafit {
namespace fs = std::filesystem;
namespace {

constexpr uint64_t unknown = std::numeric_limits<uint64_t>::max();

/// The number that a file of the kernel's begins with; `unknown` if there is none ("max", or no such file).
uint64_t number_in(const fs::path& file) {
    uint64_t value = 0;
    return std::ifstream(file) >> value ? value : unknown;
}

/// The number after this word, at the beginning of a line; `unknown` if there is none.
uint64_t number_after(std::string_view word, const fs::path& file) {
    std::ifstream lines(file);
    for (std::string name; lines >> name; lines.ignore(256, '\n')) {
        uint64_t value = 0;
        if (name == word && lines >> value) return value;
    }
    return unknown;
}

uint64_t left_of(uint64_t limit, uint64_t used) { return limit > used ? limit - used : 0; }

/// MemAvailable: what can be had without paging, caches that can go included.
uint64_t system_memory() {
    const uint64_t kilobytes = number_after("MemAvailable:", "/proc/meminfo");
    return kilobytes == unknown ? unknown : kilobytes * 1024;
}

uint64_t address_space() {
    rlimit limit{};
    if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return unknown;
    const uint64_t pages = number_in("/proc/self/statm");
    return pages == unknown ? unknown : left_of(limit.rlim_cur, pages * uint64_t(sysconf(_SC_PAGESIZE)));
}

}  // namespace

namespace detail {

uint64_t control_group_memory(const fs::path& process_groups, const fs::path& tree) {
    uint64_t least = unknown;
    std::ifstream groups(process_groups);
    for (std::string line; std::getline(groups, line);) {
        if (!line.starts_with("0::")) continue;  // version 2
        for (fs::path group = tree / fs::path(line.substr(3)).relative_path(); group != tree.parent_path();
             group = group.parent_path()) {
            const uint64_t limit = number_in(group / "memory.max"), used = number_in(group / "memory.current");
            if (limit == unknown || used == unknown) continue;
            const uint64_t files = number_after("inactive_file", group / "memory.stat");
            least = std::min(least, left_of(limit, files == unknown ? used : left_of(used, files)));
        }
    }
    return least;
}

}  // namespace detail

uint64_t available_memory() {
    return std::min(
        {system_memory(), detail::control_group_memory("/proc/self/cgroup", "/sys/fs/cgroup"), address_space()});
}

uint64_t free_disk(const fs::path& path) {
    std::error_code error;
    fs::path existing = fs::absolute(path, error);
    while (!fs::exists(existing, error) && existing.has_relative_path()) existing = existing.parent_path();
    struct statvfs status {};
    if (statvfs(existing.c_str(), &status) != 0 || status.f_blocks == 0) return unknown;  // 0: no disk, such as /proc
    return uint64_t(status.f_bavail) * uint64_t(status.f_frsize);
}

uint64_t parse_bytes(const std::string& name, const std::string& text) {
    size_t end = 0;
    double value = 0;
    try {
        value = std::stod(text, &end);
    } catch (const std::exception&) {
    }
    static constexpr std::string_view units = "KMG";
    const std::string unit = text.substr(end);
    const size_t power = unit.empty() ? 0 : units.find(unit) + 1;
    const double bytes = value * double(uint64_t(1) << (10 * std::min(power, units.size())));
    const bool known_unit = unit.empty() || (unit.size() == 1 && power > 0);
    if (!known_unit || !(bytes >= 1 && bytes < 1e18))
        throw UserError(fmt::format("{} '{}': give bytes, such as 64M or 2G", name, text));
    return uint64_t(bytes);
}
std::string bytes_text(uint64_t bytes) {
    size_t power = 0;
    for (; power < 3 && bytes % 1024 == 0 && bytes > 0; ++power) bytes /= 1024;
    return fmt::format("{}{}", bytes, std::string_view(" KMG").substr(power, power > 0));
}

std::string readable_bytes(uint64_t bytes) {
    constexpr const char* units[] = {"B", "kB", "MB", "GB", "TB", "PB", "EB"};
    double value = double(bytes);
    size_t unit = 0;
    for (; value >= 999.5 && unit + 1 < std::size(units); ++unit) value /= 1000;
    return fmt::format("{:.{}f} {}", value, unit > 0 && value < 9.95 ? 1 : 0, units[unit]);
}

void announce_needs(const std::string& task, const Needs& needs, const fs::path& output, bool force) {
    const uint64_t memory = available_memory(), disk = free_disk(output);
    const auto free = [](uint64_t bytes) { return bytes == unknown ? "unknown" : readable_bytes(bytes); };
    const std::string line = fmt::format("{} needs about {} of memory ({} free) and {} of disk for {} ({} free)", task,
                                         readable_bytes(needs.memory), free(memory), readable_bytes(needs.disk),
                                         output.string(), free(disk));
    if (needs.memory <= memory && needs.disk <= disk) return log_info(line);
    const char* cure =
        needs.memory > memory ? "close other programs or choose smaller sizes" : "make room or choose another disk";
    if (!force) throw UserError(fmt::format("{}: {}, or go on all the same with {}", line, cure, option_name("force")));
    log_warning(line);
}

}  // namespace radiafit
