#pragma once
#include "bench/scene.h"
#include "dataset/dataset.h"

namespace radiafit::harness {

/// Lafortune's model in every texel that the dataset has a normal for. by_opengl: as light_field_scene() has it.
std::unique_ptr<BenchScene> texel_scene(Dataset dataset, bool by_opengl);

}  // namespace radiafit::harness
