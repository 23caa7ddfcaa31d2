#include "optim/trace.h"

#include <fmt/format.h>

#include <algorithm>

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

std::string ending_of(const Trace& trace, uint64_t capped, uint64_t problems) {
    if (trace.rows.size() < 2) return "";
    const TraceRow &last = trace.rows.back(), &before = trace.rows[trace.rows.size() - 2];
    if (capped == 0) return fmt::format("all problems done after {} iterations", last.iteration);
    const double lowered = before.error > 0 ? 100 * (1 - last.error / before.error) : 0;
    const std::string who =
        capped < problems ? fmt::format("{} of {} problems used all {} iterations", capped, problems, last.iteration)
                          : fmt::format("all {} iterations used", last.iteration);
    return fmt::format("{}, the last lowered the error by {:.2g} %", who, lowered);
}

void TraceSum::add(const std::vector<TraceRow>& rows) {
    if (rows.empty()) return;
    while (rows_.size() < rows.size()) {
        rows_.push_back(rows_.empty() ? TraceRow{} : rows_.back());
        rows_.back().iteration = int(rows_.size()) - 1;
        rows_.back().accepted = rows_.back().active = 0;
    }
    for (size_t k = 0; k < rows_.size(); ++k) {
        const TraceRow& row = rows[std::min(k, rows.size() - 1)];
        rows_[k].error += row.error;
        rows_[k].time_s += row.time_s;
        if (k >= rows.size()) continue;
        rows_[k].accepted += row.accepted;
        rows_[k].active += row.active;
    }
}

Trace sum_over_threads(const std::vector<TraceSum>& parts, int threads) {
    TraceSum sum;
    for (const TraceSum& part : parts) sum.add(part.rows());
    Trace trace{sum.rows()};
    for (TraceRow& row : trace.rows) row.time_s /= threads;
    return trace;
}

std::string trace_csv(const Trace& trace, const std::string& solver, const std::string& engine) {
    std::string csv = "solver,engine,iteration,time_s,error,accepted,active\n";
    for (const TraceRow& r : trace.rows)
        csv += fmt::format("{},{},{},{:.6f},{:.9g},{},{}\n", solver, engine, r.iteration, r.time_s, r.error, r.accepted,
                           r.active);
    return csv;
}

}  // namespace radiafit
