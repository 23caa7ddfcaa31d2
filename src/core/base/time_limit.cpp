#include "base/time_limit.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "base/clock.h"
#include "base/log.h"

namespace radiafit {
namespace {

double end_s = 0;  // of wall_time_s(); 0: no limit
int loops_left = 1;
double loop_begin = 0, loop_end = 0;  // of the loop that runs
bool left_out = false;

}  // namespace

void limit_time(double minutes) { end_s = wall_time_s() + 60 * minutes; }

void share_time(int loops) { loops_left = loops; }

bool time_is_limited() { return end_s > 0; }

double seconds_left() { return time_is_limited() ? loop_end - wall_time_s() : std::numeric_limits<double>::infinity(); }

bool another_round(int done, int wanted, std::optional<double> seconds) {
    if (done >= wanted) return false;
    const double now = wall_time_s();
    if (done == 0) {
        loop_begin = now;
        loop_end = now + (end_s - now) / loops_left;
        loops_left = std::max(1, loops_left - 1);
        return true;
    }
    if (!time_is_limited() || now + seconds.value_or((now - loop_begin) / done) <= loop_end) return true;
    log_warning(fmt::format("{} of {} rounds, as the time is up: intervals are wider, or missing", done, wanted));
    left_out = true;
    return false;
}

std::vector<bool> those_in_time(std::span<const InRound> all, double seconds) {
    std::vector<size_t> others;
    std::vector<bool> chosen(all.size());
    for (size_t i = 0; i < all.size(); ++i) {
        chosen[i] = all[i].compared;
        if (all[i].compared)
            seconds -= all[i].seconds;
        else
            others.push_back(i);
    }
    std::ranges::stable_sort(others, {}, [&](size_t i) { return all[i].seconds; });
    for (const size_t i : others) {
        seconds -= all[i].seconds;
        chosen[i] = seconds >= 0;
    }
    return chosen;
}

void note_rounds_left_out() { left_out = true; }

bool rounds_left_out() { return left_out; }

}  // namespace radiafit
