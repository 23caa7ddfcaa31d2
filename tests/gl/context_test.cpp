// Contexts without a window system, the objects made in them, and how they fail.
#include "gl/context.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>

#include "base/error.h"
#include "context_kinds.h"
#include "failing_gl.h"
#include "fragment/peaks.h"
#include "gl/driver_advice.h"
#include "gl/pixel_uploads.h"
#include "gl/program.h"
#include "gl/texture.h"
#include "temporary_folder.h"

namespace radiafit {
namespace {

std::unique_ptr<Context> make(ContextKind kind, bool debug = false) {
    ContextOptions options;
    options.kind = kind;
    options.debug = debug;
    return Context::create(options);
}

std::string user_error(const ContextOptions& options) {
    try {
        Context::create(options);
    } catch (const UserError& e) {
        return e.what();
    }
    return "";
}

class EveryContext : public ::testing::TestWithParam<ContextKind> {};

TEST_P(EveryContext, OffersCore45AndSaysWhatItIs) {
    const auto context = make(GetParam());
    EXPECT_FALSE(context->renderer().empty());
    EXPECT_FALSE(context->vendor().empty());
    EXPECT_GE(context->limits().texture_size, 16384);
    EXPECT_GE(context->limits().draw_buffers, 8);
    int profile = 0;
    gl().GetIntegerv(GL_CONTEXT_PROFILE_MASK, &profile);
    EXPECT_TRUE(profile & GL_CONTEXT_CORE_PROFILE_BIT);
}

TEST_P(EveryContext, VersionBelowTheMinimumIsAUsersError) {
    ContextOptions options;
    options.kind = GetParam();
    options.minimum_version = 99;
    const std::string message = user_error(options);
    EXPECT_NE(message.find("9.9 core is needed"), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
}

TEST_P(EveryContext, DeviceOutOfRangeIsAUsersError) {
    ContextOptions options;
    options.kind = GetParam();
    options.device = 63;
    const std::string message = user_error(options);
    EXPECT_NE(message.find("out of range"), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
}

TEST_P(EveryContext, DebuggingQuotesTheFailingCall) {
    const auto context = make(GetParam(), true);
    try {
        gl().Enable(GL_TEXTURE_SWIZZLE_RGBA);  // no capability of that name
        FAIL() << "an invalid enum went unnoticed";
    } catch (const SystemError& e) {
        EXPECT_NE(std::string(e.what()).find("glEnable failed"), std::string::npos) << e.what();
    }
    gl().Disable(GL_BLEND);  // the next call starts afresh
}

TEST_P(EveryContext, TexturesKeepWhatTheyAreGivenAndCountTheirBytes) {
    const auto context = make(GetParam(), true);
    ASSERT_EQ(context->allocated_bytes(), 0);
    {
        Texture plain(GL_RGBA32F, 3, 2), array(GL_R32UI, 5, 4, 3);
        EXPECT_EQ(context->allocated_bytes(), 3 * 2 * 16 + 5 * 4 * 3 * 4);
        std::vector<float> in(24), out(24, -1.0f);
        plain.download(GL_RGBA, GL_FLOAT, out.data(), 24 * sizeof(float));
        for (float x : out) EXPECT_EQ(x, 0.0f);
        for (size_t i = 0; i < in.size(); ++i) in[i] = 0.1f * float(i) - 1;
        plain.upload(GL_RGBA, GL_FLOAT, in.data());
        plain.download(GL_RGBA, GL_FLOAT, out.data(), 24 * sizeof(float));
        EXPECT_EQ(in, out);
        std::vector<uint32_t> items(20, 0xffffffffu), none(20), back(20);
        array.upload(GL_RED_INTEGER, GL_UNSIGNED_INT, items.data(), 1);
        array.download(GL_RED_INTEGER, GL_UNSIGNED_INT, back.data(), 80, 1);
        EXPECT_EQ(back, items);
        array.download(GL_RED_INTEGER, GL_UNSIGNED_INT, back.data(), 80, 2);
        EXPECT_EQ(back, none);
    }
    EXPECT_EQ(context->allocated_bytes(), 0);
    EXPECT_EQ(context->peak_bytes(), 3 * 2 * 16 + 5 * 4 * 3 * 4);
}

std::string name_of(const ::testing::TestParamInfo<ContextKind>& info) { return to_string(info.param); }
INSTANTIATE_TEST_SUITE_P(Kinds, EveryContext, ::testing::ValuesIn(context_kinds()), name_of);

TEST(Context, BothKindsLiveSideBySide) {
    if (!has_osmesa()) GTEST_SKIP() << "no OSMesa here";
    const auto egl = make(ContextKind::egl);
    Texture of_egl(GL_R32F, 1, 1);
    const float one = 1, two = 2;
    of_egl.upload(GL_RED, GL_FLOAT, &one);
    {
        const auto osmesa = make(ContextKind::osmesa);
        Texture of_osmesa(GL_R32F, 1, 1);
        of_osmesa.upload(GL_RED, GL_FLOAT, &two);
        for (int turn = 0; turn < 3; ++turn) {
            float x = 0;
            egl->make_current();
            of_egl.download(GL_RED, GL_FLOAT, &x, sizeof x);
            EXPECT_EQ(x, 1.0f);
            osmesa->make_current();
            of_osmesa.download(GL_RED, GL_FLOAT, &x, sizeof x);
            EXPECT_EQ(x, 2.0f);
        }
    }
    EXPECT_THROW(gl(), SystemError);
    egl->make_current();
    float x = 0;
    of_egl.download(GL_RED, GL_FLOAT, &x, sizeof x);
    EXPECT_EQ(x, 1.0f);
}

TEST(Context, ListsDevicesThatCanBeOpened) {
    const auto devices = list_devices();
    ASSERT_FALSE(devices.empty());
    for (const DeviceInfo& device : devices) {
        EXPECT_FALSE(device.description.empty());
        if (!device.software) continue;  // a GPU may be listed and still lack a driver that this process can use
        ContextOptions options;
        options.kind = device.kind;
        options.device = device.device;
        EXPECT_NO_THROW(Context::create(options)) << device.description;
    }
}

TEST(Context, ADriverThatCrashesIsToldByTheOthersToo) {
    // Asked first: CUDA's number of a device is not to be had in a child of a process that has used its driver.
    const auto answers = ask_each_device([](const DeviceInfo& device) -> std::string {
        if (device.kind == ContextKind::egl) return "here";
        std::signal(SIGSEGV, SIG_DFL);  // a sanitizer's handler would end it otherwise
        std::raise(SIGSEGV);
        return "never";
    });
    const auto devices = list_devices();
    ASSERT_EQ(answers.size(), devices.size());
    for (size_t i = 0; i < answers.size(); ++i) {
        EXPECT_EQ(answers[i].device.kind, devices[i].kind);
        EXPECT_EQ(answers[i].device.device, devices[i].device);
        EXPECT_EQ(answers[i].device.software, devices[i].software);
        EXPECT_EQ(answers[i].device.description, devices[i].description);
        const bool egl = devices[i].kind == ContextKind::egl;
        EXPECT_EQ(answers[i].text, egl ? "here" : "");
        EXPECT_EQ(answers[i].failure.starts_with("crashes (Segmentation fault)"), !egl) << answers[i].failure;
    }
}

using Files = std::map<std::string, std::string>;

/// Where a file system's root holds these files, each with its text.
ChipSigns signs_of(const Files& files) {
    const TemporaryFolder root;
    for (const auto& [name, text] : files) {
        std::filesystem::create_directories((root.path() / name).parent_path());
        std::ofstream(root.path() / name) << text;
    }
    return look_for_chip(root.path());
}

void expect_words(const ChipSigns& signs, bool nvidia, const std::vector<std::string>& words) {
    EXPECT_EQ(signs.nvidia, nvidia);
    EXPECT_EQ(signs.advice.find('\n'), std::string::npos) << signs.advice;
    for (const std::string& word : words)
        EXPECT_NE(signs.advice.find(word), std::string::npos) << word << " in: " << signs.advice;
}

TEST(DriverAdvice, NamesTheCureOfEachWant) {
    EXPECT_EQ(signs_of({}).advice, "");
    const std::string proc = "proc/driver/nvidia/version", device = "dev/nvidiactl",
                      capabilities = "NVIDIA_DRIVER_CAPABILITIES=graphics,compute,utility";
    const std::string closed =
        "NVRM version: NVIDIA UNIX x86_64 Kernel Module  535.183.01  Sun May 12 19:39:15 UTC 2024\n";
    const std::string open = "NVRM version: NVIDIA UNIX Open Kernel Module for x86_64  570.86.15  Release Build\n";
    expect_words(signs_of({{proc, closed}, {device, ""}}), true, {capabilities, "libegl1", "libnvidia-gl-535"});
    expect_words(signs_of({{proc, open}, {device, ""}}), true, {capabilities, "libegl1", "libnvidia-gl-570"});
    expect_words(signs_of({{proc, closed}}), true, {"535.183.01", "with its GPUs", capabilities});
    expect_words(signs_of(Files{{device, ""}}), true, {capabilities, "libnvidia-gl-VERSION"});
    expect_words(signs_of({{"dev/dri/card0", ""}, {"dev/dri/renderD128", ""}}), false, {"renderD128", "libegl-mesa0"});
}

TEST(Context, NamesAreChecked) {
    EXPECT_EQ(context_kind_from("osmesa"), ContextKind::osmesa);
    EXPECT_THROW(context_kind_from("glx"), UserError);
}

TEST(Program, ErrorsNameTheFile) {
    const auto context = make(second_kind());
    // Lacks the definitions that the text asks for: the message must name the included file, not a number.
    try {
        Program::draw("common/whole.vert", "model/lfm.glsl");
        FAIL() << "a text that is no shader compiled";
    } catch (const SystemError& e) {
        EXPECT_NE(std::string(e.what()).find("model/lfm.glsl"), std::string::npos) << e.what();
    }
    EXPECT_THROW(expand_shader("no/such.frag"), UserError);
}

TEST(Program, SaysWhatItIsToldAmissWhileDebugging) {
    const auto said = [](const auto& body) -> std::string {
        try {
            body();
        } catch (const std::logic_error& e) {
            return e.what();
        }
        return "";
    };
    for (const bool debug : {true, false}) {
        const auto context = make(second_kind(), debug);
        const Texture source(GL_RGBA32F, 2, 2);
        const auto fetch = [] { return Program::draw("common/whole.vert", "peaks/fetch.frag"); };
        const auto text = [&](const std::string& what) { return debug ? "peaks/fetch.frag " + what : ""; };
        const Program program = fetch(), untold = fetch(), unbound = fetch();
        EXPECT_EQ(said([&] { program.set("turn", 1); }), text("uses no turn"));
        EXPECT_EQ(said([&] { program.bind("sources", source); }), text("uses no sources"));
        EXPECT_EQ(said([&] { program.set("factor", 1.0f); }), text("uses no factor")) << "which fused.frag has";
        program.set_if_used("factor", 1.0f);
        untold.bind("source", source);
        EXPECT_EQ(said([&] { untold.use(); }), text("draws without its turns"));
        unbound.set("turns", 1);
        EXPECT_EQ(said([&] { unbound.use(); }), text("draws without its source"));
        program.set("turns", 1);
        program.bind("source", source);
        EXPECT_EQ(said([&] { program.use(); }), "");
    }
}

// What a compiler leaves out at an array's end must not reach the texture that comes after it.
TEST(Program, PassesOverTheEndOfAnArrayThatIsNotInUse) {
    const TemporaryFolder folder;
    for (const char* name : {"whole.vert", "two_of_three.frag"}) {
        std::ofstream file(folder.path() / name);
        if (std::string(name) == "whole.vert")
            file << expand_shader("common/whole.vert").text;
        else
            file
                << "#version 450 core\nuniform sampler2D sources[3];\nuniform sampler2D z_last;\n"
                   "layout(location = 0) out vec4 result;\nvoid main() { ivec2 at = ivec2(0); result = vec4("
                   "texelFetch(sources[0], at, 0).x, texelFetch(sources[1], at, 0).x, texelFetch(z_last, at, 0).x, 0); "
                   "}\n";
    }
    for (const ContextKind kind : context_kinds()) {
        const auto context = make(kind);
        ::setenv("RADIAFIT_SHADERS", folder.path().c_str(), 1);
        const Program program = Program::draw("whole.vert", "two_of_three.frag");
        ::unsetenv("RADIAFIT_SHADERS");
        std::vector<Texture> textures;
        for (const float value : {1.0f, 2.0f, 3.0f, 4.0f}) {
            textures.emplace_back(GL_R32F, 1, 1);
            textures.back().upload(GL_RED, GL_FLOAT, &value);
        }
        program.bind("z_last", textures[3]);
        for (size_t i = 0; i < 3; ++i) program.bind("sources", textures[i], i);
        const Texture result(GL_RGBA32F, 1, 1);
        const Framebuffer target({{&result}});
        const VertexArray empty;
        target.bind();
        program.use();
        empty.bind();
        gl().DrawArrays(GL_TRIANGLES, 0, 3);
        std::array<float, 4> drawn{};
        result.download(GL_RGBA, GL_FLOAT, drawn.data(), sizeof drawn);
        EXPECT_EQ(drawn, (std::array<float, 4>{1, 2, 4, 0})) << to_string(kind);
    }
}

TEST(Renderers, InSoftwareAreKnownByTheirNames) {
    for (const char* name :
         {"llvmpipe (LLVM 15.0.6, 256 bits)", "virgl (LLVMPIPE (LLVM 15.0.6, 256 bits))",
          "zink Vulkan 1.3(llvmpipe (LLVM 15.0.6, 256 bits) (MESA_LLVMPIPE))", "Microsoft Basic Render Driver",
          "D3D12 (Microsoft Basic Render Driver)", "Google SwiftShader", "softpipe", "SWR (LLVM 11.0.0, 256 bits)"})
        EXPECT_TRUE(is_software_renderer(name)) << name;
    for (const char* name : {"NVIDIA H100 PCIe/PCIe/SSE2", "AMD Radeon RX 7900 XTX (radeonsi, navi31, LLVM 15.0.6)",
                             "Mesa Intel(R) Arc(tm) A770 Graphics (DG2)", "virgl (NVIDIA GeForce RTX 3060/PCIe/SSE2)"})
        EXPECT_FALSE(is_software_renderer(name)) << name;
}

TEST_P(EveryContext, AllocationsThatFailAreToldWithBytesAndACure) {
    for (const bool debug : {false, true}) {
        const auto context = make(GetParam(), debug);
        const std::vector<float> values(100, 1.0f);
        EXPECT_EQ(fail_each_allocation([&] {
                      const Texture plane(GL_RGBA32F, 64, 32), array(GL_R8UI, 16, 16, 3);
                      const Buffer buffer(values);
                      const Texture fetched = Texture::of_buffer(GL_RGBA32F, buffer);
                  }),
                  3);
        EXPECT_EQ(fail_each_allocation([] { PixelUploads(1000); }), context->software() ? 0 : 2);
        EXPECT_EQ(fail_each_allocation([] { Buffer::to_fill(1000); }), 1);
    }
}

TEST_P(EveryContext, PixelsOnTheirWayArriveAsTheyWereWritten) {
    // Written again as soon as begin() allows it, while the device may still fetch: more turns than there are buffers.
    const auto context = make(GetParam());
    constexpr int side = 256, turns = 7;
    constexpr size_t bytes = size_t(side) * side * 4;
    PixelUploads uploads(bytes);
    std::vector<Texture> textures;
    std::vector<Buffer> buffers;
    for (int turn = 0; turn < turns; ++turn) {
        textures.emplace_back(GL_RGBA8UI, side, side);
        buffers.push_back(Buffer::to_fill(bytes));
        std::fill_n(uploads.begin(), bytes, uint8_t(2 * turn + 1));
        uploads.end(textures.back(), side, side / 2, GL_RGBA_INTEGER, GL_UNSIGNED_BYTE);
        std::fill_n(uploads.begin(buffers.back()), bytes, uint8_t(2 * turn + 2));
        uploads.end(buffers.back());
    }
    std::vector<uint8_t> texels(bytes), words(bytes);
    for (int turn = 0; turn < turns; ++turn) {
        textures[size_t(turn)].download(GL_RGBA_INTEGER, GL_UNSIGNED_BYTE, texels.data(), bytes);
        buffers[size_t(turn)].read(0, bytes, words.data());
        for (size_t i = 0; i < bytes; ++i) {
            ASSERT_EQ(texels[i], i < bytes / 2 ? 2 * turn + 1 : 0) << turn << ", " << i;
            ASSERT_EQ(words[i], 2 * turn + 2) << turn << ", " << i;
        }
    }
}

TEST_P(EveryContext, ADeviceThatWasResetGivesNoResults) {
    const auto context = make(GetParam());
    const Buffer buffer(std::vector<float>(4, 1.0f));
    const Texture texture(GL_RGBA32F, 2, 2);
    std::vector<float> read(16);
    const auto told = [&](const auto& body) -> std::string {
        try {
            body();
        } catch (const SystemError& error) {
            return error.what();
        }
        return "";
    };
    auto& reset = FailingAllocation::table().GetGraphicsResetStatus.pointer;
    const auto saved = std::exchange(reset, []() -> GLenum { return GL_GUILTY_CONTEXT_RESET; });
    const std::string buffers = told([&] { buffer.read(0, 16, read.data()); });
    const std::string textures = told([&] { texture.download(GL_RGBA, GL_FLOAT, read.data(), 64); });
    reset = saved;
    EXPECT_NE(buffers.find("the device was reset, for a command of this program took too long"), std::string::npos)
        << buffers;
    EXPECT_EQ(textures, buffers);
    EXPECT_EQ(told([&] { buffer.read(0, 16, read.data()); }), "");
}

TEST_P(EveryContext, RunningOutOfMemoryWhileDrawingIsTold) {
    const auto context = make(GetParam());
    const Buffer buffer(std::vector<float>(4, 1.0f));
    float read[4];
    auto& get_error = FailingAllocation::table().GetError.pointer;
    static GLenum pending;
    pending = GL_OUT_OF_MEMORY;
    const auto saved = std::exchange(get_error, []() -> GLenum { return std::exchange(pending, GLenum(GL_NO_ERROR)); });
    EXPECT_THROW(buffer.read(0, 16, read), UserError);
    EXPECT_NO_THROW(buffer.read(0, 16, read));
    get_error = saved;
}

TEST_P(EveryContext, ArraysBeyondTheLayersOfTheDeviceAreAUsersError) {
    const auto context = make(GetParam());
    EXPECT_THROW(Texture(GL_R8UI, 1, 1, context->limits().texture_layers + 1), UserError);
    EXPECT_LE(context->limits().texture_size, 1 << 14) << "beyond what 14 bits hold";
}

// That the kernels did their work measure_gl_peaks() checks itself, and throws.
TEST(Peaks, AreRatesOfWorkDone) {
    for (const ContextKind kind : context_kinds()) {
        const auto context = make(kind, true);
        const GlPeaks peaks = measure_gl_peaks();
        for (double rate : {peaks.operations_s, peaks.reads_s, peaks.bytes_s}) {
            EXPECT_TRUE(std::isfinite(rate));
            EXPECT_GT(rate, 1e6);
        }
        EXPECT_GT(peaks.operations_s, peaks.reads_s);
        const ComputePeaks compute = measure_compute_peaks();
        for (double rate : {compute.operations_s, compute.bytes_s}) {
            EXPECT_TRUE(std::isfinite(rate));
            EXPECT_GT(rate, 1e6);
        }
        EXPECT_EQ(context->allocated_bytes(), 0);
        std::printf("  %s: %.1f G operations/s, %.2f G reads/s, %.1f GB/s\n", to_string(kind).c_str(),
                    1e-9 * peaks.operations_s, 1e-9 * peaks.reads_s, 1e-9 * peaks.bytes_s);
        std::printf("  compute shaders: %.1f G operations/s, %.1f GB/s\n", 1e-9 * compute.operations_s,
                    1e-9 * compute.bytes_s);
    }
}

}  // namespace
}  // namespace radiafit
