#include "dataset/dataset_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/leftovers.h"
#include "base/read_file.h"
#include "base/wording.h"
#include "dataset/encoding.h"

namespace radiafit {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;
constexpr const char* format_name = "radiafit-dataset";
/// Version 2 has lights, normals and f32-linear, version 3 grids, version 4 checksums.
constexpr int format_version = 4;
constexpr int first_with_checksums = 4;
constexpr int max_side = 1 << 16;  // pixels; keeps every product of sizes far from overflow

std::string dump(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

Json list(const Vec3d& v) { return {v.x(), v.y(), v.z()}; }

Json light_to_json(const Light& light) {
    const bool distant = light.kind == Light::Kind::distant;
    return {{distant ? "direction" : "position", list(light.place)}, {"intensity", list(light.intensity)}};
}

std::string checksum_text(uint64_t checksum) { return fmt::format("{:016x}", checksum); }

Json camera_to_json(const View& view) {
    const Camera& c = view.camera;
    Json json = {{"width", c.width}, {"height", c.height}};
    if (view.camera_direction) {
        json["direction"] = list(*view.camera_direction);
        return json;
    }
    json.update({{"fx", c.fx}, {"fy", c.fy}, {"cx", c.cx}, {"cy", c.cy}});
    Json& rotation = json["cam_from_world_rotation"];
    for (int row = 0; row < 3; ++row) rotation.push_back(list(c.cam_from_world_rotation.row(row)));
    json["cam_from_world_translation"] = list(c.cam_from_world_translation);
    return json;
}

Json gain_to_json(const Gain& gain) { return gain.uniform() ? Json(gain[0]) : Json(gain.channels); }

Json view_to_json(const View& view) {
    const Camera& c = view.camera;
    Json json = {{"name", view.name},
                 {"held_out", view.held_out},
                 {"camera", camera_to_json(view)},
                 {"gain", gain_to_json(view.gain)},
                 {"pixel_offset", view.pixel_offset},
                 {"mask_offset", view.mask_offset ? Json(*view.mask_offset) : Json(nullptr)},
                 {"peak", view.peak},
                 {"crop",
                  {{"x0", view.crop_origin[0]},
                   {"y0", view.crop_origin[1]},
                   {"full_width", view.full_size[0] > 0 ? view.full_size[0] : c.width},
                   {"full_height", view.full_size[1] > 0 ? view.full_size[1] : c.height}}}};
    if (view.light) json["light"] = light_to_json(*view.light);
    json["checksum"] = checksum_text(view.checksum.value());
    return json;
}

/// Reads typed fields of one object; every complaint names the file and the field's path.
class Fields {
public:
    Fields(const Json& json, const fs::path& file, std::string path)
        : json_(json), file_(file), path_(std::move(path)) {
        if (!json_.is_object()) fail("", "must be an object");
    }

    std::string text(const char* key) const {
        if (!at(key).is_string()) fail(key, "must be a text");
        return at(key).get<std::string>();
    }
    bool boolean(const char* key) const {
        if (!at(key).is_boolean()) fail(key, "must be true or false");
        return at(key).get<bool>();
    }
    double number(const char* key) const { return number(at(key), key); }
    /// One number, or three.
    Gain gain(const char* key) const {
        if (!at(key).is_array()) return number(key);
        if (at(key).size() != 3) fail(key, "must be a number, or 3 numbers");
        const Vec3d rgb = vector(key);
        return Gain({rgb[0], rgb[1], rgb[2]});
    }
    uint64_t count(const char* key) const {
        if (!at(key).is_number_unsigned()) fail(key, "must be a whole number, 0 or above");
        return at(key).get<uint64_t>();
    }
    std::optional<uint64_t> optional_count(const char* key) const {
        if (at(key).is_null()) return std::nullopt;
        return count(key);
    }
    uint64_t checksum(const char* key) const {
        const std::string digits = text(key);
        uint64_t value = 0;
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
        if (digits.size() != 16 || error != std::errc() || end != digits.data() + 16)
            fail(key, fmt::format("is \"{}\", not 16 hexadecimal digits", digits));
        return value;
    }
    bool has(const char* key) const { return json_.contains(key) && !json_.at(key).is_null(); }
    int side(const char* key, int least) const {
        const uint64_t value = count(key);
        if (value > uint64_t(max_side) || int(value) < least)
            fail(key, fmt::format("is {}, outside [{}, {}]", value, least, max_side));
        return static_cast<int>(value);
    }
    Vec3d vector(const char* key) const { return vector(at(key), key); }
    Mat3d rows(const char* key) const {
        const Json& json = at(key);
        if (!json.is_array() || json.size() != 3) fail(key, "must be 3 rows of 3 numbers");
        Mat3d m;
        for (int row = 0; row < 3; ++row) m.row(row) = vector(json[size_t(row)], key);
        return m;
    }
    Fields object(const char* key) const { return {at(key), file_, where(key)}; }
    std::vector<std::string> keys() const {
        std::vector<std::string> names;
        for (const auto& [key, value] : json_.items()) names.push_back(key);
        return names;
    }
    const Json& array(const char* key) const {
        if (!at(key).is_array()) fail(key, "must be a list");
        return at(key);
    }
    std::string where(const std::string& key) const {
        return path_.empty() || key.empty() ? path_ + key : path_ + "." + key;
    }
    [[noreturn]] void fail(const std::string& key, const std::string& what) const {
        const std::string field = where(key);
        throw_damaged(file_, (field.empty() ? "the text" : "\"" + field + "\"") + " " + what);
    }

private:
    const Json& at(const char* key) const {
        const auto found = json_.find(key);
        if (found == json_.end()) fail(key, "is missing");
        return *found;
    }
    double number(const Json& json, const char* key) const {
        // JSON has no NaN: writers put null in its place.
        if (!json.is_number()) fail(key, json.is_null() ? "is null: not a finite number" : "must be a number");
        return json.get<double>();
    }
    Vec3d vector(const Json& json, const char* key) const {
        if (!json.is_array() || json.size() != 3) fail(key, "must be 3 numbers");
        return {number(json[0], key), number(json[1], key), number(json[2], key)};
    }

    const Json& json_;
    const fs::path& file_;
    std::string path_;
};

Light light_from_json(const Fields& fields, const std::string& name) {
    Light light;
    const bool near = fields.has("position");
    if (near == fields.has("direction")) fields.fail("", "must have either a direction or a position");
    light.kind = near ? Light::Kind::near : Light::Kind::distant;
    light.place = fields.vector(near ? "position" : "direction");
    light.intensity = fields.vector("intensity");
    check_light(light, name);
    return light;
}

View view_from_json(const Fields& fields, const fs::path& file, Encoding encoding, bool checksums) {
    View view;
    view.name = fields.text("name");
    view.held_out = fields.boolean("held_out");
    const Fields camera = fields.object("camera");
    Camera& c = view.camera;
    c.width = camera.side("width", 1);
    c.height = camera.side("height", 1);
    if (camera.has("direction")) {
        view.camera_direction = camera.vector("direction");
    } else {
        c.fx = camera.number("fx");
        c.fy = camera.number("fy");
        c.cx = camera.number("cx");
        c.cy = camera.number("cy");
        c.cam_from_world_rotation = camera.rows("cam_from_world_rotation");
        c.cam_from_world_translation = camera.vector("cam_from_world_translation");
    }
    check_view(view, fmt::format("{}: view \"{}\"", file.string(), view.name));
    view.gain = fields.gain("gain");
    if (!is_gain(view.gain)) fields.fail("gain", "must be above 0, from 1e-12 to 1e12");
    if (fields.has("light") && !view.gain.uniform())
        fields.fail("gain", "must be one number where there is a light, whose intensity has the colours");
    view.pixel_offset = fields.count("pixel_offset");
    view.mask_offset = fields.optional_count("mask_offset");
    view.peak = static_cast<float>(fields.number("peak"));
    if (!(view.peak >= 0 && std::isfinite(view.peak))) fields.fail("peak", "must be finite and not below 0");
    if (has_largest_value(encoding) && view.peak != 1)
        fields.fail("peak", fmt::format("is {}, but is 1 for {} images", view.peak, to_string(encoding)));
    const Fields crop = fields.object("crop");
    view.crop_origin = {crop.side("x0", 0), crop.side("y0", 0)};
    view.full_size = {crop.side("full_width", 1), crop.side("full_height", 1)};
    if (fields.has("light"))
        view.light = light_from_json(fields.object("light"), fmt::format("{}: view \"{}\"", file.string(), view.name));
    if (checksums) view.checksum = fields.checksum("checksum");
    return view;
}

Encoding encoding_from(const Fields& fields) {
    const std::string name = fields.text("encoding");
    for (const Encoding e :
         {Encoding::u8_srgb, Encoding::u8_linear, Encoding::u16_linear, Encoding::f16_linear, Encoding::f32_linear})
        if (name == to_string(e)) return e;
    fields.fail("encoding",
                fmt::format("is \"{}\", not one of u8-srgb, u8-linear, u16-linear, f16-linear, f32-linear", name));
}

}  // namespace

void throw_damaged(const fs::path& file, const std::string& what) {
    throw UserError(fmt::format("{}: {}; {}", file.string(), what,
                                at_command_line("run radiafit generate or import again", "make the dataset again")));
}

bool is_gain(const Gain& gain) { return gain.least() >= 1e-12 && gain.most() <= 1e12; }

void check_view(const View& view, const std::string& name) {
    if (!view.camera_direction) return check_camera(view.camera, name);
    if (const double length = view.camera_direction->norm(); !(std::abs(length - 1) <= 1e-4))  // not a number either
        throw UserError(
            fmt::format("{}: the direction to the camera has length {:.6g}; give a unit vector", name, length));
}

std::string read_dataset_file(const fs::path& file) {
    const fs::path folder = file.parent_path();
    restore_interrupted(folder);
    if (!path_exists(folder))
        throw UserError(
            fmt::format("{}: no such folder; {}", folder.string(),
                        at_command_line("radiafit generate or import makes a dataset", "give a dataset's folder")));
    if (!folder_exists(folder))
        throw UserError(fmt::format("{}: a dataset is a folder, this is a file; give the folder", folder.string()));
    if (!path_exists(file))
        throw UserError(
            fmt::format("{}: not a packed dataset, it has no {}; {}", folder.string(), dataset_json_name,
                        at_command_line("radiafit generate or import makes one", "give a dataset's folder")));
    std::string text = read_file(file, "dataset's description");
    if (text.empty()) throw_damaged(file, "the file is empty");
    return text;
}

std::string dataset_to_json(const Dataset& dataset, const DatasetSizes& sizes) {
    Json head = {{"format", format_name},
                 {"version", format_version},
                 {"name", dataset.name},
                 {"description", dataset.description},
                 {"source", dataset.source},
                 {"encoding", to_string(dataset.encoding)},
                 {"images_bytes", sizes.images_bytes},
                 {"vertices", sizes.vertices},
                 {"triangles", sizes.triangles}};
    if (const Grid& g = dataset.grid; dataset.has_grid())
        head["grid"] = {{"width", g.width},       {"height", g.height},   {"origin", list(g.origin)},
                        {"right", list(g.right)}, {"down", list(g.down)}, {"normals", sizes.grid_normals}};
    if (dataset.normal_map.side > 0) head["normals"] = {{"side", dataset.normal_map.side}};
    head["checksums"] = Json::object();
    for (const auto& [name, checksum] : dataset.checksums) head["checksums"][name] = checksum_text(checksum);
    // One line per view: a person can read it, and a text tool can compare two.
    std::string text = "{\n";
    for (const auto& [key, value] : head.items()) text += fmt::format("  \"{}\": {},\n", key, dump(value));
    text += "  \"views\": [\n";
    for (size_t i = 0; i < dataset.views.size(); ++i)
        text += "    " + dump(view_to_json(dataset.views[i])) + (i + 1 < dataset.views.size() ? ",\n" : "\n");
    return text + "  ]\n}\n";
}

Dataset dataset_from_json(const std::string& text, const fs::path& file, DatasetSizes& sizes) {
    Json json;
    try {
        json = Json::parse(text);
    } catch (const Json::parse_error& error) {
        const auto line =
            1 + std::count(text.begin(),
                           text.begin() + std::min<ptrdiff_t>(ptrdiff_t(error.byte), ptrdiff_t(text.size())), '\n');
        throw_damaged(file, fmt::format("line {} is not valid JSON", line));
    } catch (const Json::exception&) {  // a number beyond double
        throw_damaged(file, "a number is too large");
    }
    const Fields fields(json, file, "");
    if (const std::string name = fields.text("format"); name != format_name)
        fields.fail("format", fmt::format("is \"{}\", not \"{}\"", name, format_name));
    const uint64_t version = fields.count("version");
    if (version < 1 || version > uint64_t(format_version))
        fields.fail("version", fmt::format("is {}, this program reads 1 to {}", version, format_version));

    Dataset dataset;
    dataset.folder = file.parent_path();
    dataset.name = fields.text("name");
    dataset.description = fields.text("description");
    dataset.source = fields.text("source");
    dataset.encoding = encoding_from(fields);
    sizes = {fields.count("vertices"), fields.count("triangles"), fields.count("images_bytes")};
    if (fields.has("grid")) {
        const Fields grid = fields.object("grid");
        dataset.grid = {grid.side("width", 1), grid.side("height", 1), grid.vector("origin"),
                        grid.vector("right"),  grid.vector("down"),    {}};
        sizes.grid_normals = grid.boolean("normals");
    }
    if (fields.has("normals")) dataset.normal_map.side = fields.object("normals").side("side", 2);
    const bool checksums = version >= first_with_checksums;
    if (checksums)
        for (const Fields files = fields.object("checksums"); const std::string& name : files.keys())
            dataset.checksums[name] = files.checksum(name.c_str());
    const Json& views = fields.array("views");
    if (views.empty()) fields.fail("views", "is empty");
    for (size_t i = 0; i < views.size(); ++i)
        dataset.views.push_back(
            view_from_json(Fields(views[i], file, fmt::format("views[{}]", i)), file, dataset.encoding, checksums));
    const Grid& grid = dataset.grid;
    for (const View& view : dataset.views) {
        const auto [w, h] = std::array{view.camera.width, view.camera.height};
        if (dataset.has_grid() && (w != grid.width || h != grid.height))
            throw_damaged(file, fmt::format("view \"{}\" has {} x {} pixels, but the grid {} x {} texels", view.name, w,
                                            h, grid.width, grid.height));
        if (view.camera_direction && !dataset.has_grid())
            throw_damaged(file, fmt::format("view \"{}\" has a distant camera, which only a grid may have", view.name));
        if (view.light.has_value() != dataset.light_moves())
            throw_damaged(file, fmt::format("view \"{}\" has {} light, unlike view \"{}\"; all must have one, or none",
                                            view.name, view.light ? "a" : "no", dataset.views.front().name));
    }
    return dataset;
}

}  // namespace radiafit
