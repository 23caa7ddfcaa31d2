#include "compute/sample_sweeps.h"

#include "fragment/map_vector.h"
#include "gl/context.h"

namespace radiafit {

Accumulate accumulate_here(Accumulate wanted) {
    const bool here = Context::current().has_extension("GL_NV_shader_atomic_float");
    return wanted == Accumulate::scatter_float && !here ? Accumulate::scatter_swap : wanted;
}

const char* describe(Accumulate accumulate) {
    switch (accumulate) {
        case Accumulate::gather:
            return "gathered sums";
        case Accumulate::scatter_fixed:
            return "scattered sums in 64-bit fixed point";
        case Accumulate::scatter_float:
            return "scattered sums of floats, by atomic addition";
        case Accumulate::scatter_swap:
            break;
    }
    return "scattered sums of floats, by compare and swap: the driver has no atomic addition of floats";
}

Program SweepResources::program(const std::string& file, const Defines& more) const {
    Program made = Program::compute("compute/" + file, problems.defines() +
                                                           Defines{{"TERMS", std::to_string(options.terms)},
                                                                   {"VIEW_SIDE", std::to_string(options.view_side)}} +
                                                           loss_defines(options.loss) + more);
    tables.bind_to(made);
    problems.bind_to(made);
    made.set_if_used("lambda_surface", options.lambda_surface);
    made.set_if_used("mu", options.mu);
    made.set_if_used("bounds", options.lower, options.upper);
    made.set_if_used("paper_penalty", int(options.mode == Mode::paper));
    return made;
}

Program SweepResources::program_over(int vector, const std::string& file, const Defines& more) const {
    Program made = program(file, more);
    made.bind("maps", vectors[size_t(vector)].texture);
    return made;
}

const SweepTimes& SampleSweeps::times() const {
    static const SweepTimes none;
    return none;
}

}  // namespace radiafit
