#pragma once
#include "cpu/lane_engine.h"
#include "cpu/lfm_problem.h"
#include "cpu/vertex_problem.h"

namespace radiafit {

/// Light field maps over all samples in memory, all vertices in every sweep; LaneEngine<VertexProblem> solves one
/// vertex to its end.
template <class real>
using StreamEngine = LaneEngine<LfmProblem<real>>;

extern template class LaneEngine<LfmProblem<float>>;
extern template class LaneEngine<LfmProblem<double>>;
extern template class LaneEngine<VertexProblem>;
static_assert(Engine<StreamEngine<float>> && Engine<StreamEngine<double>> && Engine<LaneEngine<VertexProblem>>);

}  // namespace radiafit
