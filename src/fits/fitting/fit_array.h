#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "base/npy_file.h"
#include "base/rings.h"

namespace radiafit::fits {

/// Numbers of a fit where they lie in memory, described as NumPy describes arrays.
struct FitArray {
    std::string name, meaning;
    const char* type;  ///< npy_type()
    const void* data;
    std::vector<uint64_t> shape;
    std::vector<uint64_t> strides;  ///< bytes from one index to the next, of each dimension

    /// strides in elements; none: there are no gaps, and the last index runs fastest.
    template <class T>
    static FitArray of(std::string name, std::string meaning, const T* data, std::vector<uint64_t> shape,
                       std::vector<uint64_t> strides = {}) {
        if (strides.empty()) {
            strides.assign(shape.size(), 1);
            for (size_t i = shape.size(); i-- > 1;) strides[i - 1] = strides[i] * shape[i];
        }
        for (uint64_t& stride : strides) stride *= sizeof(T);
        return {std::move(name), std::move(meaning), npy_type<T>(), data, std::move(shape), std::move(strides)};
    }
};

}  // namespace radiafit::fits
