// What radiafit-bench has no use for, and other machines may lack the libraries of: pictures (OpenEXR), and the rivals
// of the paper's optimizers (Ceres, Qhull). Here are their names alone, so that the layers around need not leave them
// out.
#include "base/error.h"
#include "image/exr.h"
#include "reference/als_solver.h"
#include "reference/ceres_solver.h"
#include "reference/ceres_texel.h"
#include "reference/mean_solver.h"
#include "reference/pca_solver.h"
#include "reference/varpro_solver.h"

namespace radiafit {
namespace {

[[noreturn]] void absent() {
    throw UserError("this program has no pictures and no solvers but `stream` and `two-step`; use radiafit itself");
}

}  // namespace

void write_exr(const std::filesystem::path&, const ExrImage&, ExrType) { absent(); }
ExrImage read_exr(const std::filesystem::path&, const std::vector<std::string>&, std::optional<std::array<int, 2>>) {
    absent();
}

namespace fits {

std::span<const CeresSetting> ceres_settings() {
    static const CeresSetting one[] = {{"lbfgs", "the default", CeresMemory::vectors}};
    return one;
}
const CeresSetting& find_ceres_setting(const std::string&) { return ceres_settings().front(); }

uint64_t als_bytes(const LfmOptions&, const VertexShape&) { absent(); }
uint64_t varpro_bytes(const LfmOptions&, const VertexShape&) { absent(); }
uint64_t ceres_bytes(const LfmOptions&, const VertexShape&, CeresMemory) { absent(); }
uint64_t pca_bytes(const LfmOptions&, const VertexShape&) { absent(); }
VertexSolver als_solver(const LfmOptions&, const AlsOptions&) { absent(); }
VertexSolver varpro_solver(const LfmOptions&, const VarproOptions&) { absent(); }
VertexSolver ceres_solver(const LfmOptions&, const CeresOptions&) { absent(); }
std::unique_ptr<CeresTexelSolver> ceres_texel_solver(const TexelModel&, const CeresTexelOptions&) { absent(); }
std::vector<float> mean_solver(const TriangleAtlas&, const LfmLayout&, const SampleList&) { absent(); }
std::vector<PcaFit> pca_solver(const RingResampler&, const LfmLayout&, std::span<const int>,
                               const std::function<void()>&) {
    absent();
}
ResamplingCounts& ResamplingCounts::operator+=(const ResamplingCounts&) { absent(); }
RingResampler::RingResampler(const Dataset&, const TriangleAtlas&, const VertexRings&, const TileViews&, int) {
    absent();
}
TileViews resample_tiles(const Dataset&, const TriangleAtlas&, const std::vector<uint32_t>&, TargetSpace) { absent(); }
LfmVertices::LfmVertices(const Dataset&, const TriangleAtlas& atlas, const VertexRings& rings, const SampleList&,
                         const LfmOptions& options)
    : layout_(rings, atlas, options.view_side, options.terms),
      view_neighbours_(MapNeighbours::square(options.view_side)) {
    absent();
}
void LfmVertices::gather(size_t, LfmVertex&) const { absent(); }
RunsResult solve_vertices(const LfmVertices&, uint64_t, const VertexSolver&, const std::vector<uint32_t>*) { absent(); }
Trace trace_of(std::span<const VertexRun>, int) { absent(); }

}  // namespace fits
}  // namespace radiafit
