# Wall-clock seconds that a chain of steps will still take, by the processor time that its steps took: a step that waited for a
# machine that was busy otherwise says nothing of those to come.
# Usage: awk -f time_left.awk -v cores=N      N: threads that a step may run
# Input, a line for each step: STATE KIND EXPECTED [WALL PROCESSOR]
#   STATE     done, now (the step that runs) or coming
#   KIND      of EXPECTED: all, processor seconds on all cores; one, processor seconds on one core; clock, wall-clock seconds that
#             were asked for, however fast the machine is
#   WALL, PROCESSOR   seconds that the step took, or took so far
# Of two machines one may be faster: what steps are expected to take is scaled by what those that are done took. Where most of
# these waited, all that come are taken to wait alike; one alone changes nothing. A step that takes longer than expected is
# taken to be nine tenths done, so that what is left is never nothing.
function threads(kind) { return kind == "all" ? cores : 1 }
function left(expected, used) { return expected - used > used / 9 ? expected - used : used / 9 }
$2 != "clock" && $1 == "done" {
    expected += $3
    used += $5
    if ($5 >= 5) waits[++count] = $4 * threads($2) / $5  # 1: it had all cores that it can use
}
{ state[NR] = $1; kind[NR] = $2; cost[NR] = $3; wall[NR] = $4; processor[NR] = $5 }
END {
    prior = 10  # seconds that as expected count as much as those that were measured
    scale = (used + prior) / (expected + prior)
    waits[++count] = 1
    for (i = 2; i <= count; ++i)
        for (j = i; j > 1 && waits[j] < waits[j - 1]; --j) {
            swap = waits[j]
            waits[j] = waits[j - 1]
            waits[j - 1] = swap
        }
    wait = waits[int((count + 1) / 2)]  # the lower median
    if (wait < 1) wait = 1
    for (i = 1; i <= NR; ++i) {
        if (state[i] == "done") continue
        if (kind[i] == "clock")
            all += left(cost[i], wall[i])
        else
            all += wait * left(scale * cost[i], processor[i]) / threads(kind[i])
    }
    printf "%d\n", all < 1 ? 1 : all + 0.5
}
