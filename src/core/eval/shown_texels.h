#pragma once
#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

namespace radiafit {

/// What texels show to a camera, so that pixels which show the same ones take it from here: each is kept at the place
/// of its number's last digits, until another comes there.
template <class Colour>
class ShownTexels {
public:
    /// Of so many pixels of one picture.
    explicit ShownTexels(size_t pixels)
        : kept_(std::bit_ceil(std::clamp(pixels, size_t(1) << 8, size_t(1) << 21)),
                Kept{none, Colour(Colour::Zero())}) {}

    /// colour_of() says what this texel shows.
    template <class ColourOf>
    const Colour& of(uint32_t texel, const ColourOf& colour_of) {
        Kept& kept = kept_[texel & (kept_.size() - 1)];
        if (kept.texel != texel) kept = {texel, colour_of()};
        return kept.colour;
    }

private:
    static constexpr uint32_t none = ~uint32_t(0);
    struct Kept {
        uint32_t texel;
        Colour colour;
    };
    std::vector<Kept> kept_;
};

}  // namespace radiafit
