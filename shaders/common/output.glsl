// RESULTS numbered results, all written, each to its own target; or ONLY one of them, as the paper's hardware would.
// RESULT: the type of each.
#ifndef RESULT
#define RESULT vec4
#endif
#ifdef ONLY
layout(location = 0) out RESULT written;
#define WRITE(results) written = results[ONLY]
#else
layout(location = 0) out RESULT written[RESULTS];
#define WRITE(results) \
    for (int i = 0; i < RESULTS; ++i) written[i] = results[i]
#endif
