#pragma once
#include <map>
#include <span>

#include "fragment/device_engine.h"
#include "gl/texture.h"

namespace radiafit {

/// A buffer, and the buffer texture that passes fetch it by.
struct FetchedBuffer {
    Buffer buffer;
    Texture texture;

    FetchedBuffer() = default;
    /// Only fetched by passes. `format`: of the texture's texels, such as GL_RGBA32F. Throws UserError, naming what it
    /// is, where the device fetches from none so large.
    FetchedBuffer(const char* what, GLenum format, size_t bytes, const void* data);
    /// A buffer that passes write to, too; zero at first. Throws UserError where the device allows none so large.
    static FetchedBuffer written(const char* what, size_t texels, GLenum format = GL_RGBA32F);
};
/// A buffer that passes write to, all zero. Throws UserError, naming what it is, where the device writes to none so
/// large.
Buffer storage_buffer(const char* what, size_t bytes);

/// Every problem's numbers in a storage buffer, what passes leave for its steps beside them, and the steps of
/// optimizers, which change them.
class ProblemBuffers final : public DeviceNumbers {
public:
    /// Numbers of a problem: those of optim/verbs.h, then room for as many as an optimizer may have.
    static constexpr size_t number_count = number::first_own + 8;

    /// given: the text in shaders/compute that says what passes before a step leave of a problem.
    ProblemBuffers(size_t problems, const std::string& given);
    /// Invocations of a work group of every pass: 32, which no chip runs as less than one step; of a rasterizer in
    /// software 8, the floats of one of its vectors, which at a barrier waits for nothing.
    size_t lanes() const { return lanes_; }
    /// What passes leave: the blocks "Problems" and "Products" of that text, so large.
    void make_given(size_t bytes) { given_ = storage_buffer("sums of problems", bytes); }
    void make_products(int count, size_t bytes_each);

    /// LANES and the numbers of problems, which all programs are compiled with.
    Defines defines() const;
    /// Binds and sets all buffers and uniforms of these that a program uses.
    void bind_to(const Program& program) const;

    /// The numbers of the optimizer are zero: waits if a step was taken since reset().
    void make_room(const Room& room);
    /// Compiled when it is first asked for.
    const Program& program(Step which, const Turn& turn);
    void step(Step which, const Turn& turn);
    EngineSummary summary();  ///< waits for the device

    const Buffer& given() const { return given_; }
    Buffer& given() { return given_; }
    /// Groups of so many invocations that all of `count` have one.
    size_t groups(size_t count) const { return (count + lanes_ - 1) / lanes_; }

private:
    void write_fresh(std::span<const Status> status) override;
    std::vector<float> read(std::initializer_list<int> numbers) const override;
    std::vector<float> read_all() const;  ///< [problems][number_count]

    size_t lanes_;
    std::string given_text_;
    int product_count_ = 0;
    bool optimizer_clear_ = false;  ///< the optimizer's numbers are zero
    Buffer numbers_, given_, products_, summaries_;
    Program summary_;
    std::map<StepKey, Program> steps_;
};

}  // namespace radiafit
