#pragma once
#include <gtest/gtest.h>

#include <string>

#include "base/error.h"
#include "gl/context.h"

/// A device that goes wrong on purpose: functions of the current context's table are replaced while one of these lives.
namespace radiafit {

/// The nth allocation of memory from now on fails, as OpenGL lets it: a name without memory, and an error that stays
/// until it is asked for.
class FailingAllocation {
public:
    explicit FailingAllocation(int nth) {
        left_ = nth;
        pending_ = GL_NO_ERROR;
        saved_ = table();
        table().TextureStorage2D.pointer = [](GLuint name, GLsizei levels, GLenum format, GLsizei w, GLsizei h) {
            if (!fails()) saved_.TextureStorage2D.pointer(name, levels, format, w, h);
        };
        table().TextureStorage3D.pointer = [](GLuint name, GLsizei levels, GLenum format, GLsizei w, GLsizei h,
                                              GLsizei d) {
            if (!fails()) saved_.TextureStorage3D.pointer(name, levels, format, w, h, d);
        };
        table().NamedBufferStorage.pointer = [](GLuint name, GLsizeiptr size, const void* data, GLbitfield flags) {
            if (!fails()) saved_.NamedBufferStorage.pointer(name, size, data, flags);
        };
        table().GetError.pointer = []() -> GLenum {
            const GLenum error = std::exchange(pending_, GLenum(GL_NO_ERROR));
            return error != GL_NO_ERROR ? error : saved_.GetError.pointer();
        };
    }
    ~FailingAllocation() { table() = saved_; }
    FailingAllocation(const FailingAllocation&) = delete;
    FailingAllocation& operator=(const FailingAllocation&) = delete;
    bool failed() const { return left_ <= 0; }

    static GlFunctions& table() { return const_cast<GlFunctions&>(Context::current().functions()); }

private:
    static bool fails() {
        if (--left_ != 0) return false;
        pending_ = GL_OUT_OF_MEMORY;
        return true;
    }
    inline static int left_ = 0;
    inline static GLenum pending_ = GL_NO_ERROR;
    inline static GlFunctions saved_;
};

/// Does `body` again and again, each time with another allocation that fails, until none does; each must be a UserError
/// that tells bytes and a cure, and leave nothing allocated. How many there were.
template <class Body>
int fail_each_allocation(const Body& body) {
    Context& context = Context::current();
    const int64_t before = context.allocated_bytes();
    for (int nth = 1;; ++nth) {
        const FailingAllocation failing(nth);
        std::string told;
        try {
            body();
        } catch (const UserError& error) {
            told = error.what();
        }
        EXPECT_EQ(context.allocated_bytes(), before) << "allocation " << nth;
        if (!failing.failed()) return nth - 1;
        EXPECT_NE(told.find("has no room for a "), std::string::npos) << "allocation " << nth << ": " << told;
        EXPECT_NE(told.find(" MB; "), std::string::npos) << told;
        EXPECT_NE(told.find("choose a smaller fit"), std::string::npos) << told;
        if (::testing::Test::HasFailure()) return nth;
    }
}

}  // namespace radiafit
