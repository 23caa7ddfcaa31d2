// The program of `make fuzz`: libFuzzer over one target.
//     fuzz_readers --list
//     fuzz_readers --target=NAME [--seeds=FOLDER] CORPUS... [libFuzzer's own flags]
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <string_view>

#include "target.h"

namespace {

std::unique_ptr<radiafit::fuzz::Bench> bench;

std::unique_ptr<radiafit::fuzz::Bench> open_bench(std::string_view name) {
    for (const auto& target : radiafit::fuzz::targets())
        if (target.name == name) return std::make_unique<radiafit::fuzz::Bench>(target);
    std::fprintf(stderr, "no target of that name; --list lists them\n");
    std::exit(2);
}

void list_targets() {
    for (const auto& target : radiafit::fuzz::targets()) std::puts(target.name.c_str());
    std::exit(0);
}

void write_seeds(const std::filesystem::path& folder) {
    std::filesystem::create_directories(folder);
    for (size_t i = 0; i < bench->seeds().size(); ++i)
        radiafit::fuzz::put_bytes(folder / ("seed" + std::to_string(i)), bench->seeds()[i]);
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
    for (int i = 1; i < *argc; ++i) {
        const std::string_view argument = (*argv)[i];
        if (argument == "--list") list_targets();
        if (argument.starts_with("--target=")) bench = open_bench(argument.substr(9));
        if (argument.starts_with("--seeds=") && bench) write_seeds(argument.substr(8));
    }
    if (!bench) open_bench("");
    std::atexit([] { bench.reset(); });
    return 0;
}

// On a machine that does other work too, libFuzzer's own -timeout would find what isn't there: it counts wall time.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    constexpr std::clock_t most = 5 * CLOCKS_PER_SEC;
    const std::clock_t begin = std::clock();
    bench->read({reinterpret_cast<const char*>(data), size});
    if (std::clock() - begin > most) {
        std::fprintf(stderr, "more than 5 s for one file\n");
        std::abort();
    }
    return 0;
}
