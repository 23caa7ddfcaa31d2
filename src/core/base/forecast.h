#pragma once
#include <cstddef>
#include <mutex>
#include <string>
#include <vector>

#include "base/log.h"

namespace radiafit {

/// How long a task will still take whose parts have steps of different lengths. Steps of a part are taken to be alike:
/// where some were done, as these were; else as expected, times what the steps of other parts took against what was
/// expected of them.
class Forecast {
public:
    /// A part of so many steps, each expected to take so many seconds (above 0). Returns its number.
    size_t add(size_t steps, double seconds_each);
    /// So many more steps of the part are done, in so many more seconds altogether.
    void took(size_t part, size_t steps, double seconds);
    /// The part has so many more steps than were known.
    void add_steps(size_t part, size_t steps) { parts_[part].steps += steps; }
    double seconds_left() const;

private:
    struct Part {
        size_t steps;
        double expected;  ///< seconds of a step
        size_t done = 0;
        double seconds = 0;  ///< of those that are done
    };
    std::vector<Part> parts_;
};

/// Progress of such a task: says how long it will take before it begins, and shows its share by time. Parts follow one
/// another.
class ForecastProgress {
public:
    ForecastProgress(const std::string& task, Forecast forecast);

    void begin(size_t part);
    /// More steps of the part that was begun; any thread.
    void advance(size_t steps = 1);
    void add_steps(size_t part, size_t steps);
    void finish() { progress_.finish(); }

private:
    std::mutex mutex_;
    Forecast forecast_;
    Progress progress_;
    double start_s_, last_s_;
    size_t part_ = 0;
};

/// "render: about 2:10", where it is worth a line.
void announce_time(const std::string& task, double seconds);

}  // namespace radiafit
