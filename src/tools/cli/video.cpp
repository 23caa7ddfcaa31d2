#include "cli/video.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "base/choose.h"
#include "base/error.h"
#include "base/log.h"
#include "base/program.h"
#include "cli/pictures.h"
#include "image/png_file.h"

namespace radiafit::tools {
namespace {

namespace fs = std::filesystem;

struct Format {
    const char *ending, *name;
    std::vector<std::string> codec;
    const char *opaque, *transparent;  ///< names of pixel formats; null: it has none
};
/// Both with near to no visible loss.
const std::vector<Format>& formats() {
    static const std::vector<Format> all = {
        {".mp4", "mp4", {"-c:v", "libx264", "-crf", "16", "-movflags", "+faststart"}, "yuv420p", nullptr},
        {".webm",
         "webm",
         {"-c:v", "libvpx-vp9", "-crf", "20", "-b:v", "0", "-auto-alt-ref", "0"},
         "yuv420p",
         "yuva420p"}};
    return all;
}

/// A path as it is written in a pattern of ffmpeg's, where % begins a number.
std::string in_pattern(const std::string& path) {
    std::string out;
    for (const char c : path) out.append(c == '%' ? 2 : 1, c);
    return out;
}

/// Checks all that can be known before a frame is made.
fs::path checked(fs::path file, const Background& background) {
    const Format* found = nullptr;
    for (const Format& format : formats())
        if (file.extension() == format.ending) found = &format;
    if (!found || file.stem().empty())
        throw UserError(fmt::format("--video {}: name a file that ends in .mp4 or .webm", file.string()));
    if (background.transparent && !found->transparent)
        throw UserError(fmt::format("--video {}: {} has no transparency; choose .webm, or --background R,G,B",
                                    file.string(), found->ending));
    if (!on_path("ffmpeg"))
        throw UserError(
            fmt::format("--video {}: ffmpeg is missing; install it: apt-get install ffmpeg", file.string()));
    check_ours(file);
    return file;
}

}  // namespace

Video::Video(fs::path file, const Background& background)
    : file_(checked(std::move(file), background)),
      background_(background),
      film_(file_.parent_path()),
      frames_(file_.parent_path(), file_.filename().string()) {}

void Video::add(size_t number, const LightImage& frame) {
    const ByteImage bytes = to_bytes(frame, background_);
    write_png(frames_.path() / fmt::format("{:05d}.png", number), bytes.width, bytes.height, bytes.rgb);
    ++count_;
}

void Video::encode() {
    const auto format = std::ranges::find_if(formats(), [&](const Format& f) { return file_.extension() == f.ending; });
    const fs::path film = film_.path() / file_.filename();
    // Codecs halve the resolution of colour, which asks for even sides; and colours are converted by BT.709's matrix,
    // which players take for granted.
    std::vector<std::string> command = {
        "ffmpeg",
        "-nostdin",
        "-loglevel",
        "error",
        "-y",
        "-framerate",
        std::to_string(frames_per_second),
        "-i",
        in_pattern(frames_.path().string()) + "/%05d.png",
        "-vf",
        "crop=trunc(iw/2)*2:trunc(ih/2)*2:0:0,scale=out_color_matrix=bt709:out_range=tv",
        "-colorspace",
        "bt709",
        "-color_primaries",
        "bt709",
        "-color_trc",
        "bt709",
        "-pix_fmt",
        background_.transparent ? format->transparent : format->opaque,
        "-metadata",
        fmt::format("comment={}", picture_remark()),
        "-f",
        format->name};
    command.insert(command.end(), format->codec.begin(), format->codec.end());
    command.push_back(film.string());
    const Ended ended = run_program(command);
    std::error_code error;
    if (ended.status != 0 || fs::file_size(film, error) == 0 || error)
        throw UserError(
            fmt::format("--video {}: ffmpeg ended with status {} and {}; leave --video out, and encode the "
                        "frames of --output yourself",
                        file_.string(), ended.status, ended.message.empty() ? "no film" : single_line(ended.message)));
}

void Video::commit() {
    check_ours(file_);  // again: something may be there by now
    film_.commit();
    log_info(fmt::format("{}: {} frames, {} a second", file_.string(), count_.load(), frames_per_second));
}

}  // namespace radiafit::tools
