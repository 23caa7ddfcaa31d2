#pragma once
#include <map>
#include <string>
#include <vector>

#include "compute/problem_buffers.h"
#include "fragment/texel_arrays.h"

namespace radiafit {

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

protected:
    /// In what the arrays of the two engines differ.
    struct Arrays {
        std::string problems;                ///< "vertices_given" or "texels_given", of shaders/compute
        size_t problem_count = 0;            ///< M
        size_t given_bytes = 0;              ///< what passes leave of all problems
        size_t vec4s = 0;                    ///< of a vector
        size_t product_bytes = 0;            ///< of a dot product of all problems
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
