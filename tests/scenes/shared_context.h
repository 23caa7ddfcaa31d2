#pragma once
#include <gtest/gtest.h>

#include "gl_scene.h"

namespace radiafit {

/// The EGL context of all of a program's tests that aren't about contexts, closed when the last of them is over.
class SharedContext : public ::testing::Environment {
public:
    void TearDown() override { context_.reset(); }
    /// Current on this thread from now on. A test's GL objects must be gone at its end.
    static Context& use() {
        if (!context_) context_ = make_context(ContextKind::egl);
        context_->make_current();
        return *context_;
    }

private:
    inline static std::unique_ptr<Context> context_;
};
inline ::testing::Environment* const shared_context_closer = ::testing::AddGlobalTestEnvironment(new SharedContext);

}  // namespace radiafit
