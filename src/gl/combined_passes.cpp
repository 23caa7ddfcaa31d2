#include "gl/image_passes.h"
namespace radiafit {
std::unique_ptr<ImagePasses> make_combined_passes(const PassWorld& world) { return make_paper_passes(world); }
}  // namespace radiafit
