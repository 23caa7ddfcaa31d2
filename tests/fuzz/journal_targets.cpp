// What a fit that was stopped has kept. Checksums guard its blocks; here they are put right, too, so that what lies
// behind them is met.
#include <cstring>

#include "base/hash.h"
#include "base/journal.h"
#include "target.h"

namespace radiafit::fuzz {
namespace {

constexpr const char* name = "fit.journal";
constexpr size_t blocks = 3;

/// Blocks of numbers and a vector, as a fit has them.
void finish(Journal& journal, float value) {
    std::vector<float> numbers(2 * blocks, value);
    std::vector<std::vector<int>> rows(blocks, std::vector<int>(4, 7));
    finish_blocks(
        &journal, blocks,
        [&](auto& visit, size_t block) {
            visit(std::span(numbers).subspan(2 * block, 2));
            visit(rows[block]);
        },
        [](size_t, int) {});
}

std::vector<std::string> seeds(const fs::path& folder) {
    Journal journal(folder / name, "a key", 1);
    finish(journal, 0.5f);
    journal.flush();
    return {bytes_of(folder / name)};
}

void read_journal(const fs::path& folder) {
    Journal journal(folder / name, Journal::key_of(folder / name), 0);
    finish(journal, 0.25f);
}

/// Gives every block whose length can be true the checksum that fits.
void read_vouched(const fs::path& folder) {
    std::string bytes = bytes_of(folder / name);
    size_t at = bytes.find('\n') + 1;  // 0 where there is none: no block then
    const uint64_t of_key = hash_bytes(bytes.data(), at);
    while (at > 0 && at + 32 <= bytes.size()) {
        uint64_t size = 0;
        std::memcpy(&size, &bytes[at + 16], sizeof size);
        if (size > bytes.size() - at - 32) break;
        const uint64_t hash = hash_bytes(&bytes[at + 24], size, hash_bytes(&bytes[at], 24, of_key));
        std::memcpy(&bytes[at + 24 + size], &hash, sizeof hash);
        at += 32 + size;
    }
    put_bytes(folder / name, bytes);
    read_journal(folder);
}

}  // namespace

std::vector<Target> journal_targets() {
    return {{"journal", name, seeds, read_journal}, {"journal_blocks", name, seeds, read_vouched}};
}

}  // namespace radiafit::fuzz
