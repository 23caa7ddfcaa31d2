#pragma once
#include <map>
#include <span>
#include <tuple>

#include "gl/program.h"
#include "gl/texture.h"
#include "optim/engine.h"

namespace radiafit {

/// A buffer, and the buffer texture that passes fetch it by.
struct FetchedBuffer {
    Buffer buffer;
    Texture texture;

    FetchedBuffer() = default;
    /// To be fetched only. `format`: of the texture's texels, such as GL_RGBA32F. Throws UserError, naming what it is,
    /// where the device fetches from none so large.
    FetchedBuffer(const char* what, GLenum format, size_t bytes, const void* data);
    /// That passes write to, too; zero at first. Throws UserError likewise.
    static FetchedBuffer written(const char* what, size_t texels, GLenum format = GL_RGBA32F);
};
/// A buffer that passes write to, all zero. Throws UserError, naming what it is, where the device writes to none so
/// large.
Buffer storage_buffer(const char* what, size_t bytes);

/// Every problem's numbers (optim/verbs.h) in a storage buffer, what passes leave for its steps beside them, and the
/// steps of optimizers, which change them.
class ProblemBuffers {
public:
    /// Of a problem: the numbers of optim/verbs.h, then room for as many own ones as an optimizer may have.
    static constexpr size_t number_count = number::first_own + 8;

    /// given: the text in shaders/compute that says what passes before a step leave of a problem.
    ProblemBuffers(size_t problems, const std::string& given);
    /// Invocations of a work group of every pass: 32, which no chip runs as less than one step; of a rasterizer in
    /// software 8, the floats of one of its vectors, which at a barrier waits for nothing.
    size_t lanes() const { return lanes_; }
    /// What passes leave: the blocks "Problems" and "Products" of that text, so large.
    void make_given(size_t bytes) { given_ = storage_buffer("sums of problems", bytes); }
    void make_products(int count, size_t bytes_each);

    /// LANES and the numbers of problems, which all passes are told of.
    Defines defines() const;
    /// Tells a program of all buffers and uniforms that it uses of these.
    void bind_to(const Program& program) const;

    /// Fresh problems; samples(problem): 0 where there is nothing to fit.
    template <class Samples>
    void reset(const Samples& samples) {
        std::vector<Status> status(count_);
        for (size_t i = 0; i < count_; ++i) status[i] = samples(i) ? Status::active : Status::no_samples;
        reset(std::span<const Status>(status));
    }
    void reset(std::span<const Status> status);
    void clear_own();  ///< the optimizer's numbers; waits if a step was taken since reset()
    /// Compiled when it is first asked for. left_out, first_step: of Turn.
    const Program& program(Step which, int left_out = 0, float first_step = 0);
    void step(Step which, const Turn& turn);
    /// Numbers and constants of an update as update() of optim/engine.h has them.
    void tell_update(const Program& update, std::initializer_list<int> numbers,
                     std::initializer_list<float> constants) const;
    /// Where updates' programs differ.
    static Defines update_defines(Update which);

    // These wait for the device.
    EngineSummary summary();
    void outcomes(std::span<ProblemOutcome> out) const;  ///< [problems]
    void read_errors(std::span<float> out) const;        ///< [problems]

    const Buffer& given() const { return given_; }
    Buffer& given() { return given_; }
    /// Groups of so many invocations that all of `count` have one.
    size_t groups(size_t count) const { return (count + lanes_ - 1) / lanes_; }

private:
    std::vector<float> read_numbers() const;

    size_t count_, lanes_;
    std::string given_text_;
    int product_count_ = 0;
    bool own_clear_ = false;  ///< the optimizer's numbers are zero
    Buffer numbers_, given_, products_, summaries_;
    Program summary_;
    std::map<std::tuple<Step, int, float>, Program> steps_;
};

}  // namespace radiafit
