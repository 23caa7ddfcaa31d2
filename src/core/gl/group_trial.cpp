#include "gl/group_trial.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "base/clock.h"
#include "base/rng.h"
#include "gl/context.h"
#include "gl/program.h"
#include "gl/texture.h"

namespace radiafit {

std::vector<TriedGroup> try_groups(const std::function<void(size_t)>& run) {
    constexpr double long_enough_s = 0.004;
    constexpr int repetitions = 3;
    std::vector<TriedGroup> tried;
    for (const size_t size : {32, 64, 128}) tried.push_back({size, 1e9});
    const auto seconds_of = [&](size_t size, int times) {
        gl().Finish();
        const double start = wall_time_s();
        for (int i = 0; i < times; ++i) run(size);
        gl().Finish();
        return wall_time_s() - start;
    };
    for (const TriedGroup& group : tried) seconds_of(group.invocations, 1);  // compiles
    int times = 1;
    while (times < 1 << 12 && seconds_of(tried.front().invocations, times) < long_enough_s) times *= 2;
    for (int r = 0; r < repetitions; ++r)
        for (TriedGroup& group : tried)
            group.seconds = std::min(group.seconds, seconds_of(group.invocations, times) / times);
    return tried;
}

size_t best_group(const std::vector<TriedGroup>& tried) {
    const double least = std::ranges::min_element(tried, {}, &TriedGroup::seconds)->seconds;
    return std::ranges::find_if(tried, [&](const TriedGroup& g) { return g.seconds <= 1.05 * least; })->invocations;
}

bool group_size_is_open() {
    const char* asked = std::getenv("RADIAFIT_GROUP_SIZE");
    return !Context::current().software() && !(asked && *asked);
}

const std::vector<TriedGroup>& group_trial(size_t items) {
    static std::mutex mutex;
    static std::map<std::pair<std::string, size_t>, std::vector<TriedGroup>> known;
    const std::lock_guard lock(mutex);
    std::vector<TriedGroup>& tried = known[{Context::current().renderer(), items}];
    if (!tried.empty()) return tried;

    constexpr size_t samples = size_t(1) << 20, samples_each = 32, value_count = 1024;
    const size_t groups = std::max<size_t>(1, samples / samples_each / items);
    std::vector<uint32_t> words;
    Rng rng(1);
    for (size_t i = 0; i < groups * items * samples_each; ++i) words.push_back(rng.bits());
    const std::vector<float> numbers(4 * value_count, 0.5f);
    const Buffer word_buffer(words), value_buffer(numbers), sums(groups * 16, nullptr);
    const Texture fetched = Texture::of_buffer(GL_R32UI, word_buffer),
                  values = Texture::of_buffer(GL_RGBA32F, value_buffer);
    std::map<size_t, Program> programs;
    return tried = try_groups([&](size_t size) {
               Program& program = programs[size];
               if (program) return program.dispatch(groups);
               program = Program::compute("compute/group_trial.comp", {{"LANES", std::to_string(size)}});
               program.bind("words", fetched);
               program.bind("values", values);
               program.bind("Sums", sums);
               program.set("items", int(items));
               program.set("samples_each", int(samples_each));
               program.set("value_mask", int(value_count - 1));
               program.dispatch(groups);
           });
}

}  // namespace radiafit
