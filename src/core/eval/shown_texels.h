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
    /// Forgets all. pixels: of the picture that begins.
    void begin(size_t pixels) {
        const size_t places = std::bit_ceil(std::clamp(pixels, least, most));
        if (kept_.size() < places) kept_.assign(places, Kept{});
        mask_ = places - 1;
        if (++picture_ != 0) return;
        std::ranges::fill(kept_, Kept{});  // wrapped: no mark may pass for this picture's
        picture_ = 1;
    }
    /// colour_of() says what this texel shows.
    template <class ColourOf>
    const Colour& of(uint32_t texel, const ColourOf& colour_of) {
        Kept& kept = kept_[texel & mask_];
        if (kept.picture != picture_ || kept.texel != texel) kept = {texel, picture_, colour_of()};
        return kept.colour;
    }

private:
    static constexpr size_t least = 1 << 8, most = 1 << 16;
    struct Kept {
        uint32_t texel = 0, picture = 0;
        Colour colour = Colour::Zero();
    };
    std::vector<Kept> kept_;
    size_t mask_ = 0;
    uint32_t picture_ = 0;
};

}  // namespace radiafit
