#include "fitting/parts/parts.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <malloc.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/journal.h"
#include "base/json.h"
#include "base/log.h"
#include "base/read_file.h"
#include "base/resources.h"
#include "base/wording.h"
#include "fitting/fit_key.h"
#include "fitting/fit_options.h"
#include "fitting/unfinished.h"
#include "geometry/mesh_part.h"
#include "ownmodel/own_model.h"

namespace radiafit::fits {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* shard_format = "radiafit-shard";
constexpr int shard_version = 1;

std::string digest_of(std::span<const uint32_t> units) {
    return fmt::format("{:016x}", hash_bytes(units.data(), units.size_bytes()));
}

std::string name_of(const Shard& shard) {
    if (shard.count == 1) return "fit in parts";
    return fmt::format("shard {} of {}", shard.index, shard.count);
}

[[noreturn]] void throw_damaged_shard(const fs::path& file) {
    throw UserError(file.string() + ": damaged; delete it, and the shard's command makes it anew");
}

/// What a shard.json says, or nothing where there is none.
std::optional<Json> read_note(const fs::path& folder) {
    const fs::path file = folder / shard_json_name;
    if (!path_exists(file)) return {};
    const std::string text = read_file(file, "shard's description");
    const Json json = parse_json<Json>(text);
    if (!json.is_object() || json.value("format", Json()) != shard_format) throw_damaged_shard(file);
    if (json.value("version", Json()) != shard_version)
        throw UserError(file.string() + ": a shard of another version; make it anew");
    return json;
}

FitRequest request_from(const Json& options) {
    FitRequest request;
    for (const FitOption& o : fit_options()) {
        if (!o.decides_result) continue;
        const Json& value = options.at(o.name);
        const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
        if (!text.empty()) o.read(request, text);
    }
    return request;
}

/// A folder that holds nothing, or parts of this very fit.
void check_shard_folder(const fs::path& folder, const std::string& key, const Shard& shard) {
    if (!path_exists(folder)) return;
    if (!folder_exists(folder)) throw UserError(folder.string() + ": no folder; choose another name");
    if (const auto note = read_note(folder);
        note && (note->value("key", "") != key || note->value("shard", Json()) != Json{shard.index, shard.count}))
        throw UserError(fmt::format("{}: holds {} of another fit, or another shard; choose another folder",
                                    folder.string(), name_of(shard)));
    if (const std::string why = why_not_resumable(folder, key); !why.empty())
        throw UserError(fmt::format("{}: {}; choose another folder", folder.string(), why));
    for (const auto& entry : fs::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        if (name != shard_json_name && name != model_text_name && !name.starts_with("part-") &&
            !name.starts_with(".") && !name.ends_with(journal_extension))
            throw UserError(
                fmt::format("{}: holds '{}', which is no part of a fit; choose another folder", folder.string(), name));
    }
}

/// What is planned, with the program and a tenth that plans may be short of.
uint64_t with_program(uint64_t planned) { return program_bytes + planned + planned / 10; }

/// Part by part; those that are there already are left as they are. Returns the files' names.
std::vector<std::string> solve_parts(const Divided& whole, const std::vector<std::vector<uint32_t>>& parts,
                                     const std::string& key, const fs::path& folder) {
    std::vector<std::string> files;
    for (size_t k = 0; k < parts.size(); ++k) {
        Part part = whole.cut(parts[k]);
        const std::string name = "part-" + digest_of(part.units);
        files.push_back(name + ".bin");
        const fs::path file = folder / files.back(), journal = folder / (name + journal_extension);
        if (path_exists(file)) {
            read_part_result(file, key);
            log_info(fmt::format("part {} of {} is there", k + 1, parts.size()));
            continue;
        }
        log_info(fmt::format("part {} of {}: {} of {} places, {} views", k + 1, parts.size(), parts[k].size(),
                             whole.places().size(), part.dataset.split(false).size()));
        part.request.journal = std::make_shared<Journal>(journal, key, part.request.checkpoint_s);
        write_part_result(file, key, whole.solve(part));
        fs::remove(journal);
        malloc_trim(0);  // what the part's small pieces took, back to the system
    }
    return files;
}

}  // namespace

void throw_foreign(const std::string& name) {
    throw UserError(name + ": of another fit; leave it out, or make it anew");
}

Dataset part_dataset(const Dataset& whole, Mesh mesh, std::span<const uint32_t> views) {
    Dataset part;
    part.folder = whole.folder;
    part.name = whole.name;
    part.description = whole.description;
    part.source = whole.source;
    part.encoding = whole.encoding;
    part.views = whole.views;
    part.checksums = whole.checksums;
    part.mesh = std::move(mesh);
    for (View& view : part.views) view.held_out = true;
    const Box box = bounding_box(part.mesh.positions);
    bool any = false;
    for (const uint32_t view : views) {
        const bool may = part.mesh.positions.empty() || may_show(whole.views[view].camera, box);
        part.views[view].held_out = !may;
        any = any || may;
    }
    if (!any && !views.empty()) part.views[views.front()].held_out = false;
    return part;
}

FitRequest part_request(FitRequest request, std::span<const uint32_t> units) {
    request.part = true;
    request.validation = 0;  // the views are those that it and leave_out leave
    request.leave_out.clear();
    if (!request.records.empty()) request.records = (fs::path(request.records) / digest_of(units)).string();
    return request;
}

Shard parse_shard(const std::string& text) {
    Shard shard;
    const char *at = text.data(), *end = at + text.size();
    const auto read = [&](int& number) {
        const auto [behind, error] = std::from_chars(at, end, number);
        at = behind;
        return error == std::errc();
    };
    if (!read(shard.index) || at == end || *at++ != '/' || !read(shard.count) || at != end || shard.index < 1 ||
        shard.index > shard.count)
        throw UserError(fmt::format("shard '{}': give which and of how many, such as 2/7", text));
    return shard;
}

std::vector<std::vector<uint32_t>> parts_of(const Divided& whole, const Shard& shard, size_t parts) {
    const std::vector<uint32_t> of_shard =
        groups_of_neighbours(whole.places(), whole.weights(), size_t(shard.count))[size_t(shard.index) - 1];
    std::vector<Vec3f> places;
    std::vector<uint64_t> weights;
    for (const uint32_t place : of_shard) {
        places.push_back(whole.places()[place]);
        weights.push_back(whole.weights()[place]);
    }
    std::vector<std::vector<uint32_t>> out;
    for (std::vector<uint32_t>& part : groups_of_neighbours(places, weights, parts)) {
        for (uint32_t& place : part) place = of_shard[place];
        if (!part.empty()) out.push_back(std::move(part));
    }
    return out;
}

uint64_t Divided::learning_bytes(size_t) const { return 0; }

PartNeeds count_parts(const Divided& whole, const Shard& shard, const FitRequest& request) {
    constexpr size_t looked_at = 6;
    PartNeeds needs;
    const auto require_memory = [&](uint64_t bytes, const std::string& what) {
        if (request.memory > 0 && bytes > request.memory)
            throw UserError(fmt::format("{} are too little {}; give {} more", readable_bytes(request.memory), what,
                                        option_name("memory")));
    };
    const uint64_t merging = shard.count == 1 ? with_program(whole.merge_bytes(size_t(-1))) : 0;
    require_memory(merging, fmt::format("to put the fit together, which takes {}", readable_bytes(merging)));
    if (const uint64_t learning = whole.learning_bytes(views_to_count_samples_on))
        needs.learning = with_program(learning + whole.held_bytes());
    require_memory(needs.learning, fmt::format("to learn what all of the surface has in common, which takes {}",
                                               readable_bytes(needs.learning)));
    for (;;) {
        const auto parts = parts_of(whole, shard, needs.parts);
        needs.part = 0;
        for (size_t k = 0; k < parts.size(); k += std::max<size_t>(1, parts.size() / looked_at)) {
            const Part part = whole.cut(parts[k]);
            const Plan planned = plan(part.dataset, part.request, views_to_count_samples_on);
            needs.part = std::max(needs.part, with_program(total_bytes(planned.memory) + whole.held_bytes()));
            needs.disk = std::max(needs.disk, 2 * needs.parts * total_bytes(planned.disk));
        }
        if (shard.count == 1) needs.merging = with_program(whole.merge_bytes(needs.parts));
        needs.memory = std::max({needs.learning, needs.part, needs.merging});
        if (request.memory == 0 || needs.memory <= request.memory) return needs;
        if (parts.size() < needs.parts || 16 * needs.parts > whole.places().size())
            require_memory(needs.memory,
                           fmt::format("even for {} parts, which take {}", needs.parts, readable_bytes(needs.memory)));
        const double over = double(needs.memory) / double(request.memory);
        needs.parts = std::max(needs.parts + 1, size_t(double(needs.parts) * std::min(over, 4.0)));
    }
}

bool needs_parts(const Dataset& dataset, const FitRequest& request) {
    if (request.memory == 0) return false;
    return total_bytes(plan(dataset, request, views_to_count_samples_on).memory) + program_bytes > request.memory;
}

void fit_shard(const Dataset& dataset, const FitRequest& request, const Shard& shard, const fs::path& folder,
               bool force) {
    const std::string key = fit_key(dataset, request);
    check_shard_folder(folder, key, shard);
    if (const auto note = read_note(folder))
        return log_info(fmt::format("{} is there: {}", name_of(shard), folder.string()));
    const auto whole = family_of(request).divide(dataset, request);
    if (size_t(shard.count) > whole->places().size())
        throw UserError(fmt::format("shard {}/{}: {} has {} places to cut at; choose fewer shards", shard.index,
                                    shard.count, dataset.folder.string(), whole->places().size()));
    const PartNeeds needs = count_parts(*whole, shard, request);
    const auto parts = parts_of(*whole, shard, needs.parts);
    announce_needs(name_of(shard), needs, folder, force);
    fs::create_directories(folder);
    std::vector<std::string> files = solve_parts(*whole, parts, key, folder);
    if (const std::string text = text_of_model(request.model_name); !text.empty()) {
        write_file(folder / model_text_name, text);
        files.emplace_back(model_text_name);
    }
    const Json note = {{"format", shard_format},
                       {"version", shard_version},
                       {"shard", {shard.index, shard.count}},
                       {"dataset", fs::relative(dataset.folder, fs::absolute(folder)).string()},
                       {"files", files},
                       {"key", key}};
    write_file(folder / shard_json_name, json_text(note, 2) + "\n");
    log_info(fmt::format("{} is done: {}", name_of(shard), folder.string()));
}

ShardNote read_shard(const fs::path& folder) {
    if (!folder_exists(folder)) throw UserError(folder.string() + ": missing; run its shard's command");
    const auto json = read_note(folder);
    if (!json) {
        const bool begun = std::ranges::any_of(fs::directory_iterator(folder), [](const auto& entry) {
            return entry.path().filename().string().starts_with("part-");
        });
        throw UserError(folder.string() + (begun ? ": a shard that isn't finished; run its command again, it goes on"
                                                 : ": no shard; give folders that radiafit fit --shard wrote"));
    }
    ShardNote note;
    try {
        note.shard = {json->at("shard").at(0), json->at("shard").at(1)};
        note.dataset = (fs::absolute(folder) / json->at("dataset").get<std::string>()).lexically_normal();
        note.key = json->at("key");
        note.files = json->at("files").get<std::vector<std::string>>();
        const Json options = parse_json<Json>(note.key).at("options");
        load_model_of_fit(folder, options.at("model").get<std::string>(), true);
        note.request = request_from(options);
    } catch (const Json::exception&) {
        throw_damaged_shard(folder / shard_json_name);
    }
    return note;
}

std::map<int, fs::path> whole_of_shards(const std::vector<ShardFolder>& shards, const std::string& key) {
    std::map<int, fs::path> have;
    const ShardFolder& first = shards.front();
    for (const ShardFolder& s : shards) {
        if (s.key != key)
            throw UserError(fmt::format(
                "{}: a shard of another fit (its data, options or program differ from those of {}); leave it "
                "out, or make it anew",
                s.folder.string(), first.folder.string()));
        if (s.shard.count != first.shard.count)
            throw UserError(fmt::format("{}: {}, but others are of {}; make all with one number", s.folder.string(),
                                        name_of(s.shard), first.shard.count));
        const auto [at, fresh] = have.emplace(s.shard.index, s.folder);
        if (!fresh)
            throw UserError(fmt::format("{} and {}: both are {}; leave one out", at->second.string(), s.folder.string(),
                                        name_of(s.shard)));
    }
    constexpr size_t most_named = 20;
    const size_t missing = size_t(first.shard.count) - have.size();
    std::vector<int> named;
    for (int i = 1; i <= first.shard.count && named.size() < std::min(missing, most_named); ++i)
        if (!have.contains(i)) named.push_back(i);
    if (missing > 0)
        throw UserError(fmt::format("of {} shards {}{} {} missing; run {} and give all folders", first.shard.count,
                                    fmt::join(named, ", "), missing > named.size() ? " and more" : "",
                                    missing == 1 ? "is" : "are", missing == 1 ? "its command" : "their commands"));
    return have;
}

FinishedFit merge_shards(const Dataset& dataset, const FitRequest& request, const std::vector<fs::path>& folders) {
    const std::string key = fit_key(dataset, request);
    const auto whole = family_of(request).divide(dataset, request);
    std::vector<ShardFolder> shards;
    for (const fs::path& folder : folders) {
        const ShardNote note = read_shard(folder);
        shards.push_back({folder, note.shard, note.key});
    }
    const std::map<int, fs::path> have = whole_of_shards(shards, key);
    const EachPart each_part = [&](const auto& look) {
        for (const auto& [index, folder] : have)
            for (const std::string& name : read_shard(folder).files) {
                if (name == model_text_name) continue;
                const fs::path file = folder / name;
                if (!path_exists(file)) throw UserError(file.string() + ": missing; run its shard's command again");
                look(read_part_result(file, key), file.string());
            }
    };
    each_part([&](const PartResult& part, const std::string& name) { whole->add(part, name); });
    return whole->finish(each_part);
}

}  // namespace radiafit::fits
