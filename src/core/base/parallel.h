#pragma once
#include <cstddef>
#include <functional>

/// Data parallelism for passes whose iterations are independent. Results never depend on the number of threads.
namespace radiafit {

/// Threads used by parallel_for from now on; 0 means all cores. Set once, by the command line.
void set_thread_count(int threads);
int thread_count();
/// Cores this process may run on (a container or taskset may grant fewer than the machine has).
int core_count();

/// For a program's first lines. OpenBLAS, where a library brings it along, starts threads as it is loaded, which wait
/// for their first work by spinning for a tenth of a second; ended, they begin anew when there is some.
void end_idle_blas_threads();

/// Calls body(i, worker) for every i in [0, count), in chunks of `grain` handed out dynamically.
/// worker in [0, thread_count()) selects per-thread scratch space. Of exceptions that of the lowest chunk
/// is rethrown to the caller, and chunks not begun by then are skipped. A call from inside a body runs inline, under
/// that body's worker index.
void parallel_for(size_t count, size_t grain, const std::function<void(size_t i, int worker)>& body);

/// The same over chunks: body(begin, end, worker) once per chunk, for loops whose body is too small for a call.
void parallel_chunks(size_t count, size_t grain, const std::function<void(size_t begin, size_t end, int worker)>& body);

}  // namespace radiafit
