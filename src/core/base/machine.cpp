#include "base/machine.h"

#include <fmt/format.h>
#include <link.h>
#include <sys/utsname.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>
#include <string_view>
#if defined(__x86_64__) || defined(__i386__)
#include <cpuid.h>
#endif

namespace radiafit {
namespace fs = std::filesystem;
namespace {

std::string trimmed(const std::string& text) {
    constexpr const char* blanks = " \t\r\n";
    const size_t begin = text.find_first_not_of(blanks);
    return begin == std::string::npos ? "" : text.substr(begin, text.find_last_not_of(blanks) - begin + 1);
}

/// The first line of a file; empty if there is none.
std::string first_line(const fs::path& file) {
    std::string line;
    std::getline(std::ifstream(file), line);
    return trimmed(line);
}

/// "name<separator>value" line by line, up to the first empty line: of /proc/cpuinfo the first processor.
std::map<std::string, std::string> pairs_of(const fs::path& file, char separator) {
    std::map<std::string, std::string> pairs;
    std::ifstream stream(file);
    for (std::string line; std::getline(stream, line) && !line.empty();)
        if (const size_t at = line.find(separator); at != std::string::npos)
            pairs.emplace(trimmed(line.substr(0, at)), trimmed(line.substr(at + 1)));
    return pairs;
}

template <class Number>
std::optional<Number> number_of(const std::string& text) {
    std::istringstream stream(text);
    stream.imbue(std::locale::classic());
    Number number{};
    return stream >> number ? std::optional(number) : std::nullopt;
}

std::string joined(std::initializer_list<std::string> words) {
    std::string line;
    for (const std::string& word : words)
        if (!word.empty()) line += (line.empty() ? "" : " ") + word;
    return line;
}

std::string kernel_of(const fs::path& root) {
    const fs::path kernel = root / "proc/sys/kernel";
    utsname here{};
    return joined({first_line(kernel / "ostype"), first_line(kernel / "osrelease"),
                   uname(&here) == 0 ? here.machine : "", first_line(kernel / "version")});
}

std::string distribution_of(const fs::path& root) {
    auto release = pairs_of(root / "etc/os-release", '=');
    std::string name = release["PRETTY_NAME"];
    std::erase(name, '"');
    return joined({name, release["ID"] == "debian" ? first_line(root / "etc/debian_version") : ""});
}

/// The hypervisor that the processor names where it says that it is virtual.
std::string hypervisor_name() {
#if defined(__x86_64__) || defined(__i386__)
    unsigned most = 0;
    std::array<unsigned, 3> words{};
    __cpuid(0x40000000, most, words[0], words[1], words[2]);
    std::string signature(sizeof words, '\0');
    std::memcpy(signature.data(), words.data(), sizeof words);
    std::erase_if(signature, [](char c) { return c < ' ' || c > '~'; });
    static const std::map<std::string_view, const char*> names = {
        {"KVMKVMKVM", "KVM"},     {"Microsoft Hv", "Hyper-V"},    {"VMwareVMware", "VMware"},
        {"XenVMMXenVMM", "Xen"},  {"TCGTCGTCGTCG", "QEMU's TCG"}, {"VBoxVBoxVBox", "VirtualBox"},
        {"ACRNACRNACRN", "ACRN"}, {"bhyve bhyve ", "bhyve"},
    };
    const auto known = names.find(signature);
    return known != names.end() ? known->second : signature.empty() ? "unknown" : signature;
#else
    return "unknown";
#endif
}

std::string container_of(const fs::path& root) {
    std::error_code ignored;
    if (fs::exists(root / ".dockerenv", ignored)) return "docker";
    if (fs::exists(root / "run/.containerenv", ignored)) return "podman";
    const char* named = std::getenv("container");  // by systemd-nspawn, LXC and others
    return named ? named : "";
}

std::optional<double> megahertz(const fs::path& kilohertz_file) {
    const auto kilohertz = number_of<double>(first_line(kilohertz_file));
    return kilohertz ? std::optional(*kilohertz / 1000) : std::nullopt;
}

}  // namespace

Machine read_machine(const fs::path& root) {
    Machine m;
    m.kernel = kernel_of(root);
    m.distribution = distribution_of(root);

    auto cpu = pairs_of(root / "proc/cpuinfo", ':');
    const auto part = [&](const char* word, const char* key) {
        return cpu[key].empty() ? std::string() : fmt::format("{}{}", word, cpu[key]);
    };
    m.cpu = cpu["model name"];
    m.cpu_id = joined({cpu["vendor_id"], part("family ", "cpu family"), part("model ", "model"),
                       part("stepping ", "stepping"), part("microcode ", "microcode")});
    const fs::path frequency = root / "sys/devices/system/cpu/cpu0/cpufreq";
    m.mhz = number_of<double>(cpu["cpu MHz"]);
    if (!m.mhz) m.mhz = megahertz(frequency / "scaling_cur_freq");
    m.mhz_max = megahertz(frequency / "cpuinfo_max_freq");
    m.governor = first_line(frequency / "scaling_governor");

    if (const auto kilobytes = number_of<uint64_t>(pairs_of(root / "proc/meminfo", ':')["MemTotal"]))
        m.memory_bytes = *kilobytes * 1024;
    m.hypervisor = first_line(root / "sys/hypervisor/type");
    if ((" " + cpu["flags"] + " ").find(" hypervisor ") != std::string::npos) m.hypervisor = hypervisor_name();
    const fs::path dmi = root / "sys/class/dmi/id";
    m.dmi = joined({first_line(dmi / "sys_vendor"), first_line(dmi / "product_name")});
    m.container = container_of(root);

    std::istringstream averages(first_line(root / "proc/loadavg"));
    averages.imbue(std::locale::classic());
    for (double average = 0; m.load.size() < 3 && averages >> average;) m.load.push_back(average);
    return m;
}

std::string processor_name(const std::string& model_name, const std::string& id) {
    const size_t family = id.find("family "), end = std::min(id.find(" stepping"), id.find(" microcode"));
    if (model_name.find_first_of("0123456789") != std::string::npos || family == std::string::npos) return model_name;
    return fmt::format("{} ({})", model_name, id.substr(family, end - family));
}

std::vector<std::string> loaded_libraries() {
    std::vector<std::string> paths, names;
    dl_iterate_phdr(
        [](dl_phdr_info* info, size_t, void* into) {
            if (info->dlpi_name && *info->dlpi_name)  // the program itself has no name
                static_cast<std::vector<std::string>*>(into)->emplace_back(info->dlpi_name);
            return 0;
        },
        &paths);
    for (const std::string& path : paths) {
        std::error_code error;
        const fs::path file = fs::canonical(path, error);
        names.push_back((error ? fs::path(path) : file).filename().string());
    }
    std::ranges::sort(names);
    names.erase(std::ranges::unique(names).begin(), names.end());
    return names;
}

}  // namespace radiafit
