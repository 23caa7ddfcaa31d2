#include "gl/map_passes.h"

namespace radiafit {

MapPasses::MapPasses(const MapShape& shape, const SlsMesh& mesh, PassRunner& run, Gathers& gathers,
                     ProblemTextures& problems, const LfmOptions& options, Storage storage)
    : shape_(shape), run_(run), gathers_(gathers), problems_(problems), options_(options) {
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
    const auto make = [&](const std::string& fragment, const Defines& more = {}) {
        Pair pair;
        Defines defines = shape.defines(storage);
        defines.insert(defines.end(), more.begin(), more.end());
        pair.program[surface] = Program::draw("gather/map.vert", "optimize/" + fragment, defines);
        mesh.set_layout(pair.program[surface]);
        defines.push_back({"VIEW_MAPS", ""});
        pair.program[view] = Program::draw("common/whole.vert", "optimize/" + fragment, defines);
        for (const Program& program : pair.program) {
            program.set(14, options.lambda_surface);
            program.set(15, options.mu);
            program.set2(16, options.lower, options.upper);
            program.set(17, options.mode == Mode::paper ? 1 : 0);
        }
        return pair;
    };
    laplacian_ = make("laplacian.frag");
    penalty_error_ = make("penalty_error.frag");
    penalty_curvature_ = make("penalty_curvature.frag");
    gradient_ = make("gradient.frag");
    precondition_ = make("precondition.frag");
    floored_ = make("precondition.frag", {{"FLOORED", ""}});
    for (int product = 0; product < 3; ++product)
        dot_[product] = make("dot.frag", {{"PRODUCT", std::to_string(product)}});
    update_ = make("update_direction.frag");
    advance_ = make("advance.frag");
}

void MapPasses::prepare(const Vectors& v) {
    const int terms = shape_.terms();
    for (int corner = 0; corner < 3; ++corner)
        for (int term = 0; term < terms; ++term) {
            const auto of = [&](const MapVector& x) { return x.surface_target(corner, term); };
            gradient_targets_[surface].push_back(Framebuffer({of(v.trial_g)}));
            fresh_targets_[surface].push_back(Framebuffer({of(v.fresh)}));
            trial_targets_[surface].push_back(Framebuffer({of(v.trial)}));
            update_targets_[surface].push_back(Framebuffer({of(v.p), of(v.g), of(v.precondition), of(v.d)}));
        }
    for (int term = 0; term < terms; ++term) {
        const auto of = [&](const MapVector& x) { return x.view_target(term); };
        gradient_targets_[view].push_back(Framebuffer({of(v.trial_g)}));
        fresh_targets_[view].push_back(Framebuffer({of(v.fresh)}));
        trial_targets_[view].push_back(Framebuffer({of(v.trial)}));
        update_targets_[view].push_back(Framebuffer({of(v.p), of(v.g), of(v.precondition), of(v.d)}));
    }
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
void MapPasses::store_pass(const Pair& pair, const std::vector<Framebuffer> (&targets)[2], int term, const Bind& bind) {
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
        store_pass(gradient_, gradient_targets_, term, bind);
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
    for (int term = 0; term < shape_.terms(); ++term) store_pass(floored_, fresh_targets_, term, bind);
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

void MapPasses::project(const Vectors& v, const MapVector* precondition) {
    constexpr Sum sums[3] = {Sum::norm, Sum::cross, Sum::conjugate};
    for (int product = 0; product < 3; ++product) {
        const MapVector& other = product == 2 ? v.d : v.g;
        for (const Program& program : dot_[product].program) program.set(18, precondition ? 1 : 0);
        gather_pass(dot_[product], problems_.sum_target(sums[product]), Gather::sum, 0, [&](int site) {
            part(v.trial_g, site).bind(2);
            part(other, site).bind(3);
            part(precondition ? *precondition : v.fresh, site).bind(4);
        });
    }
}

void MapPasses::update_direction(const Vectors& v, bool preconditioned, bool fresh) {
    gl().TextureBarrier();
    for (const Program& program : update_.program) {
        program.set(18, preconditioned ? 1 : 0);
        program.set(19, fresh ? 1 : 0);
    }
    for (int term = 0; term < shape_.terms(); ++term)
        store_pass(update_, update_targets_, term, [&](int site) {
            unsigned unit = 0;
            for (const MapVector* x : {&v.p, &v.trial, &v.g, &v.trial_g, &v.precondition, &v.fresh, &v.d})
                part(*x, site).bind(unit++);
            problems_.state.bind(7);
        });
    gl().TextureBarrier();
}

void MapPasses::advance(const Vectors& v) {
    for (int term = 0; term < shape_.terms(); ++term)
        store_pass(advance_, trial_targets_, term, [&](int site) {
            part(v.p, site).bind(0);
            part(v.d, site).bind(6);
            problems_.state.bind(7);
            problems_.alpha.bind(14);
        });
}

}  // namespace radiafit
