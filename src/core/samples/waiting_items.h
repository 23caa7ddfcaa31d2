#pragma once
#include <algorithm>
#include <atomic>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "base/file.h"

namespace radiafit {

/// Items that wait by key until it is their key's turn: in memory up to a bound, beyond it in waiting.bin, which goes
/// with them. Item is trivially copyable.
template <class Item>
class WaitingItems {
public:
    /// `memory`: bytes held in memory at most after make_room(), what is set aside for more of a key included.
    /// `folder`: of the file; UserError is thrown if it is needed and the disk is full or the folder not writable.
    WaitingItems(size_t keys, uint64_t memory, const std::filesystem::path& folder)
        : memory_(memory), path_(folder / "waiting.bin"), held_(keys) {}
    WaitingItems(const WaitingItems&) = delete;
    WaitingItems& operator=(const WaitingItems&) = delete;
    ~WaitingItems() {
        std::error_code ignored;
        if (out_) std::filesystem::remove(path_, ignored);
    }
    /// To be called when all have been read. Throws std::filesystem::filesystem_error.
    void remove_file() {
        if (out_) std::filesystem::remove(path_);
    }

    size_t keys() const { return held_.size(); }
    /// Adds items behind the others of their key. Thread-safe for different keys.
    void add(size_t key, std::span<const Item> items) {
        std::vector<std::vector<Item>>& pieces = held_[key];
        while (!items.empty()) {
            if (pieces.empty() || pieces.back().size() == pieces.back().capacity()) {
                const size_t last = pieces.empty() ? 0 : pieces.back().capacity();
                pieces.emplace_back().reserve(std::clamp<size_t>(2 * last, 16, 2048));
            }
            std::vector<Item>& piece = pieces.back();
            const auto fit = items.first(std::min(items.size(), piece.capacity() - piece.size()));
            piece.insert(piece.end(), fit.begin(), fit.end());
            items = items.subspan(fit.size());
        }
    }
    /// Moves all to the file if they are too many. To be called after some have been added.
    void make_room() {
        uint64_t held = 0;
        for (const auto& pieces : held_)
            for (const auto& piece : pieces) held += piece.capacity() * sizeof(Item) + sizeof piece;
        if (held > memory_) spill();
    }
    /// No more are added; from now on they may be read.
    void close() {
        if (!out_) return;
        out_->close();
        in_.emplace(path_);
    }

    uint64_t bytes(size_t key) const {
        uint64_t bytes = held_bytes(key);
        for (const auto& begin : spilled_) bytes += begin[key + 1] - begin[key];
        return bytes;
    }
    /// Appends a key's items to `out`, in the order in which they were added. Thread-safe.
    void get(size_t key, std::vector<Item>& out) const {
        if (out.empty()) out.reserve(bytes(key) / sizeof(Item));
        for (const auto& begin : spilled_) {
            const uint64_t bytes = begin[key + 1] - begin[key];
            if (bytes == 0) continue;
            const size_t at = out.size();
            out.resize(at + bytes / sizeof(Item));
            in_->read(out.data() + at, begin[key], bytes);
            bytes_read_ += bytes;
        }
        for (const auto& piece : held_[key]) out.insert(out.end(), piece.begin(), piece.end());
    }

    uint64_t bytes_written() const { return out_ ? out_->bytes() : 0; }
    uint64_t bytes_read() const { return bytes_read_; }
    size_t spills() const { return spilled_.size(); }

private:
    uint64_t held_bytes(size_t key) const {
        uint64_t items = 0;
        for (const auto& piece : held_[key]) items += piece.size();
        return items * sizeof(Item);
    }
    void spill() {
        if (!out_) out_.emplace(path_);
        std::vector<uint64_t>& begin = spilled_.emplace_back();
        for (auto& pieces : held_) {
            begin.push_back(out_->bytes());
            for (const auto& piece : pieces) out_->write(piece.data(), piece.size() * sizeof(Item));
            pieces.clear();
        }
        begin.push_back(out_->bytes());
    }

    uint64_t memory_;
    std::filesystem::path path_;
    std::vector<std::vector<std::vector<Item>>> held_;  ///< by key, in pieces, which grow without moving
    std::vector<std::vector<uint64_t>> spilled_;        ///< [spills][keys + 1] offsets in the file
    std::optional<OutputFile> out_;
    std::optional<InputFile> in_;
    mutable std::atomic<uint64_t> bytes_read_ = 0;
};

}  // namespace radiafit
