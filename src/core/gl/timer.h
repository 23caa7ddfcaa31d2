#pragma once
#include "gl/functions.h"

namespace radiafit {

/// Seconds that a sequence of GL commands took on the device: timestamp queries on a GPU; on a software rasterizer,
/// whose timestamps mean little, the wall clock between two glFinish.
class GlStopwatch {
public:
    GlStopwatch();
    ~GlStopwatch();
    GlStopwatch(const GlStopwatch&) = delete;
    GlStopwatch& operator=(const GlStopwatch&) = delete;
    void start();
    void stop();  ///< adds to seconds(); waits for the device
    double seconds() const { return seconds_; }
    void reset() { seconds_ = 0; }

private:
    GLuint queries_[2] = {0, 0};
    double wall_start_ = 0, seconds_ = 0;
};

}  // namespace radiafit
