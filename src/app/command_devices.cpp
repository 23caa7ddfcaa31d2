#include <fmt/format.h>

#include "app/commands.h"
#include "base/parallel.h"
#include "gl/context.h"

namespace radiafit {

void add_devices(CommandLine& program) {
    CommandLine& command = program.add_command("devices", "contexts, renderers and limits: what can run here");
    command.on_run([] {
        fmt::print("cpu: {} threads\n", thread_count());
        for (const DeviceInfo& d : list_devices()) {
            const std::string name =
                d.kind == ContextKind::osmesa ? "osmesa" : fmt::format("egl --device {}", d.device);
            try {
                ContextOptions options;
                options.kind = d.kind;
                options.device = d.device;
                const auto context = Context::create(options);
                const ContextLimits& l = context->limits();
                fmt::print(
                    "{}: {} ({}), OpenGL {}\n    textures up to {}, {} draw buffers, {} texture units, storage buffers "
                    "up to {} MB\n",
                    name, context->renderer(), d.software ? "software" : "GPU", context->version(), l.texture_size,
                    l.draw_buffers, l.texture_units, l.ssbo_bytes / 1000000);
            } catch (const std::exception& e) {
                fmt::print("{}: {}\n", name, e.what());
            }
        }
    });
}

}  // namespace radiafit
