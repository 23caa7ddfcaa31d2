#pragma once
#include <map>
#include <span>
#include <string>
#include <vector>

#include "fragment/device_engine.h"
#include "fragment/texel_arrays.h"
#include "gl/context.h"
#include "gl/group_trial.h"
#include "gl/program.h"

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

    /// given: the text in shaders/compute that says what passes before a step leave of a problem. shared_bytes_each: of
    /// the shared memory of a work group, for each of its invocations, in the pass that takes most. items: of work that
    /// a group shares in passes over samples, as its size is chosen by (group_trial.h).
    ProblemBuffers(size_t problems, const std::string& given, size_t shared_bytes_each, size_t items);
    /// Invocations of a work group of every pass (Context::group_size).
    size_t lanes() const { return lanes_; }
    /// What they were chosen by; empty where they were not open.
    const std::vector<TriedGroup>& tried_groups() const { return tried_groups_; }
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
    static int64_t device_bytes() { return Context::current().allocated_bytes(); }

    const Buffer& given() const { return given_; }
    Buffer& given() { return given_; }
    /// Groups of so many invocations that all of `count` have one.
    size_t groups(size_t count) const { return (count + lanes_ - 1) / lanes_; }

private:
    void write_fresh(std::span<const Status> status) override;
    std::vector<float> read(std::initializer_list<int> numbers) const override;
    std::vector<float> read_all() const;  ///< [problems][number_count]

    std::vector<TriedGroup> tried_groups_;
    size_t lanes_;
    std::string given_text_;
    int product_count_ = 0;
    bool optimizer_clear_ = false;  ///< the optimizer's numbers are zero
    Buffer numbers_, given_, products_, summaries_;
    Program summary_;
    std::map<StepKey, Program> steps_;
};

/// Parameters, or as many numbers, in vec4s: of light field maps as Parameters order has them, of texels [map][texel].
class BufferVector : public FetchedBuffer {
public:
    /// texels: null for light field maps; it must outlive the vector.
    BufferVector(size_t vec4s, const TexelShape* texels) : FetchedBuffer(written("maps", vec4s)), texels_(texels) {}
    void upload(std::span<const float> values);
    void download(std::span<float> values) const;  ///< waits
    void clear() { buffer.clear(); }

private:
    template <class Body>
    void for_parameters(const Body& body) const;

    const TexelShape* texels_;
};

/// What both engines over compute shaders have in common: everything but the samples.
class BufferEngine : public DeviceEngine<BufferVector, ProblemBuffers> {
public:
    void dot(std::initializer_list<DotProduct> products);
    void step(Step which, const Turn& turn) { numbers_->step(which, turn); }
    void update(Update which, std::initializer_list<int> vectors, std::initializer_list<int> numbers,
                std::initializer_list<float> constants);

    size_t group_size() const { return numbers_->lanes(); }  ///< invocations of a work group of every pass
    const std::vector<TriedGroup>& tried_groups() const { return numbers_->tried_groups(); }

protected:
    /// In what the arrays of the two engines differ.
    struct Arrays {
        std::string problems;                ///< "vertices_given" or "texels_given", of shaders/compute
        size_t problem_count = 0;            ///< M
        size_t given_bytes = 0;              ///< what passes leave of all problems
        size_t vec4s = 0;                    ///< of a vector
        size_t product_bytes = 0;            ///< of a dot product of all problems
        size_t shared_bytes_each = 16;       ///< as ProblemBuffers has it
        size_t items = 128;                  ///< likewise
        const TexelShape* texels = nullptr;  ///< null for light field maps
    };
    /// Makes vectors and numbers; to be called before anything else.
    ProblemBuffers& make(const Arrays& arrays);
    /// Compiles the programs of all verbs here. prefix: of their files' names; groups: of a pass over all problems.
    void compile(const std::string& prefix, size_t groups);
    /// A program of shaders/compute; all that programs share is bound and set. more: definitions beside theirs.
    virtual Program program(const std::string& file, const Defines& more) const = 0;

private:
    BufferVector make_vector() const override { return {arrays_.vec4s, arrays_.texels}; }
    void make_products(int count) override { numbers_->make_products(count, arrays_.product_bytes); }
    const Program& update_program(Update which);

    Arrays arrays_;
    std::string prefix_;
    size_t groups_ = 0;
    Program dot_;
    std::map<Update, Program> updates_;
};

}  // namespace radiafit
