#pragma once
#include <optional>
#include <span>
#include <vector>

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
/// Of what a loop measures in each round: whether others are compared with it, and how long it takes.
struct InRound {
    bool compared;
    double seconds;
};
/// Which of them have a place in rounds of so many seconds: those that are compared, however long they take, and of the
/// others the quickest, as many as fit beside them.
std::vector<bool> those_in_time(std::span<const InRound> all, double seconds);

/// That a round, or what it measures, was cut short.
void note_rounds_left_out();
/// Whether any round was left out or cut short so far.
bool rounds_left_out();

}  // namespace radiafit
