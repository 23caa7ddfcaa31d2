#pragma once
#include <algorithm>
#include <array>
#include <memory>
#include <span>
#include <tuple>
#include <vector>

#include "gl/shader_text.h"
#include "optim/engine.h"

/// What all engines on a graphics device have in common, whether fragment programs draw into textures or compute
/// shaders write to buffers, and whatever their problems are. Nothing here calls OpenGL.
namespace radiafit {

/// Every problem's numbers (optim/verbs.h) on the device.
class DeviceNumbers {
public:
    explicit DeviceNumbers(size_t problems) : count_(problems) {}
    virtual ~DeviceNumbers() = default;
    DeviceNumbers(const DeviceNumbers&) = delete;
    DeviceNumbers& operator=(const DeviceNumbers&) = delete;

    size_t count() const { return count_; }
    /// Fresh problems. samples: of each, or one number for the three problems of a vertex; 0 where nothing can be
    /// fitted.
    void reset(std::span<const uint32_t> samples);
    // These wait for the device.
    void outcomes(std::span<ProblemOutcome> out) const;  ///< [problems]
    void read_errors(std::span<float> out) const;        ///< [problems]

protected:
    virtual void write_fresh(std::span<const Status> status) = 0;
    /// [numbers][problems]
    virtual std::vector<float> read(std::initializer_list<int> numbers) const = 0;

private:
    size_t count_;
};

/// What a step's program depends on, the engine's arrays aside. Built in every iteration, so it allocates nothing.
using StepKey = std::tuple<Step, int, float>;
inline StepKey step_key(Step which, const Turn& turn) {
    return {which, turn.left_out, turn.left_out ? turn.first_step : 0};
}
/// What the programs of a step and of an update are compiled with.
Defines step_defines(Step which, const Turn& turn);
Defines update_defines(Update which);
template <class Program>
void set_turn(const Program& step, const Turn& turn) {
    step.set_if_used("rule", turn.rule);
    step.set_if_used("restart", turn.restart);
    step.set_if_used("slot", turn.slot);
    step.set_if_used("stop", turn.stop.residual, turn.stop.output_change);
}
/// numbers, constants: as update() of optim/engine.h has them. first_own: where the optimizer's numbers begin.
template <class Program>
void set_update(const Program& update, std::initializer_list<int> numbers, std::initializer_list<float> constants,
                int first_own) {
    int indices[4] = {};
    float values[4] = {};
    std::ranges::transform(numbers, indices, [&](int n) {
        return n >= number::first_product ? n - number::first_product
               : n >= number::first_own   ? n - number::first_own + first_own
                                          : n;
    });
    std::ranges::copy(constants, values);
    update.set_if_used("number_indices", std::span<const int>(indices));
    update.set_if_used("constants", std::span<const float>(values));
}
/// The sum over groups of problems. A group: how many are active, how many accepted, and their error as the bits of two
/// floats to be added.
EngineSummary sum_of(std::span<const std::array<uint32_t, 4>> groups);

/// Vectors and numbers of an engine, and the verbs of optim/engine.h that only fill, clear and read them. A derived
/// engine adds what knows samples, count() and the two passes over them, and what computes: dot(), step(), update().
/// Its constructor sets numbers_, calls make_room({}) and ends with count_bytes().
/// Vector: N floats on the device, with upload(values), download(values), clear(). Numbers: a DeviceNumbers, with
/// device_bytes(), all that this process has allocated on its device.
template <class Vector, class Numbers>
class DeviceEngine {
public:
    virtual ~DeviceEngine() = default;
    DeviceEngine(const DeviceEngine&) = delete;
    DeviceEngine& operator=(const DeviceEngine&) = delete;

    size_t problem_count() const { return numbers_->count(); }
    virtual size_t parameter_count() const = 0;  ///< N, floats in Parameters order, padding included

    void reset(std::span<const float> start) {
        for (Vector& v : vectors_) v.clear();
        vectors_[vector::trial].upload(start);
        vectors_[vector::p].upload(start);  // what a problem without samples returns
        numbers_->reset(sample_counts_);
    }
    void fit_terms(int first, int last) { first_term_ = first, last_term_ = last; }
    void make_room(const Room& room) {
        const int64_t before = Numbers::device_bytes();
        const size_t wanted = size_t(room.vector_count());
        if (wanted != vectors_.size()) drop_targets();  // names of textures come again
        while (vectors_.size() > wanted) vectors_.pop_back();
        while (vectors_.size() < wanted) vectors_.push_back(make_vector());
        for (size_t v = vector::first_own; v < wanted; ++v) vectors_[v].clear();
        make_products(room.product_count());
        numbers_->make_room(room);
        bytes_ += uint64_t(Numbers::device_bytes() - before);
    }
    EngineSummary summary() { return numbers_->summary(); }
    void outcomes(std::span<ProblemOutcome> out) const { numbers_->outcomes(out); }
    void read_errors(std::span<float> out) const { numbers_->read_errors(out); }
    /// Texels' parameters are in the gauge that their fits ended in, which may be another than the canonical one.
    void read_parameters(std::span<float> out) const { read(vector::p, out); }

    // What tests and agreement checks look at.
    struct Evaluation {
        std::vector<float> error;     ///< [M] E_t at the trial point
        std::vector<float> gradient;  ///< [N] Parameters order
        std::vector<float> diagonal;  ///< [N] fresh preconditioner
    };
    Evaluation read_evaluation() const {  ///< after gradient_pass(true)
        Evaluation result{trial_errors(), std::vector<float>(parameter_count()), std::vector<float>(parameter_count())};
        read(vector::trial_g, result.gradient);
        read(vector::fresh, result.diagonal);
        return result;
    }
    struct Line {
        std::vector<float> gauss_newton, curvature;  ///< [M], penalties included
        std::vector<float> third, fourth;            ///< [M] of light field maps, else empty
    };
    virtual Line read_line() const = 0;                                ///< after directional_pass()
    void set_line(std::span<const float> p, std::span<const float> d)  ///< [N] each, for directional_pass()
    {
        vectors_[vector::p].upload(p);
        vectors_[vector::d].upload(d);
    }

    /// Allocated on the device by this engine; fragment/fragment_plan.h and texel_plan.h predict it.
    uint64_t bytes() const { return bytes_; }

protected:
    DeviceEngine() = default;
    void make_spares() {
        while (spares_.size() < size_t(most_written)) spares_.push_back(make_vector());
    }
    void exchange_spares(Update which, std::span<const int> vectors) {
        for (size_t k = 0; k < size_t(updates[int(which)].written) && !spares_.empty(); ++k)
            std::swap(vectors_[size_t(vectors[k])], spares_[k]);
    }
    void count_bytes() { bytes_ = uint64_t(Numbers::device_bytes() - allocated_before_); }

    int64_t allocated_before_ = Numbers::device_bytes();
    std::unique_ptr<Numbers> numbers_;
    std::vector<Vector> vectors_;  ///< those of optim/verbs.h, then the optimizer's
    /// Where passes may not read what they write: as many as any update writes, which takes these and exchanges them
    /// for what it has written. Else none.
    std::vector<Vector> spares_;
    std::vector<uint32_t> sample_counts_;  ///< [problems], or of each three of a vertex; from count()
    int first_term_ = 0, last_term_ = 1 << 30;

private:
    virtual Vector make_vector() const = 0;
    virtual void make_products(int count) = 0;
    virtual void drop_targets() {}  ///< framebuffers that hold vectors
    virtual std::vector<float> trial_errors() const = 0;
    void read(int which, std::span<float> out) const {
        std::ranges::fill(out, 0.0f);
        vectors_[size_t(which)].download(out);
    }

    uint64_t bytes_ = 0;
};

}  // namespace radiafit
