#pragma once
#include <cstdint>

/// Seeded random numbers that are the same on every platform and compiler: integers throughout, one exact conversion
/// to floating point, no distribution of the standard library (whose results are left to each vendor).
namespace radiafit {

/// PCG32 (O'Neill 2014, "PCG: A Family of Simple Fast Space-Efficient Statistically Good Algorithms for Random Number
/// Generation", XSH-RR 64/32): a sequence of 2⁶⁴ numbers per stream.
class Rng {
public:
    explicit Rng(uint64_t seed, uint64_t stream = 0) : increment_(2 * stream + 1) {
        bits();
        state_ += seed;
        bits();
    }

    uint32_t bits() {
        const uint64_t old = state_;
        state_ = old * 6364136223846793005u + increment_;
        const auto shifted = static_cast<uint32_t>(((old >> 18) ^ old) >> 27);
        const auto turn = static_cast<uint32_t>(old >> 59);
        return shifted >> turn | shifted << (-turn & 31);
    }

    /// Uniform in [0, 1), a multiple of 2⁻²⁴, so exact in float.
    float uniform() { return static_cast<float>(bits() >> 8) * 0x1p-24f; }
    float uniform(float low, float high) { return low + (high - low) * uniform(); }

    /// Uniform in {0, …, count − 1}, without bias; count > 0.
    uint32_t index(uint32_t count) {
        const uint32_t rejected = -count % count;  // 2³² mod count
        uint32_t value = bits();
        while (value < rejected) value = bits();
        return value % count;
    }

private:
    uint64_t state_ = 0;
    uint64_t increment_;
};

/// Counter-based: random bits that depend on (seed, counter) alone, for parallel loops (the finalizer of SplitMix64,
/// Steele, Lea and Flood 2014, applied twice).
inline uint32_t random_bits(uint64_t seed, uint64_t counter) {
    const auto mix = [](uint64_t z) {
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return z ^ (z >> 31);
    };
    constexpr uint64_t golden = 0x9e3779b97f4a7c15u;
    return static_cast<uint32_t>(mix(mix(seed + golden) + golden * (counter + 1)) >> 32);
}

/// Uniform in [0, 1), a multiple of 2⁻²⁴.
inline float random_uniform(uint64_t seed, uint64_t counter) {
    return static_cast<float>(random_bits(seed, counter) >> 8) * 0x1p-24f;
}

}  // namespace radiafit
