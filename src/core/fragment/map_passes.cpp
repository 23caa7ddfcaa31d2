#include "fragment/map_passes.h"

#include <algorithm>

namespace radiafit {

MapPasses::MapPasses(const MapShape& shape, const SlsMesh& mesh, PassRunner& run, Gathers& gathers,
                     ProblemTextures& problems, const ProblemNumbers& numbers, std::vector<MapVector>& vectors,
                     const std::vector<MapVector>& spares, const LfmOptions& options, Storage storage)
    : shape_(shape),
      run_(run),
      gathers_(gathers),
      problems_(problems),
      numbers_(numbers),
      vectors_(vectors),
      spares_(spares),
      mesh_(mesh),
      options_(options),
      storage_(storage) {
    const int m = shape.grid.view_side;
    for (auto* textures : {&smoothed_, &product_}) {
        (*textures)[surface] = Texture(GL_RGBA32F, shape.atlas->width(), shape.atlas->height(), 3);
        (*textures)[view] = Texture(GL_RGBA32F, shape.grid.columns * m, shape.grid.rows * m, 1);
    }
    for (int site = 0; site < 2; ++site)
        for (int layer = 0; layer < smoothed_[site].layers(); ++layer) {
            smoothed_targets_[site].push_back(Framebuffer({{&smoothed_[site], layer}}));
            product_targets_[site].push_back(Framebuffer({{&product_[site], layer}}));
        }
    const auto pass = [&](const char* fragment, const Defines& more = {}) {
        return make([&](const std::string& vertex_file, const Defines& defines) {
            return Program::draw(vertex_file, std::string("optimize/") + fragment, defines + more);
        });
    };
    laplacian_ = pass("laplacian.frag");
    penalty_error_ = pass("penalty_error.frag");
    penalty_curvature_ = pass("penalty_curvature.frag");
    gradient_ = pass("gradient.frag");
    precondition_ = pass("precondition.frag");
    floored_ = pass("precondition.frag", {{"FLOORED", ""}});
    dot_ = pass("dot.frag");
    for (const Update which : {Update::update_direction, Update::advance}) update_pairs(which);
}

MapPasses::Pair MapPasses::make(
    const std::function<Program(const std::string& vertex_file, const Defines& defines)>& program) const {
    const Defines defines = shape_.defines(storage_);
    Pair pair;
    pair.program[surface] = program("gather/map.vert", defines);
    mesh_.set_layout(pair.program[surface]);
    pair.program[view] = program("common/whole.vert", defines + Defines{{"VIEW_MAPS", ""}});
    for (const int site : {surface, view}) pair.program[site].bind_if_used("laplacian", smoothed_[site]);
    for (const Program& made : pair.program) {
        made.set_if_used("lambda_surface", options_.lambda_surface);
        made.set_if_used("bounds", options_.lower, options_.upper);
        made.set_if_used("paper_penalty", options_.mode == Mode::paper);
        made.bind_if_used("problem_constants", problems_.constants);
        made.bind_if_used("largest_diagonal", problems_.largest);
    }
    return pair;
}

const std::vector<MapPasses::Pair>& MapPasses::update_pairs(Update which) {
    std::vector<Pair>& pairs = updates_[which];
    if (pairs.empty())
        for (const Defines& result : result_defines(updates[int(which)].written, !spares_.empty()))
            pairs.push_back(make([&](const std::string& vertex_file, const Defines& defines) {
                return make_update(which, vertex_file, "map_elements", defines + result);
            }));
    return pairs;
}

const MapPasses::Targets& MapPasses::targets(std::span<const MapVector* const> vectors) {
    TextureList names{};
    std::ranges::transform(vectors, names.begin(), [](const MapVector* x) { return x->surface().name(); });
    Targets& targets = targets_[names];
    if (!targets[surface].empty()) return targets;
    const auto add = [&](Site site, const auto& of) {
        std::vector<Target> colours;
        for (const MapVector* x : vectors) colours.push_back(of(*x));
        targets[site].push_back(Framebuffer(colours));
    };
    for (int corner = 0; corner < 3; ++corner)
        for (int term = 0; term < shape_.terms(); ++term)
            add(surface, [&](const MapVector& x) { return x.surface_target(corner, term); });
    for (int term = 0; term < shape_.terms(); ++term)
        add(view, [&](const MapVector& x) { return x.view_target(term); });
    return targets;
}

void MapPasses::set_term(const Pair& pair, int term) {
    for (const Program& program : pair.program) {
        program.set_if_used("term", term);
        program.set_if_used("mu", term == 0 ? options_.mu : 0.0f);
    }
}

void MapPasses::draw(const Pair& pair, int site, const Framebuffer& target, size_t corner) {
    const Program& program = pair.program[site];
    if (site == view) return run_.draw_whole(target, program);
    program.set("corner", int(corner));
    run_.draw_tiles(target, program);
}

void MapPasses::laplacian(const MapVector& maps, int term) {
    set_term(laplacian_, term);
    bind(laplacian_, "maps", maps);
    for (int site = 0; site < 2; ++site)
        for (size_t corner = 0; corner < smoothed_targets_[site].size(); ++corner)
            draw(laplacian_, site, smoothed_targets_[site][corner], corner);
}

void MapPasses::gather_pass(const Pair& pair, const Framebuffer& sum, Gather gather, int term) {
    set_term(pair, term);
    for (size_t corner = 0; corner < 3; ++corner) {
        draw(pair, surface, product_targets_[surface][corner], corner);
        gathers_.tiles(run_, product_[surface], int(corner), gather);
    }
    gathers_.rings(run_, gathers_.tile_sums(), sum, gather, true);
    draw(pair, view, product_targets_[view][0]);
    gathers_.views(run_, product_[view], sum, gather);
}

void MapPasses::store_pass(const Pair& pair, const Targets& targets, int term) {
    set_term(pair, term);
    for (size_t corner = 0; corner < 3; ++corner)
        draw(pair, surface, targets[surface][corner * size_t(shape_.terms()) + size_t(term)], corner);
    draw(pair, view, targets[view][size_t(term)]);
}

void MapPasses::finish_gradient(const MapVector& x, const MapSums& sums, int first_term, int last_term) {
    for (const Pair* pair : {&penalty_error_, &gradient_}) bind(*pair, "parameters", x);
    bind(gradient_, "sample_sums", sums);
    for (int term = 0; term < shape_.terms(); ++term) {
        laplacian(x, term);
        gather_pass(penalty_error_, problems_.sum_target(Sum::penalty), Gather::sum, term);
        for (const Program& program : gradient_.program) program.set("fitted", term >= first_term && term < last_term);
        store_pass(gradient_, targets({{&vectors_[vector::trial_g]}}), term);
    }
}

void MapPasses::finish_precondition(const MapSums& squares) {
    for (const Pair* pair : {&precondition_, &floored_}) bind(*pair, "sample_sums", squares);
    run_.clear(problems_.largest_target);
    for (int term = 0; term < shape_.terms(); ++term)
        gather_pass(precondition_, problems_.largest_target, Gather::maximum, term);
    for (int term = 0; term < shape_.terms(); ++term) store_pass(floored_, targets({{&vectors_[vector::fresh]}}), term);
}

void MapPasses::finish_directional(const MapVector& x, const MapVector& d) {
    if (!options_.corrections.penalty_curvature) return;  // the sum stays 0
    bind(penalty_curvature_, "parameters", x);
    bind(penalty_curvature_, "direction", d);
    for (int term = 0; term < shape_.terms(); ++term) {
        laplacian(d, term);
        gather_pass(penalty_curvature_, problems_.sum_target(Sum::penalty_curvature), Gather::sum, term);
    }
}

void MapPasses::dot(const DotProduct& product) {
    const Framebuffer& sum = problems_.product_target(product.into);
    const bool weighted = product.weight != vector::none;
    for (const Program& program : dot_.program) program.set("weighted", weighted);
    bind(dot_, "left", vectors_[size_t(product.a)]);
    bind(dot_, "right", vectors_[size_t(product.b)]);
    bind(dot_, "weights", vectors_[size_t(weighted ? product.weight : product.a)]);
    run_.clear(sum);
    gather_pass(dot_, sum, Gather::sum, 0);
}

void MapPasses::update(Update which, std::initializer_list<int> vectors, std::initializer_list<int> numbers,
                       std::initializer_list<float> constants) {
    const std::span<const int> list(vectors);
    const size_t count = size_t(updates[int(which)].written);
    std::array<const MapVector*, MOST_VECTORS> written{};
    for (size_t k = 0; k < count; ++k) written[k] = spares_.empty() ? &vectors_[size_t(list[k])] : &spares_[k];
    const std::vector<Pair>& pairs = update_pairs(which);
    gl().TextureBarrier();
    for (size_t i = 0; i < pairs.size(); ++i) {
        for (const Program& program : pairs[i].program)
            numbers_.set_update(program, problems_.products(), numbers, constants);
        for (size_t k = 0; k < list.size(); ++k) bind(pairs[i], "vectors", vectors_[size_t(list[k])], k);
        const Targets& to = targets(std::span(written).subspan(i, count / pairs.size()));
        for (int term = 0; term < shape_.terms(); ++term) store_pass(pairs[i], to, term);
    }
    gl().TextureBarrier();
}

}  // namespace radiafit
