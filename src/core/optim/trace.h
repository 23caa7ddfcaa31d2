#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace radiafit {

/// One row per iteration, the same for every solver; row 0 is the start.
struct TraceRow {
    int iteration = 0;
    double time_s = 0;      ///< wall time since the solver started
    double error = 0;       ///< sum of E_t over the problems
    uint64_t accepted = 0;  ///< problems whose trial was accepted
    uint64_t active = 0;    ///< problems still running
};

struct Trace {
    std::vector<TraceRow> rows;
    /// A further stage: iterations and times go on from the last row, which is the stage's start as well.
    void append(const Trace& stage);
};

/// How a solver ended, for people: "all 25 iterations used, the last lowered the error by 0.02 %", "3 of 486 problems
/// used all 25 iterations, ..." or "all problems done after 12 iterations"; empty of a trace without iterations.
/// capped: problems that ended with Status::max_iterations, of `problems` that have samples.
std::string ending_of(const Trace& trace, uint64_t capped, uint64_t problems);

/// Traces of problems that were solved one after another, added up row by row: a trace that ends early goes on as it
/// ended, with nothing accepted and nothing active.
class TraceSum {
public:
    void add(const std::vector<TraceRow>& rows);
    const std::vector<TraceRow>& rows() const { return rows_; }
    std::vector<TraceRow>& rows() { return rows_; }

private:
    std::vector<TraceRow> rows_;
};

/// The trace of problems that several threads solved one after another: sums in the order of `parts`, whichever thread
/// made them; time_s is what all took, over the threads.
Trace sum_over_threads(const std::vector<TraceSum>& parts, int threads);

/// CSV with columns solver,engine,iteration,time_s,error,accepted,active.
std::string trace_csv(const Trace& trace, const std::string& solver, const std::string& engine);

}  // namespace radiafit
