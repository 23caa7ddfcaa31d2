#pragma once
#include <optional>

#include "bench/device.h"
#include "fragment/pass_runner.h"

/// What passes over samples take: what fragment programs declare, or of the CPU and of compute shaders the least that
/// there is: the model's arithmetic (a multiply-add is two operations), every sample once in each order that the
/// pass reads, and vectors of parameters once. A penalty, addresses and what is read again are not in it.
namespace radiafit::harness {

struct PassLoad {
    std::optional<double> operations = {}, reads = {}, bytes = {};  ///< none where that is not known
};

/// How a device keeps what it reads.
struct Kept {
    double sample_bytes = 0;     ///< of a sample
    double gradient_orders = 0;  ///< in which it reads all samples for a gradient: kept in each
    double parameter_bytes = 0;  ///< of a vector
};

PassLoad light_field_load(Pass pass, double samples, int terms, const Kept& kept);
PassLoad lafortune_load(Pass pass, double samples, const Kept& kept);

/// What fragment programs declare (fragment/pass_costs.h), times how often they run while body() does.
template <class Body>
PassLoad declared_load(PassRunner& passes, const Body& body) {
    passes.tally(true);
    body();
    passes.tally(false);
    Work sum;
    uint64_t written = passes.cleared_bytes();
    for (const auto& [label, tally] : passes.tallies()) {
        if (!tally.cost) return {};
        sum += tally.work();
        written += tally.written_bytes + tally.blended_bytes;
    }
    return {double(sum.operations), double(sum.reads), double(sum.read_bytes + written)};
}

}  // namespace radiafit::harness
