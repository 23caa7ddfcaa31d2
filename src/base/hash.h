#pragma once
#include <cstdint>
#include <cstring>

namespace radiafit {

/// FNV-1a over words of 64 bits (the last one filled with zeros): notices what changed or rotted, no forgery.
inline uint64_t hash_bytes(const void* data, size_t size, uint64_t hash = 0xcbf29ce484222325u) {
    const auto* at = static_cast<const unsigned char*>(data);
    for (; size > 0;) {
        const size_t bytes = size < sizeof(uint64_t) ? size : sizeof(uint64_t);
        uint64_t word = 0;
        std::memcpy(&word, at, bytes);
        hash = (hash ^ word) * 0x100000001b3u;
        hash ^= hash >> 32;
        at += bytes;
        size -= bytes;
    }
    return hash;
}

}  // namespace radiafit
