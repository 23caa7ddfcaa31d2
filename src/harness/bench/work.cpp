#include "bench/work.h"

namespace radiafit::harness {
namespace {

double bytes(Pass pass, double samples, const Kept& kept) {
    // A gradient reads the point and leaves as much; a line reads the point and the direction.
    const double orders = pass == Pass::gradient ? kept.gradient_orders : 1;
    return orders * samples * kept.sample_bytes + 2 * kept.parameter_bytes;
}

bool is_over_samples(Pass pass) { return pass == Pass::gradient || pass == Pass::line; }

}  // namespace

PassLoad light_field_load(Pass pass, double samples, int terms, const Kept& kept) {
    if (!is_over_samples(pass)) return {};
    // Of each channel: the target's weight (1), the residual r (2 a term); then r^2 (2), and r times either map (4 a
    // term); or the first and second derivative along the line (4 and 2 a term), and four sums of products (8).
    const double channel = pass == Pass::gradient ? 3 + 6 * terms : 9 + 8 * terms;
    constexpr double vertices = 3, channels = 3;
    return {.operations = samples * vertices * channels * channel, .bytes = bytes(pass, samples, kept)};
}

PassLoad lafortune_load(Pass pass, double samples, const Kept& kept) {
    if (!is_over_samples(pass)) return {};
    // The lobe (9), value and residual (12); then the error (6), the coefficients' slopes (12), the shape's three (17);
    // or the lobe's derivatives along the line (18), those of the value (24), and two sums of products (12).
    const double sample = pass == Pass::gradient ? 9 + 12 + 6 + 12 + 17 : 9 + 12 + 18 + 24 + 12;
    return {.operations = samples * sample, .bytes = bytes(pass, samples, kept)};
}

}  // namespace radiafit::harness
