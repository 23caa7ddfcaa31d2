#pragma once
#include <cstddef>
#include <functional>
#include <vector>

namespace radiafit {

struct TriedGroup {
    size_t invocations;  ///< of a work group
    double seconds;
};

/// Work groups of 32, 64 and 128 invocations on the current context's device, in turn: run(invocations) does the same
/// work by groups of that size. The least of some repetitions each, of so many runs as take long enough. Waits.
std::vector<TriedGroup> try_groups(const std::function<void(size_t invocations)>& run);
/// The fastest; a smaller one where it is slower by 5 % at most, since sums depend on the size in their last bits, and
/// a fit should give the same again.
size_t best_group(const std::vector<TriedGroup>& tried);

/// Whether sizes are worth trying: not in software, nor where RADIAFIT_GROUP_SIZE says which.
bool group_size_is_open();

/// try_groups() with a pass like those over samples, whose groups have so many work items each; for each device
/// and count once in the life of the program.
const std::vector<TriedGroup>& group_trial(size_t items);

}  // namespace radiafit
