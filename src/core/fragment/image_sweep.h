#pragma once
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "base/clock.h"
#include "dataset/image_stream.h"
#include "fragment/image_stack.h"
#include "fragment/sls_mesh.h"

namespace radiafit {

/// One image on the device and everything a pass needs to know about it.
struct ImageOnDevice {
    const Camera* camera;
    const Texture* texture;  ///< over a grid the stack that it is in
    float target_scale;      ///< per unit of a 16-bit channel
    int bits;
    const View* view = nullptr;
    size_t position = 0;  ///< in the sweep's order
};

/// Width and height that hold each of the views' images; at least 1.
std::array<int, 2> largest_image(const Dataset& dataset, std::span<const uint32_t> views);

/// Where the time of sweeps over images went.
struct SweepTimes {
    double stream_s = 0;     ///< wall: reading images into memory that the device fetches them from
    double upload_s = 0;     ///< wall: handing them to OpenGL, and waiting for a place to read them into
    double sweep_s = 0;      ///< wall: whole sweeps over images, both of the above included
    double sweep_cpu_s = 0;  ///< process CPU time of the same
    uint64_t sweeps = 0, images = 0;
};

/// Streams images through the device, batch by batch: over a mesh each image into a slot, over a grid a batch into one
/// stack, whose texture is then that of all its images.
class ImageSweep {
public:
    /// dataset must outlive it. keep_on_device: every image gets a place that it keeps, and is read once, by
    /// set_batch().
    ImageSweep(const Dataset& dataset, std::vector<uint32_t> views, StreamSource source, TargetSpace space,
               bool keep_on_device);
    int bits() const { return stream_.bits(); }  ///< per channel
    float scale16() const { return stream_.scale16(); }
    const std::vector<uint32_t>& views() const { return views_; }  ///< in the order of run()
    std::array<int, 2> largest() const { return largest_image(*dataset_, views_); }
    /// Once, before run(): how many images go together. Those over a mesh are put in an order in which neighbours do.
    void set_batch(int images);

    /// Every image once through body(const std::vector<ImageOnDevice>&); then end(), and the device is waited for.
    template <class Body, class End>
    void run(const Body& body, const End& end) {
        const double wall = wall_time_s(), cpu = cpu_time_s(), streamed = stream_.seconds();
        for (size_t first = 0, turn = 0; first < views_.size(); first += size_t(batch_), ++turn) {
            load(first, turn);
            body(on_device_);
            times_.images += on_device_.size();
        }
        end();
        gl().Finish();
        ++times_.sweeps;
        times_.stream_s += stream_.seconds() - streamed;
        times_.sweep_s += wall_time_s() - wall;
        times_.sweep_cpu_s += cpu_time_s() - cpu;
    }
    const SweepTimes& times() const { return times_; }

private:
    void load(size_t first, size_t turn);
    void make_stacks();
    void make_slots();
    void fill(ImageStack& stack, size_t first);
    void fill(ImageSlot& slot, uint32_t view);
    template <class Body>
    void time_upload(const Body& body);

    const Dataset* dataset_;
    std::vector<uint32_t> views_;
    ImageStream stream_;
    bool keep_on_device_;
    bool by_all_threads_ = false;  ///< whether images are converted so: not where all threads draw
    int batch_ = 1;
    std::vector<ImageSlot> slots_;         ///< two batches: one is filled while the other is read; or one for each view
    std::vector<ImageStack> stacks_;       ///< two, to take turns as slots do; or as many as hold each view
    std::optional<PixelUploads> uploads_;  ///< none once every view is on the device
    std::vector<ImageOnDevice> on_device_;
    SweepTimes times_;
};

}  // namespace radiafit
