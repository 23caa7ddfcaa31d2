#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bench/scene.h"
#include "bench/timing.h"
#include "fragment/half_rounding.h"
#include "report/result_folder.h"

/// What radiafit-bench writes and shows; columns.h says what every column is.
namespace radiafit::harness {

/// How a device agrees with the CPU in double on a scene.
struct Checked {
    std::string scene;
    Device device;
    Agreement sums = {};
    double fit_difference = 0, fit_tolerance = 0;
    std::string failure = {};  ///< why it could not run at all

    /// Where it does not agree, in words; empty where it does.
    std::string disagreement() const;
};

struct BenchResults {
    std::vector<std::pair<std::string, SceneFacts>> scenes = {};
    std::vector<Checked> checked = {};
    std::vector<Timed> timed = {};
    std::vector<Peaks> peaks = {};  ///< [repetition]
    std::vector<HalfRounding> halves = {};
    std::string renderer;   ///< of OpenGL's devices
    std::string processor;  ///< of the devices without OpenGL
};

void write_rows(const BenchResults& results, const ResultFolder& folder);
/// For people.
std::string agreement_table(const std::vector<Checked>& checked);
std::string time_table(const BenchResults& results);

}  // namespace radiafit::harness
