#include "fitting/parts/part_result.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/json.h"

namespace radiafit::fits {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* part_format = "radiafit-part";
constexpr int part_version = 2;

// The file: bytes of the description, the description as JSON, filled up with blanks to a multiple of eight, the arrays
// one after another, and the checksum of all that.

[[noreturn]] void throw_damaged_part(const fs::path& file) {
    throw UserError(file.string() + ": damaged; delete it, and the fit's command makes it anew");
}

/// Calls each(array) for all of them in the file's order.
template <class Result, class Each>
void for_arrays(Result& result, const Each& each) {
    each("units", result.units);
    each("parameters", result.parameters);
    each("status", result.status);
    each("iterations", result.iterations);
    each("samples", result.samples);
    each("error", result.error);
    each("own", result.own);
}

template <class T>
size_t bytes_of(const std::vector<T>& values) {
    return values.size() * sizeof(T);
}

class Reader {
public:
    explicit Reader(const fs::path& file) : name_(file), file_(file), left_(file_.size()) {}
    void read(void* to, uint64_t bytes) {
        if (bytes > left_) throw_damaged_part(name_);
        file_.read(to, at_, bytes);
        at_ += bytes;
        left_ -= bytes;
    }
    void check_left(uint64_t count, size_t size) const {
        if (count > left_ / size) throw_damaged_part(name_);
    }
    uint64_t left() const { return left_; }

private:
    fs::path name_;
    InputFile file_;
    uint64_t at_ = 0, left_;
};

/// What a file begins with, and the hash up to its end.
struct Head {
    Json description;
    uint64_t hash;
};

Head read_head(Reader& in, const fs::path& file) {
    uint64_t size = 0;
    in.read(&size, sizeof size);
    in.check_left(size, 1);
    std::string text(size, ' ');
    in.read(text.data(), size);
    Json description = parse_json<Json>(text);
    if (!description.is_object()) throw_damaged_part(file);
    return {std::move(description), hash_bytes(text.data(), size, hash_bytes(&size, sizeof size))};
}

}  // namespace

void write_part_result(const fs::path& file, const std::string& key, const PartResult& result) {
    Json description = {{"format", part_format}, {"version", part_version}, {"key", key}};
    for_arrays(result, [&](const char* name, const auto& values) { description[name] = values.size(); });
    description["terms"] = result.terms;
    description["view_side"] = result.view_side;
    description["own_json"] = result.own_json;
    description["run"] = Json::parse(result.run_json);
    std::string text = json_text(description);
    text.resize((text.size() + 7) / 8 * 8, ' ');

    AtomicFile out(file);
    uint64_t hash = hash_start;
    const auto write = [&](const void* from, size_t bytes) {
        hash = hash_bytes(from, bytes, hash);
        out.write({static_cast<const char*>(from), bytes});
    };
    const uint64_t size = text.size();
    write(&size, sizeof size);
    write(text.data(), text.size());
    for_arrays(result, [&](const char*, const auto& values) { write(values.data(), bytes_of(values)); });
    out.write({reinterpret_cast<const char*>(&hash), sizeof hash});
    out.commit();
}

std::string part_key(const fs::path& file) {
    Reader in(file);
    const Json key = read_head(in, file).description.value("key", Json());
    if (!key.is_string()) throw_damaged_part(file);
    return key;
}

PartResult read_part_result(const fs::path& file, const std::string& key) {
    Reader in(file);
    auto [description, hash] = read_head(in, file);
    PartResult result;
    try {
        if (description.at("format") != part_format || description.at("version") != part_version)
            throw_damaged_part(file);
        for_arrays(result, [&](const char* name, auto& values) {
            const auto count = description.at(name).get<uint64_t>();
            in.check_left(count, sizeof values[0]);
            values.resize(count);
            in.read(values.data(), bytes_of(values));
            hash = hash_bytes(values.data(), bytes_of(values), hash);
        });
        result.terms = description.at("terms");
        result.view_side = description.at("view_side");
        result.own_json = description.at("own_json");
        result.run_json = json_text(description.at("run"));
    } catch (const Json::exception&) {
        throw_damaged_part(file);
    }
    uint64_t checksum = 0;
    in.read(&checksum, sizeof checksum);
    const size_t problems = result.status.size();
    const bool agree = result.iterations.size() == problems && result.samples.size() == problems &&
                       result.error.size() == problems && std::ranges::is_sorted(result.units) &&
                       std::ranges::all_of(result.status, [](Status s) { return s < Status::count; });
    if (in.left() > 0 || checksum != hash || !agree) throw_damaged_part(file);
    if (description.at("key") != key)
        throw UserError(file.string() + ": of another dataset or of other options; choose another folder");
    return result;
}

std::string run_to_json(const FitRun& run, const ResamplingCounts& resampling, uint64_t samples) {
    Json trace = Json::array();
    for (const TraceRow& r : run.trace.rows) trace.push_back({r.time_s, r.error, r.accepted, r.active});
    const FitTimes& t = run.times;
    return Json{{"trace", trace},
                {"times", {t.distribution, t.streaming, t.optimization, t.total, t.outside}},
                {"gl", {run.gl_vendor, run.gl_renderer, run.gl_version}},
                {"engine_bytes", run.engine_bytes},
                {"records", {run.records.bytes_written, run.records.bytes_read, run.records.waiting_parts}},
                {"record_bytes_read", run.record_bytes_read},
                {"sample_iterations", run.sample_iterations},
                {"working_set_bytes", run.working_set_bytes},
                {"samples", samples},
                {"resampling", {resampling.entries, resampling.outside_hull, resampling.unseen_texels}}}
        .dump();
}

void RunSum::add(const std::string& run_json) {
    const Json json = parse_json<Json>(run_json);
    std::vector<TraceRow> rows;
    for (const Json& r : json.at("trace")) rows.push_back({int(rows.size()), r.at(0), r.at(1), r.at(2), r.at(3)});
    trace_.add(rows);
    const Json &times = json.at("times"), &gl = json.at("gl"), &records = json.at("records"),
               &resampling = json.at("resampling");
    FitTimes& t = run_.times;
    size_t i = 0;
    for (double* time : {&t.distribution, &t.streaming, &t.optimization, &t.total, &t.outside})
        *time += times.at(i++).get<double>();
    run_.gl_vendor = gl.at(0);
    run_.gl_renderer = gl.at(1);
    run_.gl_version = gl.at(2);
    i = 0;
    for (uint64_t* bytes : {&run_.records.bytes_written, &run_.records.bytes_read, &run_.records.waiting_parts})
        *bytes += records.at(i++).get<uint64_t>();
    run_.record_bytes_read += json.at("record_bytes_read").get<uint64_t>();
    run_.sample_iterations += json.at("sample_iterations").get<uint64_t>();
    run_.engine_bytes = std::max(run_.engine_bytes, json.at("engine_bytes").get<uint64_t>());
    run_.working_set_bytes = std::max(run_.working_set_bytes, json.at("working_set_bytes").get<uint64_t>());
    samples_ += json.at("samples").get<uint64_t>();
    resampling_ += {resampling.at(0), resampling.at(1), resampling.at(2)};
}

FitRun RunSum::run() const {
    FitRun run = run_;
    run.trace.rows = trace_.rows();
    return run;
}

}  // namespace radiafit::fits
