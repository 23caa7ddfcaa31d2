#pragma once

/// How long a program measures: rounds end where the next one would be over too late.
namespace radiafit {

/// From now on, of this process; without, there is no limit.
void limit_time(double minutes);

/// For loops over rounds: whether there is another one after so many. The first always is, and so is one that, by those
/// of the loop so far, is done in time. Says once where rounds are left out.
bool another_round(int done, int wanted);

}  // namespace radiafit
