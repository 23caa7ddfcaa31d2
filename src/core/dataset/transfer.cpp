#include "dataset/dataset.h"

namespace radiafit {

std::string to_string(Encoding encoding) {
    switch (encoding) {
        case Encoding::u8_srgb:
            return "u8-srgb";
        case Encoding::u8_linear:
            return "u8-linear";
        case Encoding::u16_linear:
            return "u16-linear";
        case Encoding::f16_linear:
            return "f16-linear";
        case Encoding::f32_linear:
            return "f32-linear";
    }
    return "unknown";
}

int bytes_per_channel(Encoding encoding) {
    if (encoding == Encoding::f32_linear) return 4;
    return encoding == Encoding::u8_srgb || encoding == Encoding::u8_linear ? 1 : 2;
}

double decode(Encoding encoding, double stored) { return encoding == Encoding::u8_srgb ? srgb_decode(stored) : stored; }

double encode(Encoding encoding, double linear) { return encoding == Encoding::u8_srgb ? srgb_encode(linear) : linear; }

}  // namespace radiafit
