// devices: contexts, renderers and limits.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "base/parallel.h"
#include "cli/commands.h"
#include "gl/context.h"

namespace radiafit::tools {
namespace {

using Json = nlohmann::ordered_json;

/// What a device's context says of it, or why it can't be made.
Json describe(const DeviceInfo& device) {
    Json json;
    try {
        const auto context = Context::create({.kind = device.kind, .device = device.device});
        const ContextLimits& l = context->limits();
        json = {{"renderer", context->renderer()},     {"kind", context->software() ? "software" : "GPU"},
                {"opengl", context->version()},        {"texture_size", l.texture_size},
                {"draw_buffers", l.draw_buffers},      {"texture_units", l.texture_units},
                {"storage_buffer_bytes", l.ssbo_bytes}};
    } catch (const std::exception& e) {
        json["error"] = e.what();
    }
    return json;
}

void print(const Json& d) {
    const auto text = [&](const char* key) { return d.at(key).get<std::string>(); };
    if (d.contains("error")) return fmt::print("{}: {}\n", text("name"), text("error"));
    const auto number = [&](const char* key) { return d.at(key).get<int64_t>(); };
    fmt::print(
        "{}: {} ({}), OpenGL {}\n    textures up to {}, {} draw buffers, {} texture units, storage buffers up to {} "
        "MB\n",
        text("name"), text("renderer"), text("kind"), text("opengl"), number("texture_size"), number("draw_buffers"),
        number("texture_units"), number("storage_buffer_bytes") / 1000000);
}

}  // namespace

void add_devices(CommandLine& program) {
    auto json = std::make_shared<bool>(false);
    CommandLine& command = program.add_command("devices", "contexts, renderers and limits: what can run here");
    add_json(command, *json);
    command.on_run([=] {
        Json all = Json::array();
        if (!*json) fmt::print("cpu: {} threads\n", thread_count());
        for (const auto& [device, text, failure] :
             ask_each_device([](const DeviceInfo& d) { return describe(d).dump(); })) {
            const bool osmesa = device.kind == ContextKind::osmesa;
            Json answer = {{"name", osmesa              ? "osmesa"
                                    : device.device < 0 ? "egl"
                                                        : fmt::format("egl --device {}", device.device)}};
            answer.update(failure.empty() ? Json::parse(text) : Json{{"error", failure}});
            if (!*json) print(answer);
            all.push_back(std::move(answer));
        }
        if (*json) fmt::print("{}\n", Json{{"cpu_threads", thread_count()}, {"devices", all}}.dump(2));
    });
}

}  // namespace radiafit::tools
