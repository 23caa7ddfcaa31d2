#pragma once
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "bench/contestant.h"

/// Rounds of measurements: in each, the machine's peaks and every device's every pass once, so that what slows the
/// machine for a while meets all of them.
namespace radiafit::harness {

/// Rates per second; 0 where there is no such thing.
struct DevicePeaks {
    double operations = 0, reads = 0, bytes = 0;
};
using Peaks = std::map<Device, DevicePeaks>;
/// The peaks of these devices; for those of OpenGL a context must be current.
Peaks measure_peaks(const std::vector<Device>& devices);

/// Values by repetition.
struct Series {
    std::vector<double> seconds, streaming_s;  ///< of one run of the pass; of it: handing images to the device
};

/// A device on a scene.
struct Timed {
    std::string scene;
    Device device;
    std::unique_ptr<TimedDevice> contestant;
    std::map<Pass, int> times = {};  ///< runs of a measurement: as many as take long enough to time
    std::map<Pass, Series> series = {};
};

/// Runs each pass until nothing is compiled or allocated any more, and finds how often it has to run.
void warm_up(Timed& timed);
void measure_round(std::vector<Timed>& all);

}  // namespace radiafit::harness
