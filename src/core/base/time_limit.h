#pragma once

/// How long a program measures: rounds end where the next one would be over too late.
namespace radiafit {

/// From now on, of this process; without, there is no limit.
void limit_time(double minutes);
/// So many loops of rounds follow one another: each has its share of what is left.
void share_time(int loops);

/// For loops over rounds: whether there is another one after so many. The first always is, and so is one that, by those
/// of the loop so far, is done in time. Says where rounds are left out.
bool another_round(int done, int wanted);
/// Whether any round was left out so far.
bool rounds_left_out();

}  // namespace radiafit
