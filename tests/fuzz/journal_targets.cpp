// What an interrupted fit kept. Checksums guard its blocks; here they are put right, so that what lies behind them is
// met.
#include <cstring>
#include <fstream>

#include "base/hash.h"
#include "base/journal.h"
#include "target.h"

namespace radiafit::fuzz {
namespace {

constexpr const char* key = "a key";

std::vector<std::string> seeds(const fs::path& folder) {
    const fs::path file = folder / "fit.journal";
    Journal journal(file, key, 1);
    for (uint64_t block = 0; block < 3; ++block) {
        BlockWriter writer;
        writer(std::vector<float>(block * 2, 0.5f));
        writer(block);
        journal.keep(block, writer.bytes());
    }
    journal.flush();
    return {bytes_of(file)};
}

/// Gives the head and every block whose length can be true the checksum that fits.
void vouch(const fs::path& file) {
    std::string bytes = bytes_of(file);
    const size_t line = std::string_view("radiafit-journal 1\n").size();
    const auto number = [&](size_t at) {
        uint64_t n = 0;
        std::memcpy(&n, &bytes[at], sizeof n);
        return n;
    };
    size_t at = line;
    for (size_t numbers = 1; at + 8 * numbers + 8 <= bytes.size(); numbers = 2) {
        const uint64_t length = number(at + 8 * (numbers - 1));
        if (length > bytes.size() - at - 8 * numbers - 8) break;
        uint64_t hash = hash_start;
        for (size_t i = 0; i < numbers; ++i) hash = hash_bytes(&bytes[at + 8 * i], 8, hash);
        at += 8 * numbers;
        hash = hash_bytes(&bytes[at], length, hash);
        std::memcpy(&bytes[at + length], &hash, sizeof hash);
        at += length + 8;
    }
    std::ofstream(file, std::ios::binary) << bytes;
}

void read(const fs::path& folder) {
    const fs::path file = folder / "fit.journal";
    const auto its_key = Journal::key_of(file);
    Journal journal(file, its_key.value_or(key), 0);
    for (uint64_t block = 0; block < 4; ++block) {
        std::vector<float> values;
        uint64_t last = 0;
        const auto fields = [&](auto& visit) {
            visit(values);
            visit(last);
        };
        once(&journal, block, fields, [] {});
    }
}

void vouch_and_read(const fs::path& folder) {
    vouch(folder / "fit.journal");
    read(folder);
}

}  // namespace

std::vector<Target> journal_targets() {
    return {{"journal", "fit.journal", seeds, read}, {"journal_blocks", "fit.journal", seeds, vouch_and_read}};
}

}  // namespace radiafit::fuzz
