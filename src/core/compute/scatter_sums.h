#pragma once
#include "compute/sample_sweeps.h"

namespace radiafit {

/// The sums that samples scatter into (shaders/compute/accumulate.glsl), and the passes around a sweep of scatters:
/// scales of fixed point, and what goes on from cameras' views of vertices to view maps.
///
/// Fixed point has 64 bits and a scale for each problem and kind of sum, a power of two by which no sum of all the
/// problem's samples can exceed 2^61: from bounds of one sample's terms by the largest elements of the problem's maps
/// (shaders/compute/scales.comp). One term then has 60 - log2(samples) bits below its bound, some 44 of 65,000 samples,
/// where a float has 24 below its size.
class ScatterSums {
public:
    /// pairs: cameras' views of vertices at a time. target_scale: of a channel of 16 bits. Throws UserError where a
    /// buffer would be larger than the device allows.
    ScatterSums(const SweepResources& resources, Accumulate accumulate, size_t pairs, float target_scale);

    /// What programs that scatter are compiled with.
    Defines defines() const;
    /// What programs are compiled with that only read; a driver's extension is none of theirs.
    Defines reading_defines() const;
    void bind_to(const Program& program) const;

    /// Before a sweep: all sums are zero, and fixed point has its scales at the trial, or at p along d.
    void begin_gradient(bool diagonal);
    void begin_line();
    /// After the samples of `pairs` (with their texture) have scattered: on to the view maps' gradients.
    void spread(const Texture& pairs, bool diagonal);

private:
    using Words = std::vector<Buffer>;  ///< one, or two of fixed point
    Words make(const char* what, size_t vec3s) const;

    SweepResources r_;
    Accumulate accumulate_;
    size_t pair_count_;
    Words element_sums_, element_squares_, pair_sums_, pair_squares_, corner_sums_;
    FetchedBuffer scales_;
    Program scale_passes_[2];   ///< [1]: along d
    Program spread_passes_[2];  ///< [1]: diagonal
};

/// What samples that are counted scatter into: their number, and sums of their targets in fixed point, whatever the fit
/// accumulates in. It lives as long as the sweep that counts.
class SampleCounter {
public:
    /// most_samples: at least as many as a tile has. target_scale: as of ScatterSums. Throws UserError as
    /// ScatterSums does.
    SampleCounter(const MapTables& tables, float target_scale, double most_samples);
    static Defines defines();
    void bind_to(const Program& program) const;
    TileStatistics read() const;

private:
    size_t tiles_;
    double scale_;
    Buffer corner_sums_[2], tile_samples_;
};

/// Definitions for programs that sum along d: all four sums, or the two of the paper's mode.
inline Defines line_defines(const LfmOptions& options) {
    Defines defines{{"ALONG", ""}};
    return options.mode == Mode::modern ? defines + Defines{{"QUARTIC", ""}} : defines;
}

}  // namespace radiafit
