#include "fragment/pass_runner.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace radiafit {

std::vector<Defines> result_defines(int results, bool one_target) {
    if (!one_target || results == 1) return {Defines{}};
    std::vector<Defines> each;
    for (int i = 0; i < results; ++i) each.push_back({{"ONLY", std::to_string(i)}});
    return each;
}

std::vector<Framebuffer> result_targets(const std::vector<Target>& results, bool one_target) {
    std::vector<Framebuffer> targets;
    if (one_target)
        for (const Target& result : results) targets.push_back(Framebuffer({result}));
    else
        targets.push_back(Framebuffer(results));
    return targets;
}

PassRunner::~PassRunner() {
    if (query_) gl().DeleteQueries(1, &query_);
}

void PassRunner::tally(bool on) {
    if (on) {
        tallies_.clear();
        cleared_bytes_ = 0;
        if (!query_) gl().GenQueries(1, &query_);
    }
    tallying_ = on;
}

void PassRunner::add_draw(uint64_t entries) {
    GLuint64 fragments = 0;
    gl().GetQueryObjectui64v(query_, GL_QUERY_RESULT, &fragments);
    const std::string label = pass_label(*program_);
    PassTally& tally = tallies_[label];
    tally.cost = find_pass_cost(*program_);
    if (tally.cost && tally.cost->targets != target_->colours())
        throw std::logic_error(
            fmt::format("{} declares {} targets and has {}", label, tally.cost->targets, target_->colours()));
    ++tally.draws;
    tally.fragments += fragments;
    tally.entries += entries;
    tally.written_bytes += fragments * uint64_t(target_->texel_bytes());
    const int end = std::min(last_blended_, target_->colours());
    if (first_blended_ < end) tally.blended_bytes += fragments * uint64_t(target_->texel_bytes(first_blended_, end));
}

}  // namespace radiafit
