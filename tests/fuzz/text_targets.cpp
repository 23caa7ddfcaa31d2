// Text files of `import`: lamps, intensities, names, gains.
#include "capture/gains.h"
#include "capture/light_file.h"
#include "target.h"

namespace radiafit::fuzz {
using namespace tools;
namespace {

std::function<std::vector<std::string>(const fs::path&)> always(std::vector<std::string> seeds) {
    return [=](const fs::path&) { return seeds; };
}

}  // namespace

std::vector<Target> text_targets() {
    const std::string vectors = "# towards the lamps\n0 0 1\n0.5, -1e-3, 2\n-1\t0 3\n";
    return {
        {"lights_lp", "lights.lp", always({"2\r\na.png 0 0 1\nb with blanks.png 0.5 0 1e0\n", "1\n./a/b.jpg 1 0 0\n"}),
         [](const fs::path& folder) { read_lights(folder / "lights.lp"); }},
        {"lights_text", "lights.txt", always({vectors}),
         [](const fs::path& folder) { read_lights(folder / "lights.txt"); }},
        {"positions", "places.txt", always({vectors}),
         [](const fs::path& folder) { read_vectors(folder / "places.txt", "camera position"); }},
        {"intensities", "intensities.txt", always({"# rgb\n1\n0.5 0.25 1\n", "1, 2, 3\n1e-3\n"}),
         [](const fs::path& folder) { read_intensities(folder / "intensities.txt"); }},
        {"names", "names.txt", always({"a.png\nb with blanks.png\n# no\nfolder/c.png\n"}),
         [](const fs::path& folder) { read_names(folder / "names.txt"); }},
        {"gains", "gains.txt", always({"# name gain\na.png 1.5\nb.png 3 0.5\nc.png 7\n", "a.png\t1 2\r\nb.png 1\n"}),
         [](const fs::path& folder) {
             read_gains(folder / "gains.txt", {"a.png", "b.png"});
         }}};
}

}  // namespace radiafit::fuzz
