#pragma once
#include <cstdint>
#include <filesystem>
#include <string>

/// What is left of the machine's memory and disk, and whether a task fits into it.
namespace radiafit {

/// Bytes that this process may still take before something is paged out or killed: the least of what the kernel says is
/// available, what the control groups of this process have left, and RLIMIT_AS. The largest number if all are unknown.
uint64_t available_memory();

/// Bytes that this user may still write where `path` is, or would be made. The largest number if unknown.
uint64_t free_disk(const std::filesystem::path& path);

/// What a task will take, bytes, as far as it is known beforehand.
struct Needs {
    uint64_t memory = 0;
    uint64_t disk = 0;  ///< for its output, beside an earlier one that it replaces
};

/// Says in one line what `task` (such as "fit") needs and what is free. Throws UserError if that is too little; with
/// `force` a warning.
void announce_needs(const std::string& task, const Needs& needs, const std::filesystem::path& output, bool force);

/// "1.2 GB": three digits at most, powers of 1000.
std::string readable_bytes(uint64_t bytes);

/// Bytes as people write them, with K, M or G for powers of 1024: "64M". Throws UserError "NAME 'TEXT': ...".
uint64_t parse_bytes(const std::string& name, const std::string& text);
std::string bytes_text(uint64_t bytes);

namespace detail {

/// Bytes that the control groups of a process leave, and those above them: the groups as /proc/self/cgroup lists them,
/// below `tree`, such as /sys/fs/cgroup. Pages of files that nobody used of late count as free. The largest number
/// where no group has a limit.
uint64_t control_group_memory(const std::filesystem::path& process_groups, const std::filesystem::path& tree);

}  // namespace detail

}  // namespace radiafit
