#include "base/journal.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "base/clock.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/log.h"
#include "base/read_file.h"

namespace radiafit {
namespace {

namespace fs = std::filesystem;

// The file: a line, the bytes of the key, the key, the checksum of both; of each block its number, its bytes, what it
// holds, and the checksum of all that. Numbers are of 64 bits, little-endian.
constexpr std::string_view first_line = "radiafit-journal 1\n";
constexpr uint64_t longest_key = 1 << 20, most_waiting = 32 << 20;

void append(std::string& to, uint64_t number) { to.append(reinterpret_cast<const char*>(&number), sizeof number); }

/// A prefix of `numbers`, the bytes, and their checksum.
void append_checked(std::string& to, std::initializer_list<uint64_t> numbers, std::string_view bytes) {
    uint64_t hash = hash_start;
    for (const uint64_t number : numbers) {
        append(to, number);
        hash = hash_bytes(&number, sizeof number, hash);
    }
    to.append(bytes);
    append(to, hash_bytes(bytes.data(), bytes.size(), hash));
}

/// The key, and where the first block begins.
struct Head {
    std::string key;
    uint64_t end;
};

std::optional<Head> read_head(const InputFile& in) {
    const uint64_t size = in.size();
    uint64_t at = first_line.size(), length = 0, checksum = 0;
    if (size < at + sizeof length) return {};
    std::string line(at, ' ');
    in.read(line.data(), 0, at);
    in.read(&length, at, sizeof length);
    at += sizeof length;
    if (line != first_line || length > longest_key || size < at + length + sizeof checksum) return {};
    Head head{std::string(length, ' '), at + length + sizeof checksum};
    in.read(head.key.data(), at, length);
    in.read(&checksum, at + length, sizeof checksum);
    if (checksum != hash_bytes(head.key.data(), length, hash_bytes(&length, sizeof length))) return {};
    return head;
}

/// 0 or errno.
int write_at(const fs::path& file, uint64_t offset, std::string_view bytes) {
    const int out = open(file.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
    if (out < 0) return errno;
    int error = ftruncate(out, off_t(offset)) == 0 ? 0 : errno;  // what is damaged behind it
    while (!error && !bytes.empty()) {
        const ssize_t put = pwrite(out, bytes.data(), bytes.size(), off_t(offset));
        if (put < 0 && errno == EINTR) continue;
        if (put <= 0) {
            error = put == 0 ? ENOSPC : errno;
            break;
        }
        offset += uint64_t(put);
        bytes.remove_prefix(size_t(put));
    }
    if (close(out) != 0 && !error) error = errno;
    return error;
}

}  // namespace

Journal::Journal(fs::path file, std::string key, double seconds)
    : file_(std::move(file)), key_(std::move(key)), seconds_(seconds), written_s_(wall_time_s()) {
    if (!stands(file_)) return;
    std::error_code error;
    if (fs::is_regular_file(file_, error)) in_.emplace(file_);
    const auto head = in_ ? read_head(*in_) : std::nullopt;
    if (!head) throw UserError(file_.string() + ": damaged, or no checkpoint; delete it");
    if (head->key != key_) throw UserError(file_.string() + ": a checkpoint of other work; delete it");
    end_ = head->end;
    read_blocks();
    kept_ = old_.size();
}

void Journal::read_blocks() {
    const uint64_t size = in_->size();
    std::string bytes;
    while (true) {
        uint64_t head[2], checksum = 0;  // block, bytes
        if (size - end_ < sizeof head + sizeof checksum) break;
        in_->read(head, end_, sizeof head);
        if (head[1] > size - end_ - sizeof head - sizeof checksum) break;
        bytes.resize(head[1]);
        in_->read(bytes.data(), end_ + sizeof head, head[1]);
        in_->read(&checksum, end_ + sizeof head + head[1], sizeof checksum);
        if (checksum != hash_bytes(bytes.data(), bytes.size(), hash_bytes(head, sizeof head))) break;
        old_[head[0]] = {end_ + sizeof head, head[1]};
        end_ += sizeof head + head[1] + sizeof checksum;
    }
    if (end_ < size)
        log_warning(
            fmt::format("{}: damaged behind byte {}: what was finished there is done again", file_.string(), end_));
}

size_t Journal::kept() const {
    const std::scoped_lock lock(mutex_);
    return kept_;
}

std::optional<std::string> Journal::find(uint64_t block) const {
    const auto found = old_.find(block);
    if (found == old_.end()) return {};
    std::string bytes(found->second.size, ' ');
    in_->read(bytes.data(), found->second.offset, bytes.size());
    return bytes;
}

void Journal::keep(uint64_t block, std::string_view bytes) {
    if (seconds_ <= 0) return;
    const std::scoped_lock lock(mutex_);
    if (given_up_) return;
    append_checked(waiting_, {block, bytes.size()}, bytes);
    ++kept_;
    if (wall_time_s() - written_s_ >= seconds_ || waiting_.size() >= most_waiting) write_waiting();
}

void Journal::flush() {
    const std::scoped_lock lock(mutex_);
    if (!given_up_ && !waiting_.empty()) write_waiting();
}

void Journal::write_waiting() {
    std::string bytes;
    if (end_ == 0) {
        bytes = first_line;
        append_checked(bytes, {key_.size()}, key_);
        std::error_code ignored;
        fs::create_directories(file_.parent_path(), ignored);
    }
    bytes += waiting_;
    if (const int error = write_at(file_, end_, bytes)) {
        given_up_ = true;
        log_warning(fmt::format("{}: {}: what is finished is kept no longer", file_.string(),
                                std::generic_category().message(error)));
        std::error_code ignored;
        if (truncate(file_.c_str(), off_t(end_)) != 0 || end_ == 0) fs::remove(file_, ignored);
        bytes.clear();
    }
    end_ += bytes.size();
    waiting_.clear();
    waiting_.shrink_to_fit();
    written_s_ = wall_time_s();
}

std::optional<std::string> Journal::key_of(const fs::path& file) {
    const auto head = read_head(InputFile(file));
    return head ? std::optional(head->key) : std::nullopt;
}

void BlockReader::throw_damaged() const {
    throw UserError(file_->string() + ": damaged: a block has another size than this program writes; delete it");
}

}  // namespace radiafit
