#pragma once
#include "bench/scene.h"
#include "dataset/dataset.h"

namespace radiafit::harness {

/// A light field map of one term, surface and view maps of side 8. by_opengl: samples are those that OpenGL
/// distributes, whose context must be current; else the CPU's.
std::unique_ptr<BenchScene> light_field_scene(Dataset dataset, bool by_opengl);

}  // namespace radiafit::harness
