#include "capture/light_doubt.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "base/wording.h"
#include "capture/axes_turn.h"
#include "dataset/encoding.h"
#include "dataset/image_stream.h"
#include "lamps/light_check.h"

namespace radiafit::tools {
namespace {

constexpr int longest_side = 96;
constexpr double clipped = 0.99;

/// Sum and number of the usable pixels of each block.
struct BlockMeans {
    std::vector<double> sum, count;
};

/// Its place in `stack`: one image's means.
void add_image(const Dataset& dataset, uint32_t view, int block, ImageStream& stream, LightStack& stack) {
    const Vec3d intensity = dataset.views[view].light->intensity;
    const double largest = has_largest_value(dataset.encoding) ? clipped : std::numeric_limits<double>::infinity();
    const auto width = size_t(dataset.grid.width);
    std::vector<float> values;
    TargetImage mask;
    stream.load_values(view, values);
    stream.load_mask(view, mask);
    BlockMeans means{std::vector<double>(stack.values.size() / stack.images()), {}};
    means.count = means.sum;
    for (int y = 0; y < stack.height * block; ++y)
        for (int x = 0; x < stack.width * block; ++x) {
            const size_t pixel = size_t(y) * width + size_t(x);
            const float* rgb = &values[3 * pixel];
            if (!mask.masked_in(pixel) || double(std::max({rgb[0], rgb[1], rgb[2]})) >= largest) continue;
            double value = 0, channels = 0;
            for (int c = 0; c < 3; ++c)
                if (intensity[c] > 0) value += double(rgb[c]) / intensity[c], ++channels;
            const size_t at = size_t(y / block) * size_t(stack.width) + size_t(x / block);
            means.sum[at] += value / channels;
            means.count[at] += 1;
        }
    for (size_t k = 0; k < means.sum.size(); ++k)
        if (2 * means.count[k] >= block * block)
            stack.values[k * stack.images() + view] = float(means.sum[k] / means.count[k]);
}

std::string as_percent(double share) { return fmt::format("{:.0f} %", 100 * std::max(share, 0.0)); }

/// named: the file's lines name their images.
std::string shift_words(const OrderFinding& found, bool named) {
    const int by = std::abs(found.shift);
    const std::string lines = by == 1 ? "line" : fmt::format("{} lines", by);
    if (named)
        return fmt::format("those of the images {} {} in the list: give each name the numbers that stand {} {} it", by,
                           found.shift > 0 ? "earlier" : "later", by == 1 ? "one line" : lines,
                           found.shift > 0 ? "below" : "above");
    return found.shift > 0
               ? fmt::format("those of the images {} earlier in the list: move its first {} to its end", by, lines)
               : fmt::format("those of the images {} later in the list: move its last {} to its beginning", by, lines);
}

std::string swap_words(const OrderFinding& found, const std::vector<std::string>& names) {
    constexpr size_t most = 6;
    std::string text;
    size_t count = 0;
    for (size_t i = 0; i < found.entry.size(); ++i) {
        if (found.entry[i] == i) continue;
        if (++count > most) continue;
        text += fmt::format("{}{} is lit as it says of {}", count > 1 ? ", " : "", names[i], names[found.entry[i]]);
    }
    if (count > most) text += fmt::format(", and {} more", count - most);
    return text + ": exchange these lamps";
}

std::string order_words(const OrderFinding& found, bool named, const std::vector<std::string>& names) {
    using Kind = OrderFinding::Kind;
    if (found.kind == Kind::swapped) return swap_words(found, names);
    std::string text;
    if (found.kind == Kind::reversed)
        text = fmt::format("its lamps are those of the images in reverse order: {}",
                           named ? "give the numbers of its lines to its names in reverse order"
                                 : "turn the order of its lines round");
    if (found.kind == Kind::shifted) text = "its lamps are " + shift_words(found, named);
    if (found.kind == Kind::by_number)
        text = fmt::format(
            "its lamps are those of the images in the order of their numbers (img2 before img10): {}",
            named ? "give them to its names in that order"
                  : fmt::format("list them so for {}, or give all numbers as many digits", option_name("names")));
    if (found.kind == Kind::unknown)
        text = fmt::format("its lamps are not those of the images in this order: check {}",
                           named ? fmt::format("the names in it, or try {}", option_name("by-order"))
                                 : fmt::format("{}, or the images' names", option_name("names")));
    text += fmt::format(" (as it is, it explains {} of what changes with the lamp", as_percent(found.explained));
    if (found.kind != Kind::unknown) text += fmt::format(", so {}", as_percent(found.explained_so));
    return text + ")";
}

/// How the file lies, and what helps.
std::string turn_words(const AxesTurn& turn, const std::string& axes) {
    Mat3d cure = Mat3d::Identity();  // of the axes as they were read
    const bool quarters = std::remainder(turn.degrees, 90.0) == 0;
    const AxesTurn by_option = quarters ? turn : AxesTurn{turn.mirrored, 0};
    cure.topLeftCorner<2, 2>() = by_option.matrix().transpose().array().round();
    if (const auto read = parse_axes_turn(axes)) cure = (cure * *read).eval();
    const std::string option = cure.isIdentity(0)
                                   ? fmt::format("leave {} out", option_name("light-axes"))
                                   : fmt::format("give {} {}", option_name("light-axes"), axes_turn_text(cure));
    if (turn.mirrored && turn.degrees == 0) return "its y points down, its axes are left-handed: " + option;
    if (turn.mirrored && turn.degrees == 180) return "its x points to the left, its axes are left-handed: " + option;
    if (quarters && turn.mirrored) return "its x and y are exchanged, its axes are left-handed: " + option;
    if (quarters)
        return fmt::format("it is turned by {:.0f} degrees {}: {}", turn.degrees == 270 ? 90 : turn.degrees,
                           turn.degrees == 270  ? "clockwise"
                           : turn.degrees == 90 ? "counterclockwise"
                                                : "about the line of sight",
                           option);
    const double degrees = turn.degrees > 180 ? turn.degrees - 360 : turn.degrees;
    const auto by = [](double d) {
        return fmt::format("{:.0f} degrees {}", std::abs(d), d > 0 ? "counterclockwise" : "clockwise");
    };
    if (turn.mirrored)
        return fmt::format("its axes are left-handed and turned: {}, and turn its lamps by {}", option, by(degrees));
    return fmt::format("it is turned by about {}: turn its lamps back", by(degrees));
}

}  // namespace

LightStack light_stack(const Dataset& dataset) {
    const int longest = std::max(dataset.grid.width, dataset.grid.height),
              block = (longest + longest_side - 1) / longest_side;
    LightStack stack;
    stack.width = dataset.grid.width / block;
    stack.height = dataset.grid.height / block;
    stack.pixel = block * dataset.grid.right.norm();
    for (const View& view : dataset.views) {
        stack.names.push_back(view.name);
        stack.lamps.push_back(*view.light);
    }
    stack.values.assign(size_t(stack.width) * size_t(stack.height) * stack.images(),
                        std::numeric_limits<float>::quiet_NaN());
    const ImageStream first(dataset, StreamSource::disk, TargetSpace::linear);
    std::vector<ImageStream> streams;
    for (int i = 0; i < thread_count(); ++i) streams.push_back(first.another());
    parallel_for(stack.images(), 1,
                 [&](size_t i, int worker) { add_image(dataset, uint32_t(i), block, streams[size_t(worker)], stack); });
    return stack;
}

std::optional<std::string> light_doubt(const Dataset& dataset, const std::filesystem::path& file, bool named,
                                       const std::string& axes) {
    const LightFinding found = check_lights(light_stack(dataset));
    std::vector<std::string> names;
    for (const View& view : dataset.views) names.push_back(view.name);
    if (found.order) return fmt::format("{}: {}", file.string(), order_words(*found.order, named, names));
    if (!found.turn) return {};
    if (!found.turn_is_sure)
        return fmt::format("{}: its axes are not those of the images (x right, y up); perhaps {}", file.string(),
                           turn_words(*found.turn, axes));
    return fmt::format("{}: by the images, {}", file.string(), turn_words(*found.turn, axes));
}

}  // namespace radiafit::tools
