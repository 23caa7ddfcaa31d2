#include "base/time_limit.h"

#include <fmt/format.h>

#include "base/clock.h"
#include "base/log.h"

namespace radiafit {
namespace {

double end_s = 0;       // of wall_time_s(); 0: no limit
double loop_begin = 0;  // of the loop that runs

}  // namespace

void limit_time(double minutes) { end_s = wall_time_s() + 60 * minutes; }

bool another_round(int done, int wanted) {
    if (done >= wanted) return false;
    const double now = wall_time_s();
    if (done == 0) {
        loop_begin = now;
        return true;
    }
    if (end_s == 0 || now + (now - loop_begin) / done <= end_s) return true;
    log_warning(fmt::format("{} of {} rounds, as the time is up: intervals are wider, or missing", done, wanted));
    return false;
}

}  // namespace radiafit
