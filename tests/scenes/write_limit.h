#pragma once
#include <sys/resource.h>

#include <csignal>

namespace radiafit {

/// A file may have this many bytes while it lives: the full disk that a test can make.
class WriteLimit {
public:
    explicit WriteLimit(rlim_t bytes) : old_handler_(std::signal(SIGXFSZ, SIG_IGN)) {
        getrlimit(RLIMIT_FSIZE, &old_);
        const rlimit limit{bytes, old_.rlim_max};
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~WriteLimit() {
        setrlimit(RLIMIT_FSIZE, &old_);
        std::signal(SIGXFSZ, old_handler_);
    }
    WriteLimit(const WriteLimit&) = delete;
    WriteLimit& operator=(const WriteLimit&) = delete;

private:
    rlimit old_;
    void (*old_handler_)(int);
};

}  // namespace radiafit
