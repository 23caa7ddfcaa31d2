#pragma once
#include "capture/rti_file.h"
#include "dataset/dataset.h"
#include "fitting/fitted.h"

namespace radiafit::tools {

/// A file as a fit over a dataset's grid.
struct RtiFit {
    fits::Fitted fit;
    /// Root mean square difference, on the file's curve, of what the fit shows under lamps amid the dataset's training
    /// lamps from what the file does; 0 where its functions are the model's.
    double difference = 0;
};

/// Throws UserError unless the dataset has a grid of the file's size whose lamps are what such files know: distant, of
/// intensity 1; and, for a texel-local model, the plane's own normals.
void check_rti_dataset(const RtiFile& file, const std::filesystem::path& name, const Dataset& dataset);

/// The texel-local model, where the file's functions are its own: the same values but for rounding. Else a light basis
/// whose mean and functions are the sums of kernels nearest to the file's, by least squares over the directions
/// amid the training lamps. The dataset must outlive it.
RtiFit fit_of(const RtiFile& file, const Dataset& dataset);

}  // namespace radiafit::tools
