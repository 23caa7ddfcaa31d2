// How much a sample counts, by the cosine between the surface's normal and the direction to the camera: its squared residual
// is multiplied by it. A pixel that sees the surface at a slant covers more of it. C++: SampleWeights in model/loss.h.
SHARED_FN real facing_weight(real cosine) { return max(cosine, real(0.0)); }
