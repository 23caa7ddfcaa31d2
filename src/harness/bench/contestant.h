#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "bench/work.h"
#include "fragment/fragment_engine.h"
#include "gl/group_trial.h"
#include "optim/optimizer.h"

namespace radiafit::harness {

/// A device with a scene's problems, ready to be timed.
class TimedDevice {
public:
    virtual ~TimedDevice() = default;

    /// The sum of the problems' errors at the start and after each of so many iterations.
    virtual std::vector<double> fit(int iterations) = 0;

    static constexpr int most_times = 8;  ///< of run()
    /// Makes ready for run(); not to be timed. A fit that has gone far is begun anew, for problems that have ended are
    /// passed over.
    virtual void prepare(Pass pass, int times) = 0;
    /// Runs the pass `times` times one after another; the device is done on return.
    virtual void run(Pass pass, int times) = 0;
    virtual bool has(Pass pass) const = 0;
    /// Seconds spent so far on reading images and handing them to the device.
    virtual double streaming_s() const { return 0; }
    /// The load of one run.
    virtual PassLoad load(Pass pass) = 0;

    /// Of compute shaders: invocations of their work groups, and what they were chosen by; else 0 and none.
    virtual size_t group_size() const { return 0; }
    virtual std::vector<TriedGroup> tried_groups() const { return {}; }
};

/// What an EngineContestant cannot ask an engine.
struct EngineHooks {
    std::function<void()> wait = {};          ///< until the device is done, if it is another one
    std::function<void()> distribute = {};    ///< if that is a separate pass
    std::function<PassLoad(Pass)> load = {};  ///< if its programs declare none
};

/// An engine that needs nothing but itself.
template <class E>
struct OnOpenGl {
    E engine;
    template <class... Args>
    explicit OnOpenGl(Args&&... args) : engine(std::forward<Args>(args)...) {}
};

/// For a device that runs fragment programs: images from host memory, each handed over in every sweep.
inline FragmentOptions fragment_options(Device device) {
    return {.passes = device == Device::paper_passes ? Passes::paper : Passes::combined};
}

/// Conjugate gradients by an engine; `Owner` holds it, as member `engine`, and all that it needs.
template <class Owner>
class EngineContestant : public TimedDevice {
public:
    /// start: in Parameters order. Samples are counted already.
    EngineContestant(std::unique_ptr<Owner> owner, std::vector<float> start, EngineHooks hooks)
        : owner_(std::move(owner)), start_(std::move(start)), hooks_(std::move(hooks)) {}

    std::vector<double> fit(int iterations) override {
        engine().reset(start_);
        iteration_ = unbegun;
        std::vector<double> errors;
        for (const TraceRow& row : optimize(engine(), schedule_, iterations).rows) errors.push_back(row.error);
        return errors;
    }

    void prepare(Pass pass, int times) override {
        const int further = pass == Pass::iteration ? times : 0;
        if (iteration_ == unbegun || iteration_ + further > last_iteration) begin();
    }

    void run(Pass pass, int times) override {
        for (int i = 0; i < times; ++i) switch (pass) {
                case Pass::gradient:
                    engine().gradient_pass(false);
                    break;
                case Pass::line:
                    engine().directional_pass();
                    break;
                case Pass::iteration:
                    iterate();
                    break;
                case Pass::distribution:
                    hooks_.distribute();
            }
        if (hooks_.wait) hooks_.wait();
    }

    bool has(Pass pass) const override { return pass != Pass::distribution || hooks_.distribute; }

    double streaming_s() const override {
        if constexpr (requires { owner_->engine.times(); })
            return owner_->engine.times().stream_s + owner_->engine.times().upload_s;
        return 0;
    }

    PassLoad load(Pass pass) override {
        if (hooks_.load) return hooks_.load(pass);
        if constexpr (requires { engine().passes(); }) {
            prepare(pass, 1);
            return declared_load(engine().passes(), [&] { run(pass, 1); });
        }
        return {};
    }

    size_t group_size() const override {
        if constexpr (requires { owner_->engine.group_size(); }) return owner_->engine.group_size();
        return 0;
    }
    std::vector<TriedGroup> tried_groups() const override {
        if constexpr (requires { owner_->engine.tried_groups(); }) return owner_->engine.tried_groups();
        return {};
    }

private:
    static constexpr int unbegun = -1;
    /// Behind it the schedule takes a fresh preconditioner, which is another pass.
    static constexpr int last_iteration = 9;
    static_assert(last_iteration >= most_times);

    auto& engine() { return owner_->engine; }
    void begin() {
        engine().reset(start_);
        engine().make_room(schedule_.room());
        schedule_.judge(engine(), iteration_ = 0);
        engine().summary();
    }
    void iterate() {
        schedule_.move(engine(), iteration_++);
        schedule_.judge(engine(), iteration_);
        engine().summary();
    }

    std::unique_ptr<Owner> owner_;
    std::vector<float> start_;
    EngineHooks hooks_;
    ConjugateGradients schedule_{OptimizerOptions{}};
    int iteration_ = unbegun;
};

}  // namespace radiafit::harness
