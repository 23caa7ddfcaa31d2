#include "optim/trace.h"

#include <fmt/format.h>

namespace radiafit {

void Trace::append(const Trace& stage) {
    const int before = rows.empty() ? 0 : rows.back().iteration;
    const double time = rows.empty() ? 0 : rows.back().time_s;
    for (size_t k = rows.empty() ? 0 : 1; k < stage.rows.size(); ++k) {
        TraceRow row = stage.rows[k];
        row.iteration += before;
        row.time_s += time;
        rows.push_back(row);
    }
}

std::string trace_csv(const Trace& trace, const std::string& solver, const std::string& engine) {
    std::string csv = "solver,engine,iteration,time_s,error,accepted,active\n";
    for (const TraceRow& r : trace.rows)
        csv += fmt::format("{},{},{},{:.6f},{:.9g},{},{}\n", solver, engine, r.iteration, r.time_s, r.error, r.accepted,
                           r.active);
    return csv;
}

}  // namespace radiafit
