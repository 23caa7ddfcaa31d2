#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "bench/device.h"
#include "gl/context.h"

namespace radiafit::harness {

struct BenchOptions {
    std::string scale = "standard";
    std::vector<Device> devices;  ///< in the order of the enumeration
    bool every_device = true;     ///< that this machine has
    int repetitions = 9;
    int threads = 0;       ///< of the CPU; 0: all cores
    double minutes = 0;    ///< in which rounds are to be done; 0: no limit
    bool all = false;      ///< measure_all()
    bool replace = false;  ///< an archive of --all that is there
    ContextOptions context;
    bool chosen_renderer = false;              ///< by platform or number
    std::filesystem::path output = "results";  ///< of --all an archive
    bool list = false;
};

/// None where only help or the version was asked for, and printed. Throws UserError: one line that names option and
/// cure. Sets the number of threads.
std::optional<BenchOptions> parse_bench_options(int argc, const char* const* argv);

}  // namespace radiafit::harness
