#include "base/parallel.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <sched.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <vector>

#include "base/error.h"
#include "base/interrupt.h"

namespace radiafit {
namespace {

using Chunk = std::function<void(size_t, size_t, int)>;

/// Index of the worker this thread is while it runs a body, −1 elsewhere. A nested call runs inline under the same
/// index, so scratch space selected by it is never shared by two threads.
thread_local int current_worker = -1;

/// One loop over chunks, shared by all workers.
struct Loop {
    const Chunk& body;
    size_t count;
    size_t grain;
    std::atomic<size_t> next{0};
    std::mutex error_mutex;
    std::exception_ptr error;
    size_t error_begin = 0;  ///< of the chunk that threw it

    void run(int worker) {
        const int outer_worker = current_worker;
        current_worker = worker;
        size_t begin = 0;
        try {
            while (throw_if_interrupted(), (begin = next.fetch_add(grain)) < count)
                body(begin, count - begin < grain ? count : begin + grain, worker);
        } catch (...) {
            next = count;  // the others stop at their next chunk
            std::scoped_lock lock(error_mutex);
            if (!error || begin < error_begin) {
                error = std::current_exception();
                error_begin = begin;
            }
        }
        current_worker = outer_worker;
    }
};

/// Threads 1 … n−1; the caller is worker 0. They sleep between loops and live until the count changes or the program
/// ends.
class Pool {
public:
    explicit Pool(int threads) {
        try {
            for (int worker = 1; worker < threads; worker++) threads_.emplace_back([this, worker] { serve(worker); });
        } catch (const std::system_error& error) {
            stop();
            throw UserError(fmt::format("{} threads cannot be started ({}); choose fewer", threads, error.what()));
        }
    }
    ~Pool() { stop(); }

    void run(Loop& loop) {
        {
            std::scoped_lock lock(mutex_);
            loop_ = &loop;
            generation_++;
            busy_ = threads_.size();
        }
        wake_.notify_all();
        loop.run(0);
        std::unique_lock lock(mutex_);
        done_.wait(lock, [this] { return busy_ == 0; });
        loop_ = nullptr;
    }

private:
    void stop() {
        {
            std::scoped_lock lock(mutex_);
            stopping_ = true;
        }
        wake_.notify_all();
        for (std::thread& thread : threads_) thread.join();
    }
    void serve(int worker) {
        size_t seen = 0;
        std::unique_lock lock(mutex_);
        while (true) {
            wake_.wait(lock, [&] { return stopping_ || generation_ != seen; });
            if (stopping_) return;
            seen = generation_;
            Loop* loop = loop_;
            lock.unlock();
            loop->run(worker);
            lock.lock();
            if (--busy_ == 0) done_.notify_one();
        }
    }

    std::mutex mutex_;
    std::condition_variable wake_;
    std::condition_variable done_;
    Loop* loop_ = nullptr;
    size_t generation_ = 0;
    size_t busy_ = 0;
    bool stopping_ = false;
    std::vector<std::thread> threads_;
};

std::atomic<int> requested_threads{0};
std::mutex pool_mutex;  // held for the whole of a loop: loops of two threads follow each other
std::unique_ptr<Pool> pool;

}  // namespace

void set_thread_count(int threads) {
    if (threads < 0) throw std::invalid_argument("set_thread_count: a negative number of threads");
    if (current_worker >= 0) throw std::logic_error("set_thread_count inside a parallel loop");
    std::scoped_lock lock(pool_mutex);
    pool.reset();
    requested_threads = threads;
}

int core_count() {
    static const int cores = [] {
        cpu_set_t set;
        if (sched_getaffinity(0, sizeof set, &set) == 0) return CPU_COUNT(&set);
        return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    }();
    return cores;
}

void end_idle_blas_threads() {
    if (void* end = dlsym(RTLD_DEFAULT, "blas_thread_shutdown_")) reinterpret_cast<int (*)()>(end)();
}

int thread_count() {
    const int threads = requested_threads;
    return threads == 0 ? core_count() : threads;
}

void parallel_chunks(size_t count, size_t grain, const Chunk& body) {
    if (count == 0) return;
    Loop loop{.body = body,
              .count = count,
              .grain = grain == 0 ? 1 : grain,
              .error_mutex = {},
              .error = {},
              .error_begin = 0};
    if (current_worker >= 0) {
        loop.run(current_worker);
    } else {
        std::scoped_lock lock(pool_mutex);
        if (loop.count <= loop.grain || thread_count() == 1) {
            loop.run(0);
        } else {
            if (!pool) pool = std::make_unique<Pool>(thread_count());
            pool->run(loop);
        }
    }
    if (loop.error) std::rethrow_exception(loop.error);
}

void parallel_for(size_t count, size_t grain, const std::function<void(size_t, int)>& body) {
    parallel_chunks(count, grain, [&body](size_t begin, size_t end, int worker) {
        for (size_t i = begin; i < end; i++) body(i, worker);
    });
}

}  // namespace radiafit
