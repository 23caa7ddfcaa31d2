// Calibrations that are not COLMAP's: transforms.json and poses_bounds.npy.
#include "capture/llff.h"
#include "capture/transforms.h"
#include "capture_fixture.h"
#include "lens_trial.h"
#include "target.h"

namespace radiafit::fuzz {
using namespace tools;
namespace {

using radiafit::testing::Bytes;

std::string picture() { return radiafit::testing::encode_png(6, 5, 3, 8, std::vector<uint16_t>(90, 9)); }

std::vector<std::string> transforms_seeds(const fs::path& folder) {
    fs::create_directories(folder / "images");
    for (const char* name : {"images/a.png", "images/b.png", "b.png"}) put_bytes(folder / name, picture());
    const std::string pose = R"([[1,0,0,0.5],[0,0,-1,2e0],[0,1,0,-3],[0,0,0,1]])";
    return {
        R"({"camera_angle_x":0.7,"frames":[{"file_path":"./images/a","transform_matrix":)" + pose + "}]}\n",
        R"({"fl_x":60,"fl_y":61.5,"cx":3,"cy":2,"w":6,"h":5,"k1":0.1,"k2":-0.02,"p1":1e-3,"k4":0.01,"camera_model":"OPENCV","frames":[)"
        R"({"file_path":"images/a.png","fl_x":59,"mask_path":"images/b.png","transform_matrix":)" +
            pose + R"(},{"file_path":"/x/b.png","transform_matrix":)" + pose + "}]}\n"};
}

std::vector<std::string> llff_seeds(const fs::path& folder) {
    fs::create_directories(folder / "images");
    for (const char* name : {"images/a.png", "images/b.png"}) put_bytes(folder / name, picture());
    std::string header = "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 17), }";
    header.resize(117, ' ');
    Bytes bytes;
    for (int row = 0; row < 2; ++row)
        for (const double v : {0., 1., 0., 0.5, 5., 1., 0., 0., -1., 6., 0., 0., -1., 4., 60., 1., 9.}) bytes.put(v);
    return {std::string("\x93NUMPY\x01\0", 8) + Bytes().put(uint16_t{118}).text + header + "\n" + bytes.text};
}

}  // namespace

std::vector<Target> calibration_targets() {
    return {{"transforms_json", "transforms.json", transforms_seeds,
             [](const fs::path& folder) {
                 for (const CalibratedImage& image : read_transforms(find_transforms(folder), folder).images)
                     try_lens(image);
             }},
            {"llff", "poses_bounds.npy", llff_seeds,
             [](const fs::path& folder) { read_llff(folder / "poses_bounds.npy", folder / "images"); }}};
}

}  // namespace radiafit::fuzz
