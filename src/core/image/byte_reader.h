#pragma once
#include <cstdint>
#include <filesystem>
#include <string_view>

#include "image/image_header.h"

namespace radiafit {

/// Numbers in the bytes of a picture's file. A number beyond the end is a UserError.
class ByteReader {
public:
    enum class Order { little_endian, big_endian };
    ByteReader(std::filesystem::path file, std::string_view bytes, Order order)
        : file_(std::move(file)), bytes_(bytes), order_(order) {}

    /// A number of 1 to 8 bytes.
    uint64_t number(uint64_t at, int size) const {
        const std::string_view part = text(at, uint64_t(size));
        uint64_t value = 0;
        for (size_t i = 0; i < part.size(); ++i)
            value = value << 8 | uint8_t(part[order_ == Order::big_endian ? i : part.size() - 1 - i]);
        return value;
    }
    std::string_view text(uint64_t at, uint64_t size) const {
        if (at > bytes_.size() || size > bytes_.size() - at) fail("the file ends within its header");
        return bytes_.substr(at, size);
    }
    uint64_t size() const { return bytes_.size(); }
    [[noreturn]] void fail(const char* why) const { fail_damaged_image(file_, why); }
    const std::filesystem::path& file() const { return file_; }

private:
    std::filesystem::path file_;
    std::string_view bytes_;
    Order order_;
};

}  // namespace radiafit
