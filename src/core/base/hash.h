#pragma once
#include <cstdint>
#include <cstring>

namespace radiafit {

inline constexpr uint64_t hash_start = 0xcbf29ce484222325u, hash_factor = 0x100000001b3u;  // of FNV-1a

/// FNV-1a over words of 64 bits (the last one filled with zeros): notices what changed or rotted, no forgery.
inline uint64_t hash_bytes(const void* data, size_t size, uint64_t hash = hash_start) {
    const auto* at = static_cast<const unsigned char*>(data);
    for (; size > 0;) {
        const size_t bytes = size < sizeof(uint64_t) ? size : sizeof(uint64_t);
        uint64_t word = 0;
        std::memcpy(&word, at, bytes);
        hash = (hash ^ word) * hash_factor;
        hash ^= hash >> 32;
        at += bytes;
        size -= bytes;
    }
    return hash;
}

/// FNV-1a proper, over bytes: slower, but the same for data in one piece or in several.
inline uint64_t hash_byte_by_byte(const void* data, size_t size, uint64_t hash = hash_start) {
    const auto* at = static_cast<const unsigned char*>(data);
    for (size_t i = 0; i < size; ++i) hash = (hash ^ at[i]) * hash_factor;
    return hash;
}

}  // namespace radiafit
