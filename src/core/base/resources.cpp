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
    uint64_t value = unknown;
    std::ifstream(file) >> value;
    return value == 0 && !fs::exists(file) ? unknown : value;
}

uint64_t left_of(uint64_t limit, uint64_t used) { return limit > used ? limit - used : 0; }

/// MemAvailable: what can be had without paging, caches that can go included.
uint64_t system_memory() {
    std::ifstream file("/proc/meminfo");
    for (std::string name; file >> name; file.ignore(256, '\n')) {
        uint64_t kilobytes = 0;
        if (name == "MemAvailable:" && file >> kilobytes) return kilobytes * 1024;
    }
    return unknown;
}

/// The least that the control group of this process and those above it leave; pages of files that can go count as free.
uint64_t control_group_memory() {
    uint64_t least = unknown;
    std::ifstream groups("/proc/self/cgroup");
    for (std::string line; std::getline(groups, line);) {
        if (!line.starts_with("0::")) continue;  // version 2
        const fs::path root = "/sys/fs/cgroup";
        for (fs::path group = root / fs::path(line.substr(3)).relative_path(); group != root.parent_path();
             group = group.parent_path()) {
            const uint64_t limit = number_in(group / "memory.max"), used = number_in(group / "memory.current");
            if (limit != unknown && used != unknown) least = std::min(least, left_of(limit, used));
        }
    }
    return least;
}

uint64_t address_space() {
    rlimit limit{};
    if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return unknown;
    const uint64_t pages = number_in("/proc/self/statm");
    return pages == unknown ? unknown : left_of(limit.rlim_cur, pages * uint64_t(sysconf(_SC_PAGESIZE)));
}

}  // namespace

uint64_t available_memory() { return std::min({system_memory(), control_group_memory(), address_space()}); }

uint64_t free_disk(const fs::path& path) {
    std::error_code error;
    fs::path existing = fs::absolute(path, error);
    while (!fs::exists(existing, error) && existing.has_relative_path()) existing = existing.parent_path();
    struct statvfs status {};
    if (statvfs(existing.c_str(), &status) != 0 || status.f_blocks == 0) return unknown;  // 0: no disk, such as /proc
    return uint64_t(status.f_bavail) * uint64_t(status.f_frsize);
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
