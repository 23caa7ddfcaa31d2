#pragma once
#include <memory>
#include <string>
#include <vector>

#include "bench/agreement.h"
#include "bench/contestant.h"

namespace radiafit::harness {

struct SceneFacts {
    size_t images = 0;
    uint64_t samples = 0;       ///< pixels that texels take and that count, over all images
    uint64_t sites = 0;         ///< vertices or texels
    uint64_t parameters = 0;    ///< numbers that are fitted
    uint64_t site_samples = 0;  ///< a sample counts once for each site that fits it
};

/// A model to be fitted to a dataset, by any device, all of them over the same samples.
class BenchScene {
public:
    virtual ~BenchScene() = default;
    virtual SceneFacts facts() const = 0;
    /// Whether there is such an engine for the model.
    virtual bool has(Device device) const = 0;

    /// What passes sum over samples, at a random point and along a random direction from there: in double, and by a
    /// device, whose context must be current.
    virtual ExactSums exact_sums() = 0;
    virtual DeviceSums sums(Device device) = 0;

    /// The errors of the first iterations of a fit, of a device's contestant or by an engine of the CPU.
    static constexpr int fit_iterations = 3;
    virtual std::vector<double> reference_fit() = 0;
    /// How far iterations carry roundings: a problem decides otherwise where a trial changes its error by less.
    virtual double fit_tolerance() const = 0;

    virtual std::unique_ptr<TimedDevice> contestant(Device device) = 0;
};

}  // namespace radiafit::harness
