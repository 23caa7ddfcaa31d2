#include "optim/trace.h"

#include <fmt/format.h>

namespace radiafit {

std::string trace_csv(const Trace& trace, const std::string& solver, const std::string& engine) {
    std::string csv = "solver,engine,iteration,time_s,error,accepted,active\n";
    for (const TraceRow& r : trace.rows)
        csv += fmt::format("{},{},{},{:.6f},{:.9g},{},{}\n", solver, engine, r.iteration, r.time_s, r.error, r.accepted,
                           r.active);
    return csv;
}

}  // namespace radiafit
