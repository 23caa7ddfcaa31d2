#include "fragment/map_passes.h"

#include <algorithm>

namespace radiafit {

MapPasses::MapPasses(const MapShape& shape, const SlsMesh& mesh, PassRunner& run, Gathers& gathers,
                     ProblemTextures& problems, const ProblemNumbers& numbers, std::vector<MapVector>& vectors,
                     const LfmOptions& options, Storage storage)
    : shape_(shape),
      run_(run),
      gathers_(gathers),
      problems_(problems),
      numbers_(numbers),
      vectors_(vectors),
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
    for (const Update which : {Update::update_direction, Update::advance}) update_pair(which);
}

MapPasses::Pair MapPasses::make(
    const std::function<Program(const std::string& vertex_file, const Defines& defines)>& program) const {
    const Defines defines = shape_.defines(storage_);
    Pair pair;
    pair.program[surface] = program("gather/map.vert", defines);
    mesh_.set_layout(pair.program[surface]);
    pair.program[view] = program("common/whole.vert", defines + Defines{{"VIEW_MAPS", ""}});
    for (const Program& made : pair.program) {
        made.set(14, options_.lambda_surface);
        made.set(15, options_.mu);
        made.set2(16, options_.lower, options_.upper);
        made.set(17, options_.mode == Mode::paper ? 1 : 0);
    }
    return pair;
}

const MapPasses::Pair& MapPasses::update_pair(Update which) {
    Pair& pair = updates_[which];
    if (!pair.program[surface].name())
        pair = make([&](const std::string& vertex_file, const Defines& defines) {
            return make_update(which, vertex_file, "map_elements", defines);
        });
    return pair;
}

const MapPasses::Targets& MapPasses::targets(std::span<const int> vectors) {
    Targets& targets = targets_[{vectors.begin(), vectors.end()}];
    if (!targets[surface].empty()) return targets;
    const auto add = [&](Site site, const auto& of) {
        std::vector<Target> colours;
        for (const int v : vectors) colours.push_back(of(vectors_[size_t(v)]));
        targets[site].push_back(Framebuffer(colours));
    };
    for (int corner = 0; corner < 3; ++corner)
        for (int term = 0; term < shape_.terms(); ++term)
            add(surface, [&](const MapVector& x) { return x.surface_target(corner, term); });
    for (int term = 0; term < shape_.terms(); ++term)
        add(view, [&](const MapVector& x) { return x.view_target(term); });
    return targets;
}

void MapPasses::make_own_vectors(const Room& room) {
    radiafit::make_own_vectors(room, vectors_, targets_, [&] { return MapVector(shape_, storage_); });
}

void MapPasses::set_term(const Pair& pair, int term) {
    for (const Program& program : pair.program) {
        program.set(10, term);
        program.set(15, term == 0 ? options_.mu : 0.0f);
    }
}

namespace {
// Which array a fragment stage reads: the surface or the view part, by site.
const Texture& part(const MapVector& x, int site) { return site == 0 ? x.surface() : x.view(); }
const Texture& part(const MapSums& x, int site) { return site == 0 ? x.surface : x.view; }
}  // namespace

void MapPasses::laplacian(const MapVector& maps, int term) {
    set_term(laplacian_, term);
    for (int site = 0; site < 2; ++site) {
        part(maps, site).bind(2);
        for (size_t corner = 0; corner < smoothed_targets_[site].size(); ++corner) {
            laplacian_.program[site].set(8, int(corner));
            run_.bind(smoothed_targets_[site][corner], laplacian_.program[site]);
            site == surface ? run_.draw_tiles() : run_.draw_whole();
        }
    }
}

// The caller's bind(site) puts the arrays in place.
template <class Bind>
void MapPasses::gather_pass(const Pair& pair, const Framebuffer& sum, Gather gather, int term, const Bind& bind) {
    set_term(pair, term);
    for (int site = 0; site < 2; ++site) {
        const auto& targets = product_targets_[site];
        for (size_t corner = 0; corner < targets.size(); ++corner) {
            bind(site);
            pair.program[site].set(8, int(corner));
            run_.bind(targets[corner], pair.program[site]);
            site == surface ? run_.draw_tiles() : run_.draw_whole();
            if (site == surface) gathers_.tiles(run_, product_[surface], int(corner), gather);
        }
        if (site == surface)
            gathers_.rings(run_, gathers_.tile_sums(), sum, gather, true);
        else
            gathers_.views(run_, product_[view], sum, gather);
    }
}

template <class Bind>
void MapPasses::store_pass(const Pair& pair, const Targets& targets, int term, const Bind& bind) {
    set_term(pair, term);
    for (int site = 0; site < 2; ++site)
        for (int corner = 0; corner < (site == surface ? 3 : 1); ++corner) {
            bind(site);
            pair.program[site].set(8, corner);
            run_.bind(targets[site][size_t(corner * shape_.terms() + term)], pair.program[site]);
            site == surface ? run_.draw_tiles() : run_.draw_whole();
        }
}

void MapPasses::finish_direction(const MapVector& x, const MapSums& sums, int first_term, int last_term) {
    for (int term = 0; term < shape_.terms(); ++term) {
        laplacian(x, term);
        const auto bind = [&](int site) {
            part(x, site).bind(2);
            smoothed_[site].bind(7);
            part(sums, site).bind(11);
            problems_.constants.bind(12);
        };
        gather_pass(penalty_error_, problems_.sum_target(Sum::penalty), Gather::sum, term, bind);
        for (const Program& program : gradient_.program)
            program.set(23, term >= first_term && term < last_term ? 1 : 0);
        store_pass(gradient_, targets({{vector::trial_g}}), term, bind);
    }
}

void MapPasses::finish_precondition(const MapSums& squares) {
    const auto bind = [&](int site) {
        part(squares, site).bind(11);
        problems_.constants.bind(12);
        problems_.largest.bind(13);
    };
    run_.clear(problems_.largest_target);
    for (int term = 0; term < shape_.terms(); ++term)
        gather_pass(precondition_, problems_.largest_target, Gather::maximum, term, bind);
    for (int term = 0; term < shape_.terms(); ++term) store_pass(floored_, targets({{vector::fresh}}), term, bind);
}

void MapPasses::finish_line(const MapVector& x, const MapVector& d) {
    for (int term = 0; term < shape_.terms(); ++term) {
        laplacian(d, term);
        gather_pass(penalty_curvature_, problems_.sum_target(Sum::penalty_curvature), Gather::sum, term, [&](int site) {
            part(x, site).bind(2);
            part(d, site).bind(3);
            smoothed_[site].bind(7);
            problems_.constants.bind(12);
        });
    }
}

void MapPasses::dot(const DotProduct& product) {
    const Framebuffer& sum = problems_.product_target(product.into);
    const bool weighted = product.weight != vector::none;
    for (const Program& program : dot_.program) program.set(18, weighted ? 1 : 0);
    run_.clear(sum);
    gather_pass(dot_, sum, Gather::sum, 0, [&](int site) {
        part(vectors_[size_t(product.a)], site).bind(2);
        part(vectors_[size_t(product.b)], site).bind(3);
        part(vectors_[size_t(weighted ? product.weight : product.a)], site).bind(4);
    });
}

void MapPasses::update(Update which, std::span<const int> vectors, std::span<const int> numbers,
                       std::span<const float> constants) {
    const Pair& pair = update_pair(which);
    const Targets& written = targets(vectors.first(size_t(updates[int(which)].written)));
    for (const Program& program : pair.program) tell_update(program, numbers, constants);
    gl().TextureBarrier();
    for (int term = 0; term < shape_.terms(); ++term)
        store_pass(pair, written, term, [&](int site) {
            for (size_t k = 0; k < vectors.size(); ++k) part(vectors_[size_t(vectors[k])], site).bind(unsigned(k));
            numbers_.bind();
            problems_.bind_products();
        });
    gl().TextureBarrier();
}

}  // namespace radiafit
