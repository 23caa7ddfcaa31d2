#include "fragment/device_engine.h"

#include <bit>

namespace radiafit {

void DeviceNumbers::reset(std::span<const uint32_t> samples) {
    std::vector<Status> status(count_);
    for (size_t i = 0; i < count_; ++i)
        status[i] = samples[i * samples.size() / count_] ? Status::active : Status::no_samples;
    write_fresh(status);
}

void DeviceNumbers::outcomes(std::span<ProblemOutcome> out) const {
    using real = float;  // HUGE_ERROR is text shared with GLSL
    const std::vector<float> all = read({number::error, number::status, number::iterations});
    for (size_t i = 0; i < count_; ++i) {
        out[i] = {all[i] < HUGE_ERROR ? all[i] : 0, Status(int(all[count_ + i])), uint32_t(all[2 * count_ + i])};
        if (out[i].status == Status::active) out[i].status = Status::max_iterations;
    }
}

void DeviceNumbers::read_errors(std::span<float> out) const { std::ranges::copy(read({number::error}), out.begin()); }

Defines step_defines(Step which, const Turn& turn) {
    const StepName& name = steps[int(which)];
    const Defines text{{"TEXT", name.file}, {"STEP", name.function}};
    if (!turn.left_out) return text;
    return text + Defines{{"LEFT_OUT", std::to_string(turn.left_out)}, {"FIRST_STEP", std::to_string(turn.first_step)}};
}

Defines update_defines(Update which) {
    const UpdateShape& shape = updates[int(which)];
    return {{"TEXT", shape.file},
            {"UPDATE", shape.function},
            {"VECTORS", std::to_string(shape.vectors)},
            {"WRITTEN", std::to_string(shape.written)},
            {"NUMBERS", std::to_string(shape.numbers)},
            {"PRODUCTS", std::to_string(shape.products)}};
}

EngineSummary sum_of(std::span<const std::array<uint32_t, 4>> groups) {
    EngineSummary sum;
    for (const auto& [active, accepted, upper, lower] : groups) {
        sum.active += active;
        sum.accepted += accepted;
        sum.error += double(std::bit_cast<float>(upper)) + double(std::bit_cast<float>(lower));
    }
    return sum;
}

}  // namespace radiafit
