#include "basis/solve_on_device.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <string>

#include "base/error.h"
#include "base/parallel.h"
#include "gl/context.h"
#include "gl/group_trial.h"
#include "gl/program.h"

namespace radiafit::fits {
namespace {

constexpr size_t floats_at_once = size_t(1) << 22;  ///< of samples and solutions
constexpr size_t view_terms = 28;                   // VIEW_TERMS of model/view_basis.glsl

/// As the shader has it.
struct Texel {
    uint32_t first_sample, samples, block, number;
};

std::vector<float> floats_of(std::span<const Vec3f> vectors) {
    std::vector<float> out;
    for (const Vec3f& v : vectors) out.insert(out.end(), v.begin(), v.end());
    return out;
}

/// The shader, by invocations of a work group.
class Programs {
public:
    explicit Programs(const DeviceBasis& basis)
        : basis_(&basis), functions_(std::vector(basis.numbers.begin(), basis.numbers.end())) {
        if (basis.by_light()) lamps_.emplace(floats_of(basis.lamps));
        if (basis.by_half()) halves_.emplace(floats_of(basis.halves));
    }
    Program& of(size_t usual) {
        const size_t columns = size_t(basis_->rank) + (basis_->by_light() ? 1 : 3);
        const size_t terms = basis_->by_light() ? basis_->lamps.size() : view_terms;
        const size_t lanes =
            Context::current().group_size(usual, 4 * (columns + 1), 2 * columns * (columns + 1) + 12 * terms);
        if (const size_t bytes = lanes * 4 * (columns + 1) + 2 * columns * (columns + 1) + 12 * terms;
            int64_t(bytes) > Context::current().limits().shared_bytes)
            throw UserError(
                fmt::format("a basis of rank {} takes {} bytes of the device's shared memory, which has {}; "
                            "choose a smaller one, or the processor",
                            basis_->rank, bytes, Context::current().limits().shared_bytes));
        Program& program = programs_[lanes];
        if (!program) {
            Defines defines = {{"LANES", std::to_string(lanes)},
                               {"RANK", std::to_string(basis_->rank)},
                               {"LIGHT", basis_->by_light() ? "1" : "0"}};
            if (basis_->by_light()) defines.emplace_back("TERMS", std::to_string(terms));
            if (basis_->by_half()) defines.emplace_back("HALF", "1");
            program = Program::compute("compute/basis.comp", defines);
            program.bind("Basis", functions_);
            if (basis_->by_light()) {
                program.bind("Lamps", *lamps_);
                program.set("length_between", basis_->length);
            }
            if (basis_->by_half()) {
                program.bind("LampHalves", *halves_);
                program.set("half_length", basis_->half_length);
                program.set("half_share", basis_->half_share);
            }
            program.set("noise", basis_->noise);
        }
        return program;
    }

private:
    const DeviceBasis* basis_;
    Buffer functions_;
    std::optional<Buffer> lamps_, halves_;
    std::map<size_t, Program> programs_;
};

}  // namespace

uint64_t bytes_on_device() { return 3 * floats_at_once * sizeof(float); }

void solve_on_device(const DeviceBasis& basis, const DeviceUnits& units) {
    const size_t z = (basis.by_light() ? 1 : 3) * size_t(basis.rank), numbers = z + 1;
    Programs programs(basis);
    size_t usual = group_size_is_open() ? 0 : 64;  // 0: tried with the first texels
    std::vector<std::vector<DeviceTexel>> read;
    for (size_t begin = 0, end = 0; begin < units.count; begin = end) {
        for (size_t floats = 0; end < units.count && floats < floats_at_once; ++end) {
            const auto [samples, texels] = units.size_of(end);
            floats += (basis.by_half() ? 9 : 6) * samples + (4 + numbers) * texels;
        }
        read.resize(std::max(read.size(), end - begin));
        parallel_for(end - begin, 16, [&](size_t i, int) { units.read(begin + i, read[i]); });
        std::vector<Texel> texels;
        std::vector<SeenColour> seen;
        std::vector<Vec3f> halves;
        for (size_t i = 0; i < end - begin; ++i)
            for (const DeviceTexel& texel : read[i]) {
                texels.push_back({uint32_t(seen.size()), uint32_t(texel.samples.size()), texel.block, texel.number});
                seen.insert(seen.end(), texel.samples.begin(), texel.samples.end());
                halves.insert(halves.end(), texel.halves.begin(), texel.halves.end());
            }
        if (texels.empty()) continue;
        std::vector<float> solved(texels.size() * numbers);
        const Buffer of_texels(texels), of_samples(seen), solutions(solved);
        std::optional<Buffer> of_halves;
        if (basis.by_half()) of_halves.emplace(halves);
        const auto solve = [&](size_t invocations) {
            const Program& program = programs.of(invocations);
            program.bind("Texels", of_texels);
            program.bind("Samples", of_samples);
            if (of_halves) program.bind("Halves", *of_halves);
            program.bind("Solutions", solutions);
            program.set("texel_count", int(texels.size()));
            program.dispatch(texels.size());
        };
        if (usual == 0) usual = best_group(try_groups(solve));
        solve(usual);
        solutions.read(0, solved.size() * sizeof(float), solved.data());
        for (size_t i = 0; i < texels.size(); ++i)
            units.take(texels[i].number, {&solved[i * numbers], z}, solved[i * numbers + z]);
    }
}

}  // namespace radiafit::fits
