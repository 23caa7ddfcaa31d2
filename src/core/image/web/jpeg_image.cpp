#include "image/web/jpeg_image.h"

#include <fmt/format.h>

#include <csetjmp>
#include <cstdio>
#include <cstdlib>

// It needs <cstdio> before it.
#include <jpeglib.h>

#include "base/error.h"

namespace radiafit {
namespace {

/// libjpeg leaves by a jump where it fails; nothing with a destructor may live between.
struct Failing {
    jpeg_error_mgr manager;  // first: libjpeg knows its address
    std::jmp_buf back;
    char message[JMSG_LENGTH_MAX] = {};
};

void leave(j_common_ptr common) {
    auto* failing = reinterpret_cast<Failing*>(common->err);
    common->err->format_message(common, failing->message);
    std::longjmp(failing->back, 1);
}

struct Encoded {
    unsigned char* bytes = nullptr;
    unsigned long size = 0;
    bool done = false;
};

void encode(int width, int height, const uint8_t* rgb, int quality, Failing& failing, Encoded& out) {
    jpeg_compress_struct state;
    state.err = jpeg_std_error(&failing.manager);
    failing.manager.error_exit = leave;
    if (setjmp(failing.back) != 0) {
        jpeg_destroy_compress(&state);
        return;
    }
    jpeg_create_compress(&state);
    jpeg_mem_dest(&state, &out.bytes, &out.size);
    state.image_width = JDIMENSION(width);
    state.image_height = JDIMENSION(height);
    state.input_components = 3;
    state.in_color_space = JCS_RGB;
    jpeg_set_defaults(&state);
    jpeg_set_quality(&state, quality, TRUE);
    state.dct_method = JDCT_FLOAT;
    for (int c = 0; c < 3; ++c) state.comp_info[c].h_samp_factor = state.comp_info[c].v_samp_factor = 1;
    jpeg_start_compress(&state, TRUE);
    while (state.next_scanline < state.image_height) {
        auto* row = const_cast<uint8_t*>(rgb + 3 * size_t(width) * state.next_scanline);  // it only reads
        jpeg_write_scanlines(&state, &row, 1);
    }
    jpeg_finish_compress(&state);
    jpeg_destroy_compress(&state);
    out.done = true;
}

}  // namespace

std::string jpeg_bytes(int width, int height, const std::vector<uint8_t>& rgb, int quality) {
    if (width < 1 || height < 1 || rgb.size() != 3 * size_t(width) * size_t(height))
        throw SystemError(fmt::format("a JPEG of {} x {} pixels was given {} bytes", width, height, rgb.size()));
    if (width > largest_jpeg_side || height > largest_jpeg_side)
        throw UserError(
            fmt::format("an image of {} x {} pixels is too large for JPEG, {} a side is the most; import it "
                        "smaller",
                        width, height, largest_jpeg_side));
    Failing failing;
    Encoded encoded;
    encode(width, height, rgb.data(), quality, failing, encoded);
    std::string out;
    if (encoded.done) out.assign(reinterpret_cast<const char*>(encoded.bytes), encoded.size);
    std::free(encoded.bytes);
    if (!encoded.done) throw SystemError(fmt::format("libjpeg: {}", failing.message));
    return out;
}

}  // namespace radiafit
