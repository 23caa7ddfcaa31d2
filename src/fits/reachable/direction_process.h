#pragma once
#include <Eigen/Core>
#include <vector>

#include "base/linear.h"
#include "base/rings.h"

/// Gaussian processes over view directions (Rasmussen and Williams 2006, "Gaussian Processes for Machine Learning",
/// chapters 2, 4 and 5). All directions are unit vectors.
namespace radiafit::fits {

/// A place's colours as cameras see them.
struct SeenColours {
    std::vector<Vec3f> directions;  ///< towards the cameras
    std::vector<Vec3f> colours;
    std::vector<float> weights;  ///< of samples: the variance of their noise is divided by it
    size_t size() const { return directions.size(); }
};

/// What is expected of a place's colours before it is seen, each channel alike: a mean, and the covariance between
/// directions v and w
///     k(v, w) = level + amplitude (1 + r + r^2 / 3) exp(-r),    r = sqrt(5) |v - w| / length    (Matern's of
///     smoothness 5/2);
/// samples have noise in addition.
struct DirectionProcess {
    Vec3d mean = Vec3d::Constant(0.5);
    double level = 0.04;      ///< variance of what all directions share
    double amplitude = 0.01;  ///< variance of what changes with the direction
    double length = 0.5;      ///< over which it changes: a chord of the unit sphere
    double noise = 1e-3;      ///< variance, of a sample of weight 1
};

/// The part of a covariance that changes with the direction, as a share of the amplitude: 1 at distance 0.
template <class Array>
auto matern(const Array& r) {
    return (1 + r + r * r / 3) * (-r).exp();
}

/// [n][3] such that the posterior mean at v is
///     mean + sum over samples i of weight_i k(v, v_i):    (K + noise)^-1 (colours - mean), by Cholesky.
Eigen::Matrix<double, Eigen::Dynamic, 3> posterior_weights(const DirectionProcess& process, const SeenColours& seen);

/// What places' colours say of a process: sums over places of the logarithm of their probability density, and its
/// derivatives by the logarithms of level, amplitude, length and noise.
struct Evidence {
    static constexpr int parameters = 4;
    double log = 0;
    Eigen::Matrix<double, parameters, 1> gradient = Eigen::Matrix<double, parameters, 1>::Zero();
    /// Fisher's information: minus the expected second derivatives.
    Eigen::Matrix<double, parameters, parameters> information = Eigen::Matrix<double, parameters, parameters>::Zero();
    Vec3d mean_gradient = Vec3d::Zero();  ///< by the means
    double mean_information = 0;          ///< of each
    void add(const Evidence& other);
};
Evidence evidence(const DirectionProcess& process, const SeenColours& seen);

/// The process of most evidence, by Fisher's scoring from `start`, damped so that every step gains. At most so many
/// rounds, each an evidence of all places. The same for any number of threads.
DirectionProcess most_likely_process(const std::vector<SeenColours>& places, DirectionProcess start, int rounds = 40);

}  // namespace radiafit::fits
