#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// What a program runs on, as far as the system shows it to anyone: for records of results. Nothing of the host's name
/// or its users.
namespace radiafit {

/// What cannot be read is empty.
struct Machine {
    std::string kernel;                    ///< "Linux 6.1.0-35-amd64 x86_64 #1 SMP … Debian 6.1.137-1 (2025-05-07)"
    std::string distribution;              ///< "Debian GNU/Linux 12 (bookworm) 12.11"
    std::string cpu;                       ///< model name
    std::string cpu_id;                    ///< "AuthenticAMD family 25 model 1 stepping 1 microcode 0xa0011d5"
    std::optional<double> mhz, mhz_max;    ///< of the first processor: now, and the most that its governor may choose
    std::string governor;                  ///< of the first processor's frequency: "performance"
    std::optional<uint64_t> memory_bytes;  ///< that the system has
    std::string hypervisor;                ///< "KVM"; empty where the processor says that there is none
    std::string dmi;                       ///< "Amazon EC2 c7a.xlarge": maker and product
    std::string container;                 ///< "docker", "podman" or what $container says
    std::vector<double> load;              ///< averages over 1, 5 and 15 minutes
};

/// Reads some ten small files of the kernel's below `root` (of another root in tests); about a millisecond, never
/// fails.
Machine read_machine(const std::filesystem::path& root = "/");

/// A processor's model name; where that has no number ("AMD EPYC", as hypervisors say), its family and model with it,
/// which distinguish chips: "AMD EPYC (family 25 model 1)". `id` as Machine::cpu_id.
std::string processor_name(const std::string& model_name, const std::string& id);

/// File names of the shared libraries that this process has loaded by now, links resolved, such as "libceres.so.2.1.0";
/// sorted.
std::vector<std::string> loaded_libraries();

}  // namespace radiafit
