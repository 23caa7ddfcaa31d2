#include "gl/timer.h"

#include "base/clock.h"
#include "gl/context.h"

namespace radiafit {
GlStopwatch::GlStopwatch() {
    if (!Context::current().software()) gl().GenQueries(2, queries_);
}

GlStopwatch::~GlStopwatch() {
    if (queries_[0]) gl().DeleteQueries(2, queries_);
}

void GlStopwatch::start() {
    if (queries_[0])
        gl().QueryCounter(queries_[0], GL_TIMESTAMP);
    else
        gl().Finish();
    wall_start_ = wall_time_s();
}

void GlStopwatch::stop() {
    if (queries_[0]) {
        gl().QueryCounter(queries_[1], GL_TIMESTAMP);
        GLuint64 begin = 0, end = 0;
        gl().GetQueryObjectui64v(queries_[0], GL_QUERY_RESULT, &begin);
        gl().GetQueryObjectui64v(queries_[1], GL_QUERY_RESULT, &end);
        seconds_ += 1e-9 * double(end - begin);
    } else {
        gl().Finish();
        seconds_ += wall_time_s() - wall_start_;
    }
}

}  // namespace radiafit
