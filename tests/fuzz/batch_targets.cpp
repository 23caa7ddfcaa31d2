#include "batch/problem_files.h"
#include "npy_bytes.h"
#include "target.h"

namespace radiafit::fuzz {
namespace {

constexpr const char* decay =
    "struct Terms { real t; };\nstruct Parameters { real height, rate; };\nstruct Values { real v; };\n"
    "Values value(Parameters p, Terms t) { return Values(p.height * exp(-p.rate * t.t)); }\n";

batch::ModelText model() { return batch::read_model("decay.glsl", decay); }

/// Read as the program does, and arranged, in both precisions.
void read_all(const fs::path& input) {
    const batch::ByName start = {{"height", 1}, {"rate", 1}};
    const batch::ProblemFiles<float> files(input, model(), start);
    files.read(0, files.count());
    const batch::ProblemFiles<double> parts(input, model(), start);
    for (size_t i = 0; i < parts.count(); ++i) parts.read(i, 1);
}

Target text() {
    return {"solve_model", "decay.glsl", [](const fs::path&) { return std::vector<std::string>{decay}; },
            [](const fs::path& folder) { batch::read_model_file(folder / "decay.glsl"); }};
}

Target table() {
    return {"solve_table", "decay.csv",
            [](const fs::path&) {
                return std::vector<std::string>{"t,v,weight,problem\n0,1,1,a\n1,0.5,nan,a\n0,2,1,b\n",
                                                "\"t\",v\n1,\n2,NaN\n"};
            },
            [](const fs::path& folder) { read_all(folder / "decay.csv"); }};
}

/// One of a folder's files; the others are whole.
Target array(const std::string& file) {
    const auto seeds = [=](const fs::path& folder) {
        const auto put = [&](const char* name, const char* type, const char* shape, const std::string& data) {
            put_bytes(folder / fmt::format("{}.npy", name), testing::npy(type, false, shape, data));
        };
        using Floats = std::vector<float>;
        put("terms", "<f4", "(3, 1)", testing::bytes_of(Floats{0, 1, 0}));
        put("targets", "<f4", "(3, 1)", testing::bytes_of(Floats{1, 0.5f, 2}));
        put("weights", "<f4", "(3,)", testing::bytes_of(Floats{1, 1, 2}));
        put("offsets", "<i8", "(3,)", testing::bytes_of(std::vector<int64_t>{0, 2, 3}));
        put("start", "<f4", "(2,)", testing::bytes_of(Floats{1, 1}));
        return std::vector<std::string>{bytes_of(folder / (file + ".npy"))};
    };
    return {"solve_" + file, file + ".npy", seeds, read_all};
}

}  // namespace

std::vector<Target> batch_targets() {
    return {text(), table(), array("terms"), array("targets"), array("weights"), array("offsets"), array("start")};
}

}  // namespace radiafit::fuzz
