#include "sample.h"

#include <algorithm>
#include <cassert>

#include "compiler/manifest/expr.h"

namespace kiln::test {

namespace {

Set set_of(Space& space, const std::string& text) {
    auto parsed = parse_expr(text, space.axes);
    if (auto* error = std::get_if<ExprError>(&parsed)) {
        std::fprintf(stderr, "%s: %s\n", text.c_str(), error->message.c_str());
        std::abort();
    }
    return compile_expr(space, std::get<Expr>(parsed));
}

Reflection reflection_of(Stage stage, const std::string& text) {
    Reflection r;
    r.stage = stage;
    Resource block;
    block.name = "Frame";
    block.bytes = 80;
    Member matrix{"view", {BaseType::float32, 4, 4, {}}, 0, 64, 0, {}, 16, false};
    Member lights{"lights[].position", {BaseType::float32, 3, 1, {2}}, 64, 12, 16, {16}, 0, false};
    block.members = {matrix, lights};
    r.resources.push_back(block);
    if (stage == Stage::fragment) {
        Resource image;
        image.name = "albedo";
        image.kind = ResourceKind::combined_image;
        image.binding = 1;
        image.dim = ImageDim::d2;
        if (text.find("flat") == std::string::npos) r.resources.push_back(image);
        r.outputs.push_back({"colour", 0, 0, 0, {BaseType::float32, 4, 1, {}}, false, false, false, false, false});
        r.discards = true;
    }
    r.inputs.push_back({"uv", 1, 0, 0, {BaseType::float32, 2, 1, {}}, false, true, false, false, false});
    return r;
}

}  // namespace

Axis named(std::string name, std::vector<std::string> values) {
    Axis a;
    a.macro = name;
    std::transform(a.macro.begin(), a.macro.end(), a.macro.begin(), [](char c) { return static_cast<char>(std::toupper(c)); });
    a.name = std::move(name);
    for (size_t i = 0; i < values.size(); ++i) {
        AxisValue v;
        v.name = values[i];
        v.number = static_cast<int32_t>(i);
        a.values.push_back(v);
    }
    return a;
}

Axis boolean(std::string name) {
    Axis a = named(std::move(name), {"false", "true"});
    a.kind = AxisKind::boolean;
    return a;
}

void every(const std::vector<uint32_t>& radices, const std::function<void(const Digits&)>& visit) {
    Digits digits(radices.size());
    for (;;) {
        visit(digits);
        size_t i = radices.size();
        while (i > 0 && ++digits[i - 1] == radices[i - 1]) digits[--i] = 0;
        if (i == 0) return;
    }
}

Sample::Sample(std::vector<SampleShader> shaders, std::vector<Target> targets) {
    manifest.name = "sample";
    manifest.targets = std::move(targets);
    manifest.shaders.resize(shaders.size());
    for (size_t i = 0; i < shaders.size(); ++i) add(shaders[i], i);
}

uint32_t Sample::module(Stage stage, const std::string& text) {
    const auto known = known_.find({stage, text});
    if (known != known_.end()) return known->second;
    Module m;
    m.stage = stage;
    m.words = {0x07230203u, 0x10300u, static_cast<uint32_t>(stage)};
    for (const char c : text) m.words.push_back(static_cast<uint8_t>(c));
    m.unoptimised = m.words;
    m.unoptimised.push_back(99);
    m.digest = sha256(as_bytes(WordView(m.words)));
    m.reflection = reflection_of(stage, text);
    modules_.list.push_back(m);
    const auto index = static_cast<uint32_t>(modules_.list.size() - 1);
    known_[{stage, text}] = index;
    return index;
}

void Sample::add(const SampleShader& shader, size_t index) {
    Shader& s = manifest.shaders[index];
    s.name = shader.name;
    for (const Axis& axis : shader.axes) {
        s.axes.push_back(static_cast<uint32_t>(manifest.axes.size()));
        manifest.axes.push_back(axis);
    }
    for (const std::string& text : shader.forbid) {
        Rule rule;
        rule.text = text;
        rule.because = "a test";
        rule.expr = std::get<Expr>(parse_expr(text, manifest.axes));
        s.rules.push_back(rule);
    }
    Diags diags;
    spaces_.push_back(build_space(manifest, s, diags));
    Space& space = *spaces_.back();
    if (!shader.needed.empty()) space.needed = space.diagram->both(space.legal, set_of(space, shader.needed));
    artifacts_.of.emplace_back(manifest.targets.size());
    std::vector<const Reflection*> reflections;
    for (const SampleStage& stage : shader.stages) {
        auto split = std::make_unique<Split>();
        split->axes_read = stage.reads;
        std::map<std::string, Set> classes;
        if (stage.conditions.empty()) {
            space.diagram->enumerate(space.needed, [&](const Digits& d) {
                Set& set = classes[stage.text(d)];
                set = space.diagram->either(set, space.diagram->point(d));
                return true;
            });
        } else {
            for (const std::string& c : stage.conditions) classes[c] = space.diagram->both(space.needed, set_of(space, c));
        }
        modules_.of_class.emplace_back();
        for (auto& [text, set] : classes) {
            Class c;
            c.variants = set;
            c.text = text;
            split->classes.push_back(c);
            modules_.of_class.back().push_back(module(stage.stage, text));
        }
        StageClasses out;
        out.space = &space;
        out.stage = stage.stage;
        out.split = split.get();
        stages_.push_back(out);
        splits_.push_back(std::move(split));
    }
    std::vector<uint32_t> used;
    for (size_t i = stages_.size() - shader.stages.size(); i < stages_.size(); ++i) {
        stages_[i].shader = reinterpret_cast<const Shader*>(index + 1);
        used.insert(used.end(), modules_.of_class[i].begin(), modules_.of_class[i].end());
    }
    for (size_t t = 0; t < manifest.targets.size(); ++t) {
        auto& of = artifacts_.of[index][t];
        of.assign(4096, no_artifact);
        if (manifest.targets[t] == Target::spirv) continue;
        for (const uint32_t m : used) {
            if (of[m] != no_artifact) continue;
            of[m] = static_cast<uint32_t>(artifacts_.list.size());
            std::string text = "// " + shader.name + " " + std::to_string(m) + "\n";
            for (uint32_t line = 0; line < 40; ++line)
                text += "vec4 line" + std::to_string(line * (line % 7 + m)) + " = vec4(0.0);\n";
            artifacts_.list.push_back({manifest.targets[t], text});
        }
    }
    SlotLayout layout;
    Slot frame, albedo;
    frame.name = "Frame";
    albedo.name = "albedo";
    albedo.kind = ResourceKind::combined_image;
    albedo.binding = 1;
    albedo.texture = 3;
    layout.slots = {frame, albedo};
    artifacts_.slots.push_back(layout);
    std::map<std::vector<uint32_t>, Set> tuples{{{}, space.needed}};
    for (size_t i = stages_.size() - shader.stages.size(); i < stages_.size(); ++i) {
        std::map<std::vector<uint32_t>, Set> next;
        for (const auto& [tuple, set] : tuples)
            for (size_t c = 0; c < stages_[i].split->classes.size(); ++c) {
                const Set both = space.diagram->both(set, stages_[i].split->classes[c].variants);
                if (both == Diagram::none()) continue;
                std::vector<uint32_t> longer = tuple;
                longer.push_back(modules_.of_class[i][c]);
                next[longer] = space.diagram->either(next[longer], both);
            }
        tuples = std::move(next);
    }
    for (const auto& [tuple, set] : tuples) {
        if (set == Diagram::none()) continue;
        Pipeline p;
        p.shader = static_cast<uint32_t>(index);
        p.modules = tuple;
        p.variants = set;
        p.count = space.diagram->count(set);
        p.witness = *space.diagram->witness(set);
        interfaces_.pipelines.push_back(p);
    }
}

uint32_t Sample::module_of(size_t stage, const Digits& digits) const {
    const StageClasses& s = stages_[stage];
    for (size_t c = 0; c < s.split->classes.size(); ++c)
        if (s.space->diagram->contains(s.split->classes[c].variants, digits)) return modules_.of_class[stage][c];
    std::abort();
}

TableInput Sample::input() const {
    TableInput in;
    in.manifest = &manifest;
    in.tool_versions = tool_versions;
    in.targets = manifest.targets;
    in.scenes = scenes;
    in.stages = stages_;
    in.modules = &modules_;
    in.artifacts = &artifacts_;
    in.interfaces = &interfaces_;
    return in;
}

Sample small_sample() {
    const auto letters = [](std::string stem, std::vector<uint32_t> axes) {
        return [stem = std::move(stem), axes = std::move(axes)](const Digits& d) {
            std::string out = stem;
            for (const uint32_t a : axes) out += static_cast<char>('a' + d[a]);
            return out;
        };
    };
    SampleShader surface{"surface",
                         {named("light", {"none", "directional", "point", "spot"}),
                          named("pass", {"forward", "depth", "velocity"}), boolean("skinned")},
                         {"light == none && pass == forward"},
                         {{Stage::vertex, {1, 2}, letters("v", {1, 2})}, {Stage::fragment, {0, 1}, letters("f", {0, 1})}},
                         "light != spot"};
    SampleShader blur{"blur", {named("radius", {"r1", "r2", "r4", "r8", "r16"})}, {}, {{Stage::compute, {0}, letters("c", {0})}}};
    Sample out({surface, blur}, {Target::spirv, Target::glsl450, Target::essl310});
    out.scenes = {"corridor", "yard"};
    const uint32_t hole = out.modules_.of_class[1][0];
    out.artifacts_.of[0][2][hole] = no_artifact;
    out.artifacts_.refusals[{0, 2, hole}] = "ESSL 3.10 has no doubles";
    return out;
}

}  // namespace kiln::test
