// What a sample's squared residual s costs, twice, by losses of scale delta (in units of the targets): as s where residuals
// are small. And the derivative, by which the sample counts in gradients and curvatures: as in the least squares whose
// parabola touches the loss at s and lies above it elsewhere (iteratively reweighted least squares, Holland and Welsch 1977).
// The includer says what an element is: `real`, or several side by side. src/core/model/loss.h lists the losses.
SHARED_FN element huber_value(element s, real delta) {
    element root = sqrt(s);
    element most = min(root, element(delta));
    return most * (real(2.0) * root - most);
}
SHARED_FN element huber_weight(element s, real delta) { return element(delta) / max(sqrt(s), element(delta)); }

SHARED_FN element cauchy_value(element s, real delta) { return delta * delta * log(real(1.0) + s / (delta * delta)); }
SHARED_FN element cauchy_weight(element s, real delta) { return element(real(1.0)) / (real(1.0) + s / (delta * delta)); }

#ifndef __cplusplus
// By the loss of the fit: LOSS_SCALE is its scale; undefined: squares.
#ifdef LOSS_SCALE
#define LOSS_VALUE(s) LOSS_VALUE_OF(s, LOSS_SCALE)
#define LOSS_WEIGHTED(s, x) (LOSS_WEIGHT_OF(s, LOSS_SCALE) * (x))
#else
#define LOSS_VALUE(s) (s)
#define LOSS_WEIGHTED(s, x) (x)
#endif
#endif
