#include "cpu/lfm_engine.h"

#include "cpu/lane_engine_impl.h"

namespace radiafit {

template class LaneEngine<LfmProblem<float>>;
template class LaneEngine<LfmProblem<double>>;
template class LaneEngine<VertexProblem>;

}  // namespace radiafit
