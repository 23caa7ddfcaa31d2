#include "base/record.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/instructions.h"
#include "base/parallel.h"
#include "temporary_folder.h"

namespace radiafit {
namespace {

TEST(Record, HoldsWhatIsNeededAndNoFolderOfTheProgram) {
    const char* arguments[] = {"/some/where/radiafit", "fit", "star \"quoted\"", "--terms=3"};
    Record record = make_record(4, arguments);
    EXPECT_EQ(record.program, "radiafit");
    EXPECT_EQ(record.arguments.size(), 3u);
    EXPECT_EQ(record.utc_start.size(), std::string("2003-07-27T12:00:00Z").size());
    EXPECT_EQ(record.threads, thread_count());
    EXPECT_FALSE(record.git_revision.empty());
    record.config = {{"terms", "3"}, {"engine", "\"cpu\""}};
    record.more = {{"peaks", "{\"triad_gb_s\": 15.5}"}};
    const std::string without_gl = record_json(record);
    EXPECT_EQ(without_gl.find("\"gl\""), std::string::npos);
    EXPECT_EQ(without_gl.find("/some/where"), std::string::npos);
    EXPECT_NE(without_gl.find(R"("star \"quoted\"")"), std::string::npos);
    EXPECT_LT(without_gl.find("\"terms\": 3"), without_gl.find("\"engine\": \"cpu\""));
    EXPECT_NE(without_gl.find("\"triad_gb_s\": 15.5"), std::string::npos);
    record.gl_renderer = "llvmpipe";
    EXPECT_NE(record_json(record).find("\"renderer\": \"llvmpipe\""), std::string::npos);
    EXPECT_EQ(json_string("a\"b\n"), R"("a\"b\n")");
}

TEST(Record, TellsWhenItBeganAndEndedAndWhatItRead) {
    const Record record = make_record(0, nullptr);
    const Record copy = record;  // as a result folder takes one
    record.datasets->push_back(R"({"name": "star"})");
    const auto json = nlohmann::json::parse(record_json(copy));
    EXPECT_EQ(json.at("datasets").at(0).at("name"), "star");
    EXPECT_EQ(json.at("utc_start"), record.utc_start);
    EXPECT_GE(json.at("utc_end"), json.at("utc_start"));
    EXPECT_EQ(compact_utc("2003-07-27T12:00:00Z"), "20030727T120000Z");
}

TEST(Record, TellsWhatItWasBuiltWithAndWhatIsLoaded) {
    const auto json = nlohmann::json::parse(record_json(make_record(0, nullptr)));
    for (const char* name : {"Ceres", "Eigen", "OpenEXR", "OpenImageIO", "fmt"}) {
        const std::string version = json.at("libraries").at("built").at(name);
        EXPECT_NE(version.find('.'), std::string::npos) << name << " " << version;
    }
    const std::vector<std::string> loaded = json.at("libraries").at("loaded");
    EXPECT_TRUE(std::ranges::any_of(loaded, [](const std::string& name) { return name.starts_with("libstdc++.so."); }));
    EXPECT_TRUE(std::ranges::none_of(loaded, [](const std::string& name) { return name.find('/') != name.npos; }));
    EXPECT_NE(json.at("march").at("resolved"), "native");
    EXPECT_NE(json.at("march").at("resolved"), "");
#ifdef __AVX2__
    const std::vector<std::string> instructions = json.at("march").at("instructions");
    EXPECT_NE(std::ranges::find(instructions, "avx2"), instructions.end());
#endif
}

TEST(Machine, ReadsWhatTheKernelTells) {
    const TemporaryFolder root;
    const auto write = [&](const char* file, const std::string& text) {
        std::filesystem::create_directories((root.path() / file).parent_path());
        std::ofstream(root.path() / file) << text;
    };
    write("proc/sys/kernel/ostype", "Linux\n");
    write("proc/sys/kernel/osrelease", "6.1.0-35-amd64\n");
    write("proc/sys/kernel/version", "#1 SMP PREEMPT_DYNAMIC Debian 6.1.137-1 (2025-05-07)\n");
    write("etc/os-release", "PRETTY_NAME=\"Debian GNU/Linux 12 (bookworm)\"\nID=debian\n");
    write("etc/debian_version", "12.11\n");
    write("proc/cpuinfo",
          "processor\t: 0\nvendor_id\t: AuthenticAMD\ncpu family\t: 25\nmodel\t\t: 1\nmodel name\t: AMD EPYC 7763\n"
          "stepping\t: 1\nmicrocode\t: 0xa0011d5\ncpu MHz\t\t: 2445.406\nflags\t\t: fpu sse avx2\n\n"
          "processor\t: 1\ncpu MHz\t\t: 1500.000\n");
    write("sys/devices/system/cpu/cpu0/cpufreq/cpuinfo_max_freq", "3529052\n");
    write("sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "performance\n");
    write("proc/meminfo", "MemTotal:       24684096 kB\nMemFree:        20714840 kB\n");
    write("sys/class/dmi/id/sys_vendor", "Amazon EC2\n");
    write("sys/class/dmi/id/product_name", "c7a.xlarge\n");
    write("proc/loadavg", "3.02 2.59 3.17 5/101 667\n");
    write("run/.containerenv", "");
    const Machine m = read_machine(root.path());
    EXPECT_TRUE(m.kernel.starts_with("Linux 6.1.0-35-amd64 ")) << m.kernel;
    EXPECT_TRUE(m.kernel.ends_with(" #1 SMP PREEMPT_DYNAMIC Debian 6.1.137-1 (2025-05-07)")) << m.kernel;
    EXPECT_EQ(m.distribution, "Debian GNU/Linux 12 (bookworm) 12.11");
    EXPECT_EQ(m.cpu, "AMD EPYC 7763");
    EXPECT_EQ(m.cpu_id, "AuthenticAMD family 25 model 1 stepping 1 microcode 0xa0011d5");
    EXPECT_EQ(m.mhz, 2445.406);
    EXPECT_EQ(m.mhz_max, 3529.052);
    EXPECT_EQ(m.governor, "performance");
    EXPECT_EQ(m.memory_bytes, 24684096ull * 1024);
    EXPECT_EQ(m.hypervisor, "");
    EXPECT_EQ(m.dmi, "Amazon EC2 c7a.xlarge");
    EXPECT_EQ(m.container, "podman");
    EXPECT_EQ(m.load, (std::vector{3.02, 2.59, 3.17}));
    write("proc/cpuinfo", "model name : virtual\nflags : fpu hypervisor sse\n");
    EXPECT_NE(read_machine(root.path()).hypervisor, "");
}

TEST(Machine, ProcessorsWithoutANumberAreToldApartByFamilyAndModel) {
    const std::string id = "AuthenticAMD family 25 model 1 stepping 1 microcode 0xa0011d5";
    EXPECT_EQ(processor_name("AMD EPYC", id), "AMD EPYC (family 25 model 1)");
    EXPECT_EQ(processor_name("AMD EPYC", "family 26 model 2"), "AMD EPYC (family 26 model 2)");
    EXPECT_EQ(processor_name("AMD EPYC", "family 26 model 2 microcode 0x1"), "AMD EPYC (family 26 model 2)");
    EXPECT_EQ(processor_name("AMD EPYC 7763", id), "AMD EPYC 7763");
    EXPECT_EQ(processor_name("AMD EPYC", ""), "AMD EPYC");
}

TEST(Machine, WhatCannotBeReadIsEmpty) {
    const TemporaryFolder root;
    std::filesystem::create_directories(root.path() / "proc/loadavg");  // a folder where a file belongs
    std::filesystem::create_directories(root.path() / "proc/sys/kernel");
    std::ofstream(root.path() / "proc/meminfo") << "MemTotal: lots\n";
    std::ofstream(root.path() / "proc/cpuinfo") << "no colon\ncpu MHz : fast\n" << std::string(100000, ':');
    std::ofstream(root.path() / "proc/sys/kernel/version") << "\xff\xfe";  // no UTF-8
    Machine m = read_machine(root.path());
    EXPECT_EQ(m.distribution + m.cpu + m.cpu_id + m.governor + m.hypervisor + m.dmi, "");
    EXPECT_FALSE(m.mhz || m.mhz_max || m.memory_bytes);
    EXPECT_TRUE(m.load.empty());
    Record record = make_record(0, nullptr);
    record.machine = m;
    const auto json = nlohmann::json::parse(record_json(record)).at("machine");
    for (const char* name : {"mhz", "mhz_max", "memory_bytes", "load"}) EXPECT_TRUE(json.at(name).is_null()) << name;
    EXPECT_EQ(json.at("governor"), "");
}

TEST(Instructions, OnlyTheBaseWhileOneAsksForIt) {
    const bool before = run_avx512();
    const std::string widest = widest_instructions();
    const auto runs_wide = [] {
        bool wide = false;
        with_widest_vectors([&] { wide = run_avx512(); });
        return wide;
    };
    EXPECT_EQ(runs_wide(), before);
    EXPECT_EQ(widest == "AVX-512", before);
    {
        const BaseInstructions base;
        EXPECT_STREQ(widest_instructions(), compiled_instructions());
        EXPECT_EQ(runs_wide(), std::string(compiled_instructions()) == "AVX-512");
        { const BaseInstructions again; }
        EXPECT_STREQ(widest_instructions(), compiled_instructions()) << "the first one still lives";
    }
    EXPECT_EQ(run_avx512(), before);
    EXPECT_EQ(widest_instructions(), widest);
}

}  // namespace
}  // namespace radiafit
