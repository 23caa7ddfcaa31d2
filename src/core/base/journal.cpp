#include "base/journal.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <system_error>

#include "base/clock.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/log.h"

namespace radiafit {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t longest_key = 1 << 20, most_waiting = 32 << 20;

/// Before a block's bytes. They are followed by the checksum of the file's first line, this head and the bytes.
struct BlockHead {
    uint64_t stage, block, bytes;
};
static_assert(sizeof(BlockHead) == 24);

uint64_t checksum_of(const std::string& first_line, const BlockHead& head, std::string_view bytes) {
    const uint64_t hash = hash_bytes(&head, sizeof head, hash_bytes(first_line.data(), first_line.size()));
    return hash_bytes(bytes.data(), bytes.size(), hash);
}

void append(std::string& to, const auto& numbers) {
    to.append(reinterpret_cast<const char*>(&numbers), sizeof numbers);
}

std::string read_text(const InputFile& in, uint64_t most) {
    std::string text(std::min(in.size(), most), ' ');
    in.read(text.data(), 0, text.size());
    return text;
}

}  // namespace

Journal::Journal(fs::path file, const std::string& key, double seconds)
    : file_(std::move(file)), head_(key + "\n"), seconds_(seconds), written_s_(wall_time_s()) {
    std::error_code error;
    if (!fs::is_regular_file(file_, error)) return;
    in_.emplace(file_);
    if (read_text(*in_, head_.size()) == head_) read_blocks();
    if (end_ < in_->size())
        log_warning(
            fmt::format("{}: damaged behind byte {}: what was finished there is done again", file_.string(), end_));
}

void Journal::read_blocks() {
    end_ = head_.size();
    const uint64_t size = in_->size();
    std::string bytes;
    while (true) {
        BlockHead head{};
        uint64_t checksum = 0;
        if (size - end_ < sizeof head + sizeof checksum) return;
        in_->read(&head, end_, sizeof head);
        if (head.bytes > size - end_ - sizeof head - sizeof checksum) return;
        bytes.resize(head.bytes);
        in_->read(bytes.data(), end_ + sizeof head, head.bytes);
        in_->read(&checksum, end_ + sizeof head + head.bytes, sizeof checksum);
        if (checksum != checksum_of(head_, head, bytes)) return;
        old_[{head.stage, head.block}] = {end_ + sizeof head, head.bytes};
        end_ += sizeof head + head.bytes + sizeof checksum;
    }
}

std::optional<std::string> Journal::find(uint64_t stage, uint64_t block) const {
    const auto found = old_.find({stage, block});
    if (found == old_.end()) return {};
    std::string bytes(found->second.size, ' ');
    in_->read(bytes.data(), found->second.offset, bytes.size());
    return bytes;
}

void Journal::keep(uint64_t stage, uint64_t block, std::string_view bytes) {
    if (seconds_ <= 0) return;
    const BlockHead head{stage, block, bytes.size()};
    const uint64_t checksum = checksum_of(head_, head, bytes);
    const std::scoped_lock lock(mutex_);
    if (given_up_) return;
    append(waiting_, head);
    waiting_ += bytes;
    append(waiting_, checksum);
    if (wall_time_s() - written_s_ >= seconds_ || waiting_.size() >= most_waiting) write_waiting();
}

void Journal::flush() {
    const std::scoped_lock lock(mutex_);
    if (!waiting_.empty()) write_waiting();
}

void Journal::write_waiting() {
    const uint64_t size = (end_ == 0 ? head_.size() : 0) + waiting_.size();
    written_s_ = wall_time_s();
    std::error_code error;
    if (end_ == 0) fs::create_directories(file_.parent_path(), error);
    if (end_ > 0) fs::resize_file(file_, end_, error);  // what is damaged behind it
    std::ofstream out(file_, end_ > 0 ? std::ios::binary | std::ios::app : std::ios::binary | std::ios::trunc);
    if (end_ == 0) out << head_;
    out << waiting_ << std::flush;
    waiting_.clear();  // its memory is used again
    if (!error && out) {
        end_ += size;
        return;
    }
    given_up_ = true;
    log_warning(fmt::format("{}: cannot be written: what is finished is kept no longer", file_.string()));
}

std::string Journal::key_of(const fs::path& file) {
    const std::string text = read_text(InputFile(file), longest_key);
    return text.substr(0, text.find('\n'));
}

void BlockReader::throw_other_size() const {
    throw UserError(file_->string() + ": a block has another size than this program writes; delete the file");
}

}  // namespace radiafit
