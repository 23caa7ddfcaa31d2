#pragma once
#include <optional>

/// How long a program measures: rounds end where the next one would be over too late.
namespace radiafit {

/// From now on, of this process; without, there is no limit.
void limit_time(double minutes);
/// So many loops of rounds follow one another: each has its share of what is left.
void share_time(int loops);

/// Whether there is a limit.
bool time_is_limited();
/// Seconds that are left of the loop that runs; infinity without a limit.
double seconds_left();

/// For loops over rounds: whether there is another one after so many. The first always is, and so is one that is done
/// in time if it takes so many seconds; unless told, as many as those of the loop so far. Says where rounds are left
/// out.
bool another_round(int done, int wanted, std::optional<double> seconds = {});
/// Of a round that left something out.
void note_rounds_left_out();
/// Whether any round was left out so far, or something of one.
bool rounds_left_out();

}  // namespace radiafit
