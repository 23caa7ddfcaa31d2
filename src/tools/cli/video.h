#pragma once
#include <atomic>
#include <filesystem>
#include <string>

#include "base/atomic_file.h"
#include "eval/render.h"

namespace radiafit::tools {

/// A film of 30 frames a second, .mp4 (H.264) or .webm (VP9, which can be transparent), made by ffmpeg: an optional
/// program that is looked for on PATH when a film is asked for. It is written atomically, over an earlier one of
/// render's and over nothing else.
class Video {
public:
    static constexpr int frames_per_second = 30;

    /// Throws UserError for another ending, an ending that `background` doesn't fit, and where ffmpeg is missing.
    Video(std::filesystem::path file, const Background& background);

    /// The frame of that number, from 0 on; any thread. All of one size; kept as PNG in a hidden folder until encode().
    void add(size_t number, const LightImage& frame);
    /// Throws UserError with what ffmpeg says, if it fails.
    void encode();
    /// The film takes its name.
    void commit();

private:
    std::filesystem::path file_;
    Background background_;
    AtomicFiles film_;
    UnfinishedFolder frames_;
    std::atomic<int> count_ = 0;
};

}  // namespace radiafit::tools
