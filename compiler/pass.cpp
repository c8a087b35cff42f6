#include "compiler/pass.h"

#include <algorithm>
#include <chrono>
#include <set>

#include "compiler/memo.h"
#include "compiler/modules/blame.h"
#include "compiler/space/describe.h"
#include "compiler/space/set_wire.h"

namespace kiln {

namespace {

// Adds the wall time of its own life to the build's list.
class Timed {
public:
    Timed(Build& build, const char* step) : build_(build), step_(step), start_(std::chrono::steady_clock::now()) {}
    Timed(const Timed&) = delete;
    Timed& operator=(const Timed&) = delete;
    ~Timed() {
        const std::chrono::duration<double, std::milli> taken = std::chrono::steady_clock::now() - start_;
        build_.ms.emplace_back(step_, taken.count());
    }

private:
    Build& build_;
    const char* step_;
    std::chrono::steady_clock::time_point start_;
};

bool stopped(Build& build) {
    if (interrupted.load(std::memory_order_relaxed) && !build.failed) build.failed = environment_error("interrupted");
    return !build.ok();
}

void note_store_failure(Build& build, const Status& status) {
    if (status.ok()) return;
    if (build.work.store_failures++ == 0) build.diags.warning({}, "the cache failed: " + status.error().message);
}

// Stages after the preprocessor name files relative to the manifest, so that records hold anywhere; people want them as opened.
void append_rebased(Build& build, const Diags& diags) {
    for (const Diag& d : diags.list()) {
        Place place = d.place;
        if (!place.file.empty()) place.file = join_path(build.manifest->folder, place.file);
        build.diags.add(d.severity, std::move(place), d.message, d.source_line).notes = d.notes;
    }
}

// Everything that decides a stage's classes except the contents of files.
Digest classes_key(const Build& build, const Shader& shader, const StageFile& stage, const Space& space,
                   const BuildOptions& options) {
    const Manifest& manifest = *build.manifest;
    KeyHasher hasher("kiln.classes.v1");
    hasher.field("kiln", kiln_version).field("root", stage.file).field("stage", static_cast<uint64_t>(stage.stage));
    hasher.field("shader", shader.name);
    for (const Axis& axis : space.axes) {
        hasher.field("axis", axis.name).field("macro", axis.macro).field("kind", static_cast<uint64_t>(axis.kind));
        for (const AxisValue& value : axis.values)
            hasher.field("value", value.name).field("number", static_cast<uint64_t>(static_cast<int64_t>(value.number)));
    }
    for (const Rule& rule : space.rules) hasher.field(rule.forbid ? "forbid" : "require", rule.text);
    WireWriter sets;
    write_sets(sets, *space.diagram, {space.legal, space.needed});
    hasher.field("sets", sets.view());
    for (const auto& [name, body] : shader.defines) hasher.field("define", name).field("body", body);
    for (const std::string& folder : manifest.include) hasher.field("include", folder);
    hasher.field("undefined", static_cast<uint64_t>(shader.options.undefined_macros))
        .field("vulkan", uint64_t{shader.options.vulkan});
    hasher.field("debug", uint64_t{shader.options.debug}).field("states", options.max_states);
    return hasher.finish();
}

void warn_unread_axes(Build& build) {
    const Manifest& manifest = *build.manifest;
    std::vector<bool> used(manifest.axes.size()), read(manifest.axes.size());
    for (size_t i = 0; i < build.stages.size(); ++i) {
        const Shader& shader = *build.stages[i].shader;
        for (const uint32_t axis : shader.axes) used[axis] = true;
        for (const uint32_t axis : build.splits[i]->axes_read) read[shader.axes[axis]] = true;
    }
    for (size_t a = 0; a < manifest.axes.size(); ++a)
        if (used[a] && !read[a]) {
            const Axis& axis = manifest.axes[a];
            Diag& warning = build.diags.warning(axis.place, "no stage reads the macro " + axis.macro + " of axis '" + axis.name +
                                                                "': it multiplies variants, not code");
            if (axis.kind == AxisKind::boolean)
                warning.notes.push_back("#ifdef " + axis.macro + " is always true for it: write #if " + axis.macro +
                                        ", or give the axis 'values: defined'");
        }
}

void count_spaces(Build& build) {
    for (const auto& space : build.spaces) {
        build.counts.declared += space->declared();
        build.counts.legal += space->diagram->count(space->legal);
        build.counts.needed += space->diagram->count(space->needed);
    }
}

std::vector<SourceRead> all_reads(Build& build, const BuildOptions& options, Files& files) {
    std::vector<SourceRead> reads;
    std::set<std::string> known;
    const auto add = [&](const SourceRead& read) {
        if (known.insert(read.path).second) reads.push_back(read);
    };
    std::vector<std::string> own = options.scenes;
    own.insert(own.begin(), options.manifest);
    for (const std::string& path : own) {
        const auto text = files.read(path);
        if (text.ok() && text->has_value()) add({normal_path(path), true, sha256(as_bytes(**text))});
    }
    for (const auto& split : build.splits)
        for (const SourceRead& read : split->reads) add(read);
    return reads;
}

void list_depends(Build& build, const std::vector<SourceRead>& reads) {
    for (const SourceRead& read : reads)
        if (read.present) build.depends.push_back(read.path);
    std::sort(build.depends.begin(), build.depends.end());
    build.depends.erase(std::unique(build.depends.begin(), build.depends.end()), build.depends.end());
}

// A whole build's memo: what was asked, and what came out.
Digest build_key(const BuildOptions& options, const std::string& folder, const Toolchain& tools) {
    KeyHasher hasher("kiln.build.v1");
    hasher.field("kiln", kiln_version).field("tools", tools.versions());
    hasher.field("manifest", relative_path(folder, options.manifest));
    for (const std::string& scene : options.scenes) hasher.field("scene", relative_path(folder, scene));
    for (const Target target : options.targets) hasher.field("target", static_cast<uint64_t>(target));
    hasher.field("debug", uint64_t{options.debug}).field("parse back", uint64_t{options.parse_back});
    hasher.field("states", options.max_states);
    return hasher.finish();
}

void write_build(WireWriter& out, const Build& build, const std::string& folder) {
    for (const Count& count : {build.counts.declared, build.counts.legal, build.counts.needed}) out.text(count.decimal());
    for (const uint64_t n :
         {build.counts.classes, build.counts.raw, build.counts.pruned, build.counts.modules, build.counts.pipelines})
        out.u64(n);
    out.u64(build.counts.artifacts.size());
    for (const auto& [target, n] : build.counts.artifacts) {
        out.u8(static_cast<uint8_t>(target));
        out.u64(n);
    }
    write_diags(out, build.diags, folder);
    out.bytes(build.files.table);
    out.bytes(build.files.proof);
    out.text(build.key_header);
}

bool read_build(WireReader& in, Build& build, const std::string& folder) {
    for (Count* count : {&build.counts.declared, &build.counts.legal, &build.counts.needed}) *count = Count::parse(in.text());
    for (uint64_t* n :
         {&build.counts.classes, &build.counts.raw, &build.counts.pruned, &build.counts.modules, &build.counts.pipelines})
        *n = in.u64();
    const size_t targets = in.count(9);
    for (size_t i = 0; i < targets; ++i) {
        const uint8_t target = in.u8();
        if (target >= target_count) in.fail();
        build.counts.artifacts[static_cast<Target>(target)] = in.u64();
    }
    if (!read_diags(in, build.diags, folder)) return false;
    const ByteView table = in.bytes();
    build.files.table.assign(table.begin(), table.end());
    const ByteView proof = in.bytes();
    build.files.proof.assign(proof.begin(), proof.end());
    build.key_header = in.text();
    return in.ok() && in.at_end();
}

}  // namespace

void pass_spaces(Build& build, const BuildOptions& options, PassContext& context) {
    const Timed timed(build, "manifest");
    build.manifest = load_manifest(context.files, options.manifest, build.diags);
    if (!build.manifest) return;
    Manifest& manifest = *build.manifest;
    if (!options.targets.empty()) manifest.targets = options.targets;
    if (options.debug) {
        manifest.options.debug = true;
        for (Shader& shader : manifest.shaders) shader.options.debug = true;
    }
    for (const std::string& path : options.scenes)
        if (auto scene = load_scene(context.files, path, build.diags)) build.scenes.push_back(std::move(*scene));
    if (stopped(build)) return;
    for (const Shader& shader : manifest.shaders) build.spaces.push_back(build_space(manifest, shader, build.diags));
    if (stopped(build)) return;
    lint(manifest, build.spaces, build.diags);
    if (stopped(build)) return;
    apply_scenes(build.scenes, build.spaces, build.diags);
    count_spaces(build);
    if (!stopped(build) && build.counts.needed.is_zero())
        build.diags.error({normal_path(options.manifest), 0, 0},
                          "nothing is needed: no scene object names a shader of this manifest");
}

void pass_classes(Build& build, const BuildOptions& options, PassContext& context) {
    const Timed timed(build, "classes");
    const Manifest& manifest = *build.manifest;
    for (size_t s = 0; s < manifest.shaders.size(); ++s) {
        const Shader& shader = manifest.shaders[s];
        if (build.spaces[s]->needed == Diagram::none()) continue;
        for (const StageFile& stage : shader.stages)
            build.stages.push_back({&shader, build.spaces[s].get(), stage.stage, nullptr});
    }
    build.splits.resize(build.stages.size());
    std::vector<Status> stored(build.stages.size());
    std::vector<uint8_t> hit(build.stages.size());

    // A diagram serves one thread at a time, so a job is a shader with all of its stages.
    std::vector<size_t> first;
    for (size_t i = 0; i < build.stages.size(); ++i)
        if (i == 0 || build.stages[i].shader != build.stages[i - 1].shader) first.push_back(i);
    first.push_back(build.stages.size());
    const auto split_shader = [&](size_t job) {
        for (size_t i = first[job]; i < first[job + 1]; ++i) {
            const Shader& shader = *build.stages[i].shader;
            Space& space = *build.stages[i].space;
            const auto stage = std::find_if(shader.stages.begin(), shader.stages.end(),
                                            [&](const StageFile& f) { return f.stage == build.stages[i].stage; });
            const Digest asked = classes_key(build, shader, *stage, space, options);
            auto split = std::make_unique<Split>();
            if (const auto bytes = recall(context.store, context.files, manifest.folder, asked, split->reads)) {
                WireReader in(*bytes);
                if (read_split(in, *split, space, manifest.folder))
                    hit[i] = 1;
                else
                    *split = Split();
            }
            if (hit[i] == 0) {
                SplitOptions how;
                how.max_states = options.max_states;
                how.lines = shader.options.debug;
                *split = split_stage(manifest, shader, *stage, space, space.needed, context.files, how);
                if (!split->diags.has_errors() && context.store.keeps() && !interrupted.load()) {
                    WireWriter out;
                    write_split(out, *split, space, manifest.folder);
                    stored[i] = remember(context.store, context.files, manifest.folder, asked, split->reads, out.view());
                }
            }
            build.splits[i] = std::move(split);
        }
    };
    const bool finished = context.jobs.each(first.size() - 1, split_shader);
    if (!finished || interrupted.load()) {
        stopped(build);
        return;
    }
    for (size_t i = 0; i < build.stages.size(); ++i) {
        build.stages[i].split = build.splits[i].get();
        build.diags.append(build.splits[i]->diags);
        build.counts.classes += build.splits[i]->classes.size();
        build.work.cache_hits += hit[i];
        build.work.preprocessed += hit[i] != 0 ? 0 : build.splits[i]->lexed;
        note_store_failure(build, stored[i]);
    }
    if (build.ok()) warn_unread_axes(build);
}

void pass_table(Build& build, const BuildOptions& options, PassContext& context) {
    const Manifest& manifest = *build.manifest;
    {
        const Timed timed(build, "modules");
        build.modules = build_modules(build.stages, context.store, context.tools, context.jobs, context.progress,
                                      source_lines(context.files, manifest.folder), context.elsewhere);
        build.work.store_failures += build.modules.store_failures;
        append_rebased(build, build.modules.diags);
        build.counts.raw = build.modules.raw;
        build.counts.pruned = build.modules.pruned;
        build.counts.modules = build.modules.list.size();
        build.work.compiled += build.modules.compiled;
        build.work.optimised += build.modules.optimised;
        build.work.cache_hits += build.modules.cache_hits;
    }
    if (stopped(build)) return;
    // From here source text is gone; a module is its words.
    {
        const Timed timed(build, "interfaces");
        build.interfaces = check_interfaces(build.stages, build.modules);
        build.diags.append(build.interfaces.diags);
        build.counts.pipelines = build.interfaces.pipelines.size();
    }
    if (stopped(build)) return;
    {
        const Timed timed(build, "artifacts");
        const TranslateOptions how{manifest.targets, options.parse_back};
        build.artifacts = translate_modules(build.stages, build.modules, how, context.store, context.tools, context.jobs,
                                            context.progress, context.elsewhere);
        build.diags.append(build.artifacts.diags);
        build.work.translated += build.artifacts.translated;
        build.work.cache_hits += build.artifacts.cache_hits;
        build.work.store_failures += build.artifacts.store_failures;
        for (const Target target : manifest.targets) build.counts.artifacts[target] = 0;
        for (const Artifacts::Text& text : build.artifacts.list) ++build.counts.artifacts[text.target];
        if (build.counts.artifacts.count(Target::spirv) != 0) build.counts.artifacts[Target::spirv] = build.counts.modules;
    }
    if (stopped(build)) return;
    // From here nothing is looked at again; the rest is writing down.
    const Timed timed(build, "table");
    TableInput input;
    input.manifest = &manifest;
    input.tool_versions = context.tools.versions();
    input.targets = manifest.targets;
    for (const Scene& scene : build.scenes) input.scenes.push_back(scene.name);
    input.stages = build.stages;
    for (const auto& space : build.spaces)
        if (space->needed == Diagram::none()) input.left_out.push_back(space.get());
    input.modules = &build.modules;
    input.artifacts = &build.artifacts;
    input.interfaces = &build.interfaces;
    auto written = write_table(input, context.jobs);
    if (!written.ok()) {
        build.failed = written.error();
        return;
    }
    build.files = std::move(*written);
    build.key_header = write_key_header(input);
}

Build run_pass(const BuildOptions& options, PassContext& context) {
    const std::string folder = folder_of(normal_path(options.manifest));
    const Digest asked = build_key(options, folder, context.tools);
    Build remembered;
    bool found = false;
    {
        const Timed timed(remembered, "memo");
        std::vector<SourceRead> reads;
        if (const auto bytes = recall(context.store, context.files, folder, asked, reads)) {
            WireReader in(*bytes);
            found = read_build(in, remembered, folder);
            list_depends(remembered, reads);
        }
    }
    if (found) {
        remembered.work.cache_hits = 1;
        return remembered;
    }
    Build build;
    pass_spaces(build, options, context);
    if (build.ok()) pass_classes(build, options, context);
    const std::vector<SourceRead> reads = all_reads(build, options, context.files);
    list_depends(build, reads);
    if (build.ok()) pass_table(build, options, context);
    build.diags.sort();
    if (build.ok() && context.store.keeps()) {
        WireWriter out;
        write_build(out, build, folder);
        note_store_failure(build, remember(context.store, context.files, folder, asked, reads, out.view()));
    }
    return build;
}

}  // namespace kiln
