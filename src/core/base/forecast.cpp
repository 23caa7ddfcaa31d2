#include "base/forecast.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/clock.h"

namespace radiafit {
namespace {

constexpr size_t shares = 1000;  // of a task, that its bar tells apart

}  // namespace

size_t Forecast::add(size_t steps, double seconds_each) {
    parts_.push_back({steps, seconds_each});
    return parts_.size() - 1;
}

void Forecast::took(size_t part, size_t steps, double seconds) {
    parts_[part].done += steps;
    parts_[part].seconds += seconds;
}

double Forecast::seconds_left() const {
    double measured = 0, expected = 0;
    for (const Part& p : parts_) {
        measured += p.seconds;
        expected += double(p.done) * p.expected;
    }
    const double ratio = expected > 0 ? measured / expected : 1;
    double left = 0;
    for (const Part& p : parts_) {
        const double each = p.done > 0 ? p.seconds / double(p.done) : ratio * p.expected;
        left += each * double(p.steps - std::min(p.done, p.steps));
    }
    return left;
}

ForecastProgress::ForecastProgress(const std::string& task, Forecast forecast)
    : forecast_(std::move(forecast)), progress_(task, shares, Progress::Shown::share) {
    announce_time(task, forecast_.seconds_left());
    start_s_ = last_s_ = wall_time_s();
}

void ForecastProgress::begin(size_t part) {
    std::scoped_lock lock(mutex_);
    part_ = part;
    last_s_ = wall_time_s();
}

void ForecastProgress::advance(size_t steps) {
    std::scoped_lock lock(mutex_);
    const double now = wall_time_s();
    forecast_.took(part_, steps, now - last_s_);
    last_s_ = now;
    const double passed = now - start_s_, all = passed + forecast_.seconds_left();
    progress_.set(all > 0 ? size_t(double(shares) * passed / all) : 0);
}

void ForecastProgress::add_steps(size_t part, size_t steps) {
    std::scoped_lock lock(mutex_);
    forecast_.add_steps(part, steps);
}

void announce_time(const std::string& task, double seconds) {
    constexpr double worth_a_line = 3;
    if (seconds >= worth_a_line) log_info(fmt::format("{}: about {}", task, duration(seconds)));
}

}  // namespace radiafit
