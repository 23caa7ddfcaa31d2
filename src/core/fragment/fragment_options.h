#pragma once
#include <string>

#include "dataset/image_stream.h"

/// What the engines of fragment programs can be asked for, without the engines.
namespace radiafit {

/// How N-texel arrays are stored. See shaders/gather/maps.glsl.
enum class Storage {
    fp32,
    fp16,          ///< binary16, rounded to nearest even
    fp16_truncate  ///< RGBA16F render targets: truncates, as 2003's hardware may have
};

/// How sums over samples (gradient, diagonal, error, along d) are kept from image to image and pass to pass. Halves are
/// blended as the device does it: llvmpipe truncates every sum. They hold up to 65504: no more than that many samples
/// of residuals of order one in a ring.
enum class Sums { fp32, fp16 };

/// How the work is cut into programs.
enum class Passes {
    paper,  ///< as the paper has it: one image a pass, and over images one render target; a few programs go beyond that
    /// The paper's within what its chip, the Radeon 9700 (R300), could bind: one render target in every pass, which
    /// isn't read in it; textures looked up by fragment programs alone, in loops of constant length, and with one term
    /// at most 16 texels.
    r300,
    combined  ///< several images and targets in one program
};
std::string to_string(Passes passes);

/// Of a texel-local model on OpenGL's fragment programs: six maps of three numbers, which a pass may write all at once,
/// beside sums, where OpenGL 4.5 promises eight attachments.
inline constexpr int most_fragment_parameters = 18;

struct FragmentOptions {
    Passes passes = Passes::paper;
    Storage storage = Storage::fp32;
    Sums sums = Sums::fp32;
    StreamSource source = StreamSource::memory;
    bool keep_on_device = false;  ///< all images stay on the device, each read once from `source`: memory is O(S) then
    TargetSpace space = TargetSpace::stored;
    /// What texels take of each image stays on the device from the first sweep on, a map of the surface for each, and
    /// later sweeps don't distribute again: memory is O(S), and images are needed in the first sweep only. Of light
    /// field maps with the paper's passes, or r300's.
    bool keep_samples = false;
    /// Images that combined passes take together; 0: as many as they can. Of light field maps at most 4, or what
    /// varyings have room for; of reflectance as many as 256 MiB hold, but 4 at least, and over a grid there are two
    /// such stacks. With another number sums are rounded otherwise.
    int images_per_pass = 0;
    /// Whether the host leaves triangles that face away out of what is drawn; sums are the same bits without.
    bool cull = true;
    bool scissored = false;  ///< passes over images, but for count(), cut to one texel: what remains is switching (C7)
};

}  // namespace radiafit
