#pragma once
#include "base/parallel.h"

namespace radiafit {

/// So many threads while it lives; see set_thread_count().
class ScopedThreads {
public:
    explicit ScopedThreads(int count) : before_(thread_count()) { set_thread_count(count); }
    ~ScopedThreads() { set_thread_count(before_); }
    ScopedThreads(const ScopedThreads&) = delete;
    ScopedThreads& operator=(const ScopedThreads&) = delete;

private:
    int before_;
};

}  // namespace radiafit
