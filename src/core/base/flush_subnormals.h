#pragma once
#if defined(__SSE__)
#include <xmmintrin.h>
#endif

namespace radiafit {

/// While one lives, this thread takes floats below the smallest normal one (1.2e-38) for zero, in results and operands.
/// Some processors need a hundred cycles for each of them. Elsewhere than on x86 it does nothing.
class FlushSubnormals {
public:
#if defined(__SSE__)
    FlushSubnormals() : before_(_mm_getcsr()) { _mm_setcsr(before_ | 0x8040); }
    ~FlushSubnormals() { _mm_setcsr(before_); }
#else
    FlushSubnormals() {}
    ~FlushSubnormals() {}
#endif
    FlushSubnormals(const FlushSubnormals&) = delete;
    FlushSubnormals& operator=(const FlushSubnormals&) = delete;

private:
    [[maybe_unused]] unsigned before_ = 0;
};

}  // namespace radiafit
