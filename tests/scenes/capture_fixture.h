#pragma once
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

#include "base/error.h"

/// Small captures written by the test itself. PNG and COLMAP's binary files are encoded here, byte by byte from their
/// specifications, so that the readers are checked against something that is not the library they use.
namespace radiafit::testing {

namespace fs = std::filesystem;

inline void write_bytes(const fs::path& file, const std::string& bytes) {
    fs::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

inline std::string read_bytes(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

/// Runs and returns the UserError's text, which must be one line.
inline std::string complaint(const std::function<void()>& run) {
    try {
        run();
    } catch (const UserError& error) {
        const std::string text = error.what();
        EXPECT_EQ(text.find('\n'), std::string::npos) << text;
        EXPECT_GT(text.size(), 20u) << text;
        return text;
    } catch (const std::exception& error) {
        ADD_FAILURE() << "no UserError but: " << error.what();
        return "";
    }
    ADD_FAILURE() << "no error";
    return "";
}

inline void expect_in(const std::string& part, const std::string& text) {
    EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' is not in: " << text;
}

/// Little-endian bytes of plain values, one after another.
class Bytes {
public:
    template <class T>
    Bytes& put(T value) {
        char raw[sizeof(T)];
        std::memcpy(raw, &value, sizeof(T));
        text.append(raw, sizeof(T));
        return *this;
    }
    std::string text;
};

inline std::string big_endian(uint32_t v) {
    return {static_cast<char>(v >> 24), static_cast<char>(v >> 16), static_cast<char>(v >> 8), static_cast<char>(v)};
}

/// Different values from 0 to `largest`.
inline std::vector<uint16_t> ramp(size_t count, uint16_t largest) {
    std::vector<uint16_t> v(count);
    for (size_t i = 0; i < count; ++i) v[i] = static_cast<uint16_t>((i * 7919u + 13u) % (largest + 1u));
    return v;
}

/// Length, type, data and checksum.
inline std::string png_chunk(const std::string& type, const std::string& data) {
    uint32_t crc = 0xffffffffu;
    for (const char c : type + data) {
        crc ^= static_cast<uint8_t>(c);
        for (int k = 0; k < 8; ++k) crc = crc & 1 ? 0xedb88320u ^ (crc >> 1) : crc >> 1;
    }
    return big_endian(uint32_t(data.size())) + type + data + big_endian(~crc);
}

/// A zlib stream that holds the bytes as they are.
inline std::string stored_zlib(const std::string& raw) {
    std::string zlib = "\x78\x01";
    for (size_t at = 0; at < raw.size(); at += 65535) {
        const size_t size = std::min<size_t>(65535, raw.size() - at);
        zlib += at + size == raw.size() ? '\1' : '\0';
        for (const size_t v : {size, ~size & 0xffff}) {
            zlib += static_cast<char>(v & 255);
            zlib += static_cast<char>(v >> 8);
        }
        zlib += raw.substr(at, size);
    }
    uint32_t a = 1, b = 0;  // Adler-32
    for (const char c : raw) {
        a = (a + static_cast<uint8_t>(c)) % 65521;
        b = (b + a) % 65521;
    }
    zlib += big_endian(b << 16 | a);
    return zlib;
}

/// A PNG with stored (uncompressed) data, filter 0. samples: [height][width][channels], row 0 on top; bits 8 or 16;
/// channels 1 grey, 2 grey + alpha, 3 RGB, 4 RGBA.
inline std::string encode_png(int width, int height, int channels, int bits, const std::vector<uint16_t>& samples) {
    std::string raw;
    const size_t row = size_t(width) * size_t(channels);
    for (size_t y = 0; y < size_t(height); ++y) {
        raw += '\0';
        for (size_t i = 0; i < row; ++i) {
            if (bits == 16) raw += static_cast<char>(samples[y * row + i] >> 8);
            raw += static_cast<char>(samples[y * row + i] & 255);
        }
    }
    const auto chunk = png_chunk;
    const char color = channels == 1 ? 0 : channels == 2 ? 4 : channels == 3 ? 2 : 6;
    const std::string head = big_endian(uint32_t(width)) + big_endian(uint32_t(height)) +
                             std::string{static_cast<char>(bits), color, 0, 0, 0};
    return "\x89PNG\r\n\x1a\n" + chunk("IHDR", head) + chunk("IDAT", stored_zlib(raw)) + chunk("IEND", "");
}

/// A colour PFM, little-endian, rows bottom to top. values: [height][width][3], row 0 on top.
inline std::string encode_pfm(int width, int height, const std::vector<float>& values) {
    Bytes data;
    const size_t row = size_t(width) * 3;
    for (size_t y = size_t(height); y-- > 0;)
        for (size_t i = 0; i < row; ++i) data.put(values[y * row + i]);
    return "PF\n" + std::to_string(width) + " " + std::to_string(height) + "\n-1.0\n" + data.text;
}

/// A test with a temporary folder, removed afterwards.
class FolderTest : public ::testing::Test {
protected:
    FolderTest() {
        std::string name = (fs::temp_directory_path() / "radiafit-capture-XXXXXX").string();
        root_ = mkdtemp(name.data());
    }
    ~FolderTest() override { fs::remove_all(root_); }
    fs::path root_;
};

}  // namespace radiafit::testing
