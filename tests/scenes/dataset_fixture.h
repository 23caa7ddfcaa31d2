#pragma once
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/half.h"
#include "base/rng.h"
#include "dataset/dataset.h"

/// Datasets that a test writes in a temporary folder.
namespace radiafit {

namespace fs = std::filesystem;

/// A test with a temporary folder, removed afterwards.
class DatasetTest : public ::testing::Test {
protected:
    DatasetTest() {
        const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
        std::string name = std::string("radiafit-") + info->name() + "-" + std::to_string(getpid());
        std::replace(name.begin(), name.end(), '/', '-');
        root_ = fs::temp_directory_path() / name;
        fs::remove_all(root_);
        fs::create_directories(root_);
    }
    ~DatasetTest() override {
        std::error_code ignored;
        fs::permissions(root_, fs::perms::owner_all, ignored);
        fs::remove_all(root_, ignored);
    }
    size_t entries() const { return size_t(std::distance(fs::directory_iterator(root_), fs::directory_iterator())); }

    fs::path root_;
};

/// The one line of the UserError that `body` throws.
inline std::string complaint(const std::function<void()>& body) {
    try {
        body();
    } catch (const UserError& error) {
        const std::string text = error.what();
        EXPECT_EQ(text.find('\n'), std::string::npos) << text;
        return text;
    }
    ADD_FAILURE() << "no UserError was thrown";
    return "";
}

inline void expect_in(const std::string& part, const std::string& text) {
    EXPECT_NE(text.find(part), std::string::npos) << "\"" << part << "\" is not in: " << text;
}

inline std::string read_text(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream out;
    out << in.rdbuf();
    return out.str();
}

inline void write_text(const fs::path& file, const std::string& text) { std::ofstream(file, std::ios::binary) << text; }

/// The text with its first `from` replaced.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
}

inline Mesh tetrahedron() {
    Mesh mesh;
    mesh.positions = {{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1.25f}};
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    return mesh;
}

/// What a dataset should give back: stored channels as double, masks as given.
struct Truth {
    Dataset header;
    std::vector<std::vector<double>> stored;  ///< [view][pixel * 3 + channel]
    std::vector<std::vector<uint8_t>> masks;  ///< [view][pixel], empty: none
};

struct Shape {
    int width, height;
    bool mask;
    Gain gain;
};

/// Writes random images; every value of an 8-bit encoding occurs.
inline Truth write_random(const fs::path& folder, Encoding encoding, const std::vector<Shape>& shapes) {
    Truth truth;
    Rng rng(7);
    DatasetWriter writer(folder);
    writer.set_encoding(encoding);
    for (size_t i = 0; i < shapes.size(); ++i) {
        const auto& [width, height, masked, gain] = shapes[i];
        View view;
        view.name = "view \"" + std::to_string(i) + "\"";
        view.camera = Camera::look_at({3, 1, 4.0 + double(i)}, {0, 0, 0}, {0, 0, 1}, 0.7, width, height);
        view.held_out = i % 2 == 1;
        view.gain = gain;
        view.crop_origin = {int(i), 2};
        view.full_size = {width + 5, height + 7};
        const size_t pixels = size_t(width) * size_t(height);
        std::vector<double> values(3 * pixels);
        std::vector<uint8_t> bytes(values.size() * size_t(bytes_per_channel(encoding)));
        for (size_t k = 0; k < values.size(); ++k) {
            uint16_t word = 0;
            if (encoding == Encoding::f16_linear) {
                word = half_from_float(rng.uniform(-0.5f, 3.0f));
                values[k] = double(float_from_half(word));
            } else if (encoding == Encoding::f32_linear) {
                const float value = rng.uniform(-0.5f, 3.0f);
                std::memcpy(bytes.data() + 4 * k, &value, 4);
                values[k] = double(value);
                continue;
            } else if (encoding == Encoding::u16_linear) {
                word = uint16_t(rng.index(65536));
                values[k] = word / 65535.0;
            } else {
                word = uint16_t(k < 256 ? k : rng.index(256));
                values[k] = word / 255.0;
            }
            std::memcpy(bytes.data() + k * size_t(bytes_per_channel(encoding)), &word,
                        size_t(bytes_per_channel(encoding)));
        }
        std::vector<uint8_t> mask(masked ? pixels : 0);
        for (uint8_t& m : mask) m = uint8_t(rng.index(2) * 200);
        writer.add(view, bytes.data(), mask);
        truth.header.views.push_back(view);
        truth.stored.push_back(values);
        truth.masks.push_back(mask);
    }
    truth.header.name = "random";
    truth.header.description = "Noise, in \"quotes\" and with ü.";
    truth.header.source = "a test";
    truth.header.mesh = tetrahedron();
    writer.finish(truth.header);
    return truth;
}

}  // namespace radiafit
