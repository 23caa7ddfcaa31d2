#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

namespace radiafit {

/// Joules that the processor packages take, by the counters that Linux shows in /sys/class/powercap (RAPL; of Intel and
/// AMD), which most systems let only root read and virtual machines don't have. Memory and graphics cards are not in
/// it.
class EnergyMeter {
public:
    /// Reads the counters below `root` (of another root in tests).
    explicit EnergyMeter(const std::filesystem::path& root = "/");

    /// Since the meter was made; none where there is no counter to read. Counters run over after 4 to 260 kJ: ask at
    /// least once in half a minute.
    std::optional<double> joules();

private:
    struct Counter {
        std::filesystem::path file;
        uint64_t range, last;  ///< microjoules: where it runs over; when it was read last
    };
    std::vector<Counter> counters_;
    double joules_ = 0;
};

}  // namespace radiafit
