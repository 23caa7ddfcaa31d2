#pragma once
#include <functional>
#include <span>
#include <vector>

#include "dataset/dataset.h"
#include "dataset/texel_shading.h"
#include "lightbasis/light_basis.h"
#include "samples/texel_source.h"

namespace radiafit::fits {

/// A texel's samples. Most texels of a flat sample under distant lamps have the same directions.
struct TexelLights {
    std::vector<LampAndHalf> directions;  ///< in the basis' frame
    std::vector<Vec3f> values;            ///< of the model
    size_t size() const { return directions.size(); }
};

/// What the model has to be added to, of a texel in a view (SafeRelighting::shade()): linear light.
using LightUnderneath = std::function<Vec3f(uint32_t texel, const View& view)>;

class TexelLightReader {
public:
    /// Of samples of these views. The basis gives frame, directions, curve and white. All but `underneath` must
    /// outlive it.
    TexelLightReader(const Dataset& dataset, const Atlas& atlas, const std::vector<uint32_t>& views,
                     const LightBasis& basis, LightUnderneath underneath = {});
    /// Over a grid all samples; of a mesh those that lamp and camera see from above the texel. Reuses out's storage.
    /// Thread-safe.
    void read(uint32_t texel, std::span<const TexelRadiance> samples, TexelLights& out) const;

private:
    const Dataset* dataset_;
    const Atlas* atlas_;
    const std::vector<uint32_t>* views_;
    const LightBasis* basis_;
    LightUnderneath underneath_;
};

/// Whether every training lamp sends light of all three colours, as channels that share their numbers need it.
bool lamps_have_all_colours(const Dataset& dataset);

/// Whether these views' cameras see the surface's middle from directions that differ, by some degrees at least.
bool cameras_move(const Dataset& dataset, const std::vector<uint32_t>& views);

/// For a basis yet to be learned: the frame, and the mean lamp.
void set_frame_and_white(const Dataset& dataset, const std::vector<uint32_t>& views, LightBasis& basis);

}  // namespace radiafit::fits
