#include "target.h"

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"

namespace radiafit::fuzz {
namespace {

fs::path new_folder() {
    std::error_code ignored;
    const fs::path memory = "/dev/shm", parent = fs::is_directory(memory, ignored) ? memory : fs::temp_directory_path();
    std::string name = (parent / "radiafit-fuzz-XXXXXX").string();
    if (!mkdtemp(name.data())) throw SystemError("mkdtemp failed for " + name);
    return name;
}

}  // namespace

std::string bytes_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

void put_bytes(const fs::path& file, const std::string& bytes) {
    std::ofstream stream(file, std::ios::binary);
    if (!stream.write(bytes.data(), std::streamsize(bytes.size())).flush())
        throw SystemError("cannot write " + file.string());
}

Bench::Bench(Target target) : target_(std::move(target)), folder_(new_folder()) {
    set_thread_count(1);  // so that a finding comes again
    seeds_ = target_.seeds(folder_);
}

Bench::~Bench() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
}

bool Bench::read(const std::string& bytes) const {
    put_bytes(folder_ / target_.file, bytes);
    try {
        target_.read(folder_);
    } catch (const UserError&) {
        return false;
    }
    return true;
}

}  // namespace radiafit::fuzz
