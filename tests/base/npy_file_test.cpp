// Arrays in numpy's format: read in every order and type, refused with the reason where they are damaged.
#include "base/npy_file.h"

#include <gtest/gtest.h>

#include <fstream>

#include "base/error.h"
#include "npy_bytes.h"
#include "temporary_folder.h"

namespace radiafit {
namespace {

using namespace testing;

class NpyTest : public ::testing::Test {
protected:
    NpyReader read(const std::string& bytes) {
        std::ofstream(file_, std::ios::binary) << bytes;
        return {file_, "array"};
    }
    std::string complaint(const std::string& bytes) {
        try {
            read(bytes);
        } catch (const UserError& error) {
            return error.what();
        }
        return "";
    }

    TemporaryFolder folder_;
    const std::filesystem::path file_ = folder_.path() / "m.npy";
    const std::vector<double> values_ = {1, 2, 3, 4, 5.5, -6};
    const std::string data_ = bytes_of(values_);
};

TEST_F(NpyTest, MatricesOfEveryOrderAndType) {
    const auto expect = [&](const NpyReader& array) {
        EXPECT_EQ(array.shape(), (std::vector<uint64_t>{2, 3}));
        EXPECT_EQ(array.read<double>(), values_);
        EXPECT_EQ(array.read<float>(), std::vector<float>(values_.begin(), values_.end()));
        if (array.first_index_fastest())
            EXPECT_THROW(array.read<double>(2, 3), std::logic_error);
        else
            EXPECT_EQ(array.read<double>(2, 3), (std::vector<double>{3, 4, 5.5}));
        EXPECT_THROW(array.read<double>(4, 3), std::logic_error);
    };
    expect(read(npy("<f8", false, "(2, 3)", data_)));
    expect(read(npy("<f4", false, "(2, 3)", bytes_of(std::vector<float>(values_.begin(), values_.end())))));
    expect(read(npy("<f8", true, "(2, 3)", bytes_of<double>({1, 4, 2, 5.5, 3, -6}))));
    std::string second = npy("<f8", false, "(2, 3)", data_);
    second[6] = 2;
    second.insert(10, 2, '\0');  // the length's upper bytes
    expect(read(second));
}

TEST_F(NpyTest, FortransOrderRunsFirstIndexFastest) {
    std::vector<double> cube(2 * 3 * 4), fortran(cube.size());
    for (size_t i = 0; i < 2; ++i)
        for (size_t j = 0; j < 3; ++j)
            for (size_t k = 0; k < 4; ++k)
                cube[(i * 3 + j) * 4 + k] = fortran[i + 2 * (j + 3 * k)] = double(100 * i + 10 * j + k);
    EXPECT_EQ(read(npy("<f8", true, "(2, 3, 4)", bytes_of(fortran))).read<double>(), cube);
    EXPECT_EQ(read(npy("<f8", true, "(6,)", data_)).read<double>(), values_);
    EXPECT_TRUE(read(npy("<f8", true, "(0, 3)", "")).read<double>().empty());
    EXPECT_EQ(read(npy("<f8", true, "()", bytes_of<double>({7}))).read<double>(), std::vector<double>{7});
}

TEST_F(NpyTest, WholeNumbersOfEverySize) {
    const std::vector<int64_t> wanted = {0, 1, 100};
    const auto as = [&]<class T>(const char* type, T) {
        const NpyReader array = read(npy(type, false, "(3,)", bytes_of(std::vector<T>(wanted.begin(), wanted.end()))));
        return array.read<int64_t>();
    };
    EXPECT_EQ(as("|i1", int8_t()), wanted);
    EXPECT_EQ(as("|u1", uint8_t()), wanted);
    EXPECT_EQ(as("<i2", int16_t()), wanted);
    EXPECT_EQ(as("<u2", uint16_t()), wanted);
    EXPECT_EQ(as("<i4", int32_t()), wanted);
    EXPECT_EQ(as("<u4", uint32_t()), wanted);
    EXPECT_EQ(as("<i8", int64_t()), wanted);
    EXPECT_EQ(as("<u8", uint64_t()), wanted);
    EXPECT_THROW(read(npy("<f8", false, "(6,)", data_)).read<int64_t>(), UserError);
}

TEST_F(NpyTest, WhatIsDamagedIsNamedWithTheCure) {
    for (const std::string& bytes :
         {std::string("no array"), npy("<f8", false, "(2, 3)", data_).substr(0, 40), npy(">f8", false, "(2, 3)", data_),
          npy("<c8", false, "(2, 3)", data_), npy("<f8", false, "(3, 3)", data_),
          npy("<f8", false, "(2, 3)", data_ + "x"), npy("<f8", false, "(2, 3)", data_.substr(1)),
          npy("<f8", false, "(-2, 3)", data_), npy("<f8", false, "(18446744073709551615, 3)", data_),
          npy("<f8", false, "(2, 3", data_)}) {
        const std::string text = complaint(bytes);
        EXPECT_NE(text.find("m.npy: "), std::string::npos) << text;
        EXPECT_NE(text.find("numpy.save"), std::string::npos) << text;
        EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    }
}

}  // namespace
}  // namespace radiafit
