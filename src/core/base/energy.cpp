#include "base/energy.h"

#include <algorithm>
#include <fstream>
#include <string>

namespace radiafit {
namespace fs = std::filesystem;
namespace {

std::optional<uint64_t> number_in(const fs::path& file) {
    std::ifstream stream(file);
    uint64_t number = 0;
    return stream >> number ? std::optional(number) : std::nullopt;
}

bool is_package(const fs::path& domain) {
    std::string name;
    std::getline(std::ifstream(domain / "name"), name);
    return name.starts_with("package");
}

}  // namespace

EnergyMeter::EnergyMeter(const fs::path& root) {
    std::error_code none;
    for (const auto& domain : fs::directory_iterator(root / "sys/class/powercap", none)) {
        if (!is_package(domain.path())) continue;
        const fs::path file = domain.path() / "energy_uj";
        const auto now = number_in(file), range = number_in(domain.path() / "max_energy_range_uj");
        if (now && range) counters_.push_back({file, *range, *now});
    }
}

std::optional<double> EnergyMeter::joules() {
    if (counters_.empty()) return {};
    for (Counter& counter : counters_) {
        const auto now = number_in(counter.file);
        if (!now) return {};
        joules_ += 1e-6 * double(*now >= counter.last ? *now - counter.last : counter.range - counter.last + *now);
        counter.last = *now;
    }
    return joules_;
}

}  // namespace radiafit
