// Reads the tree top down. A part that is wrong is reported and left out, and reading goes on with what is left, so that one
// run shows every mistake; what rests on a wrong part (a rule on an axis that did not parse) is only judged when its ground is
// sound.
#include "compiler/manifest/manifest.h"

#include <algorithm>
#include <unordered_map>

#include "compiler/manifest/manifest_parts.h"

namespace kiln {

namespace {

using Names = std::vector<std::string>;

Names target_names() {
    Names names;
    for (const Target t : all_targets()) names.push_back(name_of(t));
    return names;
}

Names stage_names() {
    Names names;
    for (const Stage s : all_stages()) names.push_back(name_of(s));
    return names;
}

// Why these stages cannot be one shader, or empty. A lone vertex or fragment stage is fine: its partner is another shader's.
std::string stage_clash(const std::vector<StageFile>& stages) {
    const auto has = [&](Stage s) {
        return std::any_of(stages.begin(), stages.end(), [&](const StageFile& f) { return f.stage == s; });
    };
    const auto group = [](Stage s) {
        if (s == Stage::compute) return 1;
        if (s == Stage::task || s == Stage::mesh) return 2;
        if (s >= Stage::raygen) return 3;
        return 0;
    };
    for (const StageFile& a : stages)
        for (const StageFile& b : stages) {
            const bool mesh_fragment = group(a.stage) == 2 && b.stage == Stage::fragment;
            if (a.stage < b.stage && group(a.stage) != group(b.stage) && !(group(b.stage) == 2 && a.stage == Stage::fragment) &&
                !mesh_fragment)
                return std::string("a ") + name_of(a.stage) + " stage and a " + name_of(b.stage) + " stage cannot be one shader";
        }
    const auto needs = [&](Stage s, Stage other) {
        return has(s) && !has(other) ? std::string("a ") + name_of(s) + " stage needs a " + name_of(other) + " stage" : "";
    };
    for (const auto& [s, other] : {std::pair{Stage::tess_control, Stage::tess_evaluation},
                                   {Stage::tess_evaluation, Stage::tess_control},
                                   {Stage::tess_control, Stage::vertex},
                                   {Stage::geometry, Stage::vertex},
                                   {Stage::task, Stage::mesh}})
        if (std::string problem = needs(s, other); !problem.empty()) return problem;
    return {};
}

// The first axis of an expression that a shader does not have.
std::optional<uint32_t> missing_axis(const Expr& expr, const Shader& shader) {
    for (const uint32_t axis : expr.axes)
        if (!std::binary_search(shader.axes.begin(), shader.axes.end(), axis)) return axis;
    return std::nullopt;
}

class Reader {
public:
    Reader(const Yaml& yaml, YamlErrors& errors, Manifest& out) : in_{yaml, errors}, yaml_(yaml), errors_(errors), out_(out) {}

    void read() {
        for (const Yaml::Pair& pair : yaml_.pairs(0))
            if (yaml_.value(pair.key) == "kiln_scene") return errors_.at(pair.key, "this is a scene, not a manifest");
        Fields top(yaml_, errors_, 0, "a manifest",
                   {"kiln", "name", "include", "targets", "options", "axes", "rules", "shaders"});
        if (!top.is_map()) return;
        if (const auto* f = top.need("kiln")) version(f->value);
        if (const auto* f = top.find("name"))
            if (auto name = read_plain_name(in_, f->value, "the name")) out_.name = std::move(*name);
        if (const auto* f = top.find("include")) includes(f->value);
        if (const auto* f = top.find("targets")) targets(f->value);
        if (out_.targets.empty()) out_.targets.push_back(Target::spirv);
        if (const auto* f = top.find("options")) options_ = read_options(in_, f->value, options_);
        out_.options = options_.options;
        if (const auto* f = top.find("axes")) {
            const size_t before = errors_.count();
            out_.axes = read_axes(in_, f->value);
            axes_sound_ = before == errors_.count();
        }
        if (const auto* f = top.find("rules")) rules_ = read_rules(in_, f->value, out_.axes, nullptr);
        if (const auto* f = top.need("shaders")) shaders(f->value);
    }

private:
    void version(Yaml::Node node) {
        if (yaml_.is_plain(node) && yaml_.value(node) == "1") return;
        errors_.at(node, "this program reads manifests of version 1 ('kiln: 1'), this is " + describe(yaml_, node));
    }

    void includes(Yaml::Node node) {
        for (const Yaml::Node item : read_list(yaml_, errors_, node, "include"))
            if (auto folder = read_text(yaml_, errors_, item, "a folder of the search path")) out_.include.push_back(*folder);
    }

    void targets(Yaml::Node node) {
        std::unordered_map<size_t, Yaml::Node> seen;
        for (const Yaml::Node item : read_list(yaml_, errors_, node, "targets")) {
            const auto choice = read_choice(yaml_, errors_, item, "a target", target_names());
            if (!choice) continue;
            const auto [first, fresh] = seen.emplace(*choice, item);
            if (fresh)
                out_.targets.push_back(all_targets()[*choice]);
            else
                errors_.at(item, "duplicate target " + quoted(yaml_.value(item)),
                           {"first at " + to_string(yaml_.place(first->second))});
        }
    }

    void shaders(Yaml::Node node) {
        const std::vector<Yaml::Node> items = read_list(yaml_, errors_, node, "shaders");
        if (yaml_.kind(node) == YamlKind::sequence && items.empty()) errors_.at(node, "shaders is empty: a manifest needs one");
        std::unordered_map<std::string, size_t> seen;
        for (const Yaml::Node item : items) {
            Shader read = shader(item);
            const auto [first, fresh] = seen.emplace(read.name, out_.shaders.size());
            if (!fresh && !read.name.empty())
                errors_.at(read.place, "duplicate shader " + quoted(read.name),
                           {"first at " + to_string(out_.shaders[first->second].place)});
            out_.shaders.push_back(std::move(read));
        }
        if (!out_.shaders.empty()) spread_rules();
    }

    Shader shader(Yaml::Node node) {
        Shader out;
        Fields fields(yaml_, errors_, node, "a shader", {"name", "stages", "axes", "rules", "defines", "options"});
        out.place = yaml_.place(node);
        if (const auto* f = fields.need("name")) {
            out.place = yaml_.place(f->value);
            if (auto name = read_plain_name(in_, f->value, "a shader's name")) out.name = std::move(*name);
        }
        out.source_line = yaml_.source_line(out.place);
        if (const auto* f = fields.need("stages")) stages(f->value, out);
        shader_axes(fields.find("axes"), out);
        if (const auto* f = fields.find("defines")) defines(f->value, out);
        out.options = out_.options;
        if (const auto* f = fields.find("options")) out.options = read_options(in_, f->value, options_).options;
        if (const auto* f = fields.find("rules")) out.rules = read_rules(in_, f->value, out_.axes, &out);
        return out;
    }

    void stages(Yaml::Node node, Shader& out) {
        if (yaml_.kind(node) != YamlKind::map || yaml_.size(node) == 0)
            return errors_.at(node, yaml_.kind(node) == YamlKind::map
                                        ? "stages is empty: a shader needs at least one"
                                        : "stages must be a map of stages to files, this is " + describe(yaml_, node));
        for (const Yaml::Pair& pair : yaml_.pairs(node)) {
            const auto choice = read_choice(yaml_, errors_, pair.key, "a stage", stage_names());
            const auto file = read_text(yaml_, errors_, pair.value, "the file of a stage");
            if (!choice || !file) continue;
            const Place place = yaml_.place(pair.value);
            out.stages.push_back({all_stages()[*choice], *file, place, yaml_.source_line(place)});
        }
        std::sort(out.stages.begin(), out.stages.end(), [](const StageFile& a, const StageFile& b) { return a.stage < b.stage; });
        if (std::string clash = stage_clash(out.stages); !clash.empty()) errors_.at(node, std::move(clash));
    }

    void shader_axes(const Yaml::Pair* field, Shader& out) {
        if (field == nullptr) {
            for (uint32_t i = 0; i < out_.axes.size(); ++i) out.axes.push_back(i);
            return;
        }
        const size_t before = errors_.count();
        std::unordered_map<uint32_t, Yaml::Node> seen;
        for (const Yaml::Node item : read_list(yaml_, errors_, field->value, "a shader's axes")) {
            const auto name = read_text(yaml_, errors_, item, "an axis");
            if (!name) continue;
            const auto axis = axis_named(*name);
            if (!axis) {
                Names names;
                for (const Axis& a : out_.axes) names.push_back(a.name);
                errors_.at(item, "unknown axis " + quoted(*name) + did_you_mean(*name, names));
                continue;
            }
            const auto [first, fresh] = seen.emplace(*axis, item);
            if (fresh)
                out.axes.push_back(*axis);
            else
                errors_.at(item, "duplicate axis " + quoted(*name), {"first at " + to_string(yaml_.place(first->second))});
        }
        std::sort(out.axes.begin(), out.axes.end());
        axes_sound_ = axes_sound_ && before == errors_.count();
    }

    std::optional<uint32_t> axis_named(std::string_view name) const {
        for (uint32_t i = 0; i < out_.axes.size(); ++i)
            if (out_.axes[i].name == name) return i;
        return std::nullopt;
    }

    void defines(Yaml::Node node, Shader& out) {
        if (yaml_.kind(node) != YamlKind::map)
            return errors_.at(node, "defines must be a map of macros to text, this is " + describe(yaml_, node));
        for (const Yaml::Pair& pair : yaml_.pairs(node)) {
            const std::string_view macro = yaml_.value(pair.key);
            if (const char* const problem = macro_problem(macro)) {
                errors_.at(pair.key, "the macro " + quoted(macro) + " " + problem);
                continue;
            }
            for (const uint32_t a : out.axes)
                if (out_.axes[a].macro == macro)
                    errors_.at(pair.key, quoted(macro) + " is the macro of axis " + quoted(out_.axes[a].name),
                               {"declared at " + to_string(out_.axes[a].place)});
            if (yaml_.kind(pair.value) != YamlKind::scalar) {
                errors_.at(pair.value, "the body of a macro must be text, this is " + describe(yaml_, pair.value),
                           {"write \"\" for an empty one"});
                continue;
            }
            std::string body(yaml_.value(pair.value));
            const bool control = std::any_of(body.begin(), body.end(), [](char c) {
                return (static_cast<unsigned char>(c) < 0x20 && c != '\t') || c == 0x7F;
            });
            if (control || (!body.empty() && body.back() == '\\'))
                errors_.at(pair.value,
                           "the body of a macro must be one line, without control characters, and may not end in '\\'");
            out.defines.emplace_back(std::string(macro), std::move(body));
        }
    }

    // Gives each of the manifest's rules to the shaders that have all of its axes, before their own.
    void spread_rules() {
        std::vector<bool> used(rules_.size());
        for (Shader& shader : out_.shaders) {
            std::vector<Rule> all;
            for (size_t i = 0; i < rules_.size(); ++i)
                if (!missing_axis(rules_[i].expr, shader)) {
                    used[i] = true;
                    all.push_back(rules_[i]);
                }
            all.insert(all.end(), std::make_move_iterator(shader.rules.begin()), std::make_move_iterator(shader.rules.end()));
            shader.rules = std::move(all);
        }
        for (size_t i = 0; i < rules_.size() && axes_sound_; ++i)
            if (!used[i]) fits_none(rules_[i]);
    }

    void fits_none(const Rule& rule) {
        Names notes;
        for (const Shader& shader : out_.shaders) {
            const uint32_t axis = *missing_axis(rule.expr, shader);
            if (notes.size() < 4)
                notes.push_back("shader " + quoted(shader.name) + " does not have the axis " + quoted(out_.axes[axis].name));
        }
        errors_.at(rule.place, "this rule fits no shader: none has all of its axes", std::move(notes));
    }

    ManifestText in_;
    const Yaml& yaml_;
    YamlErrors& errors_;
    Manifest& out_;
    OptionsRead options_;
    std::vector<Rule> rules_;
    bool axes_sound_ = true;
};

}  // namespace

std::optional<std::string> read_plain_name(ManifestText in, Yaml::Node node, const std::string& what) {
    auto name = read_text(in.yaml, in.errors, node, what);
    if (!name) return std::nullopt;
    bool good = name->size() <= name_limit;
    for (size_t i = 0; i < name->size(); ++i) {
        const char c = (*name)[i];
        const bool word = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
        good = good && (word || (i > 0 && (c == '.' || c == '-')));
    }
    if (good) return name;
    in.errors.at(node, what + " cannot be " + quoted(*name) +
                           ": letters, digits, '_', and behind the first also '.' and '-', at most " +
                           std::to_string(name_limit) + " bytes");
    return std::nullopt;
}

std::vector<Rule> read_rules(ManifestText in, Yaml::Node node, const std::vector<Axis>& axes, const Shader* only) {
    std::vector<Rule> rules;
    for (const Yaml::Node item : read_list(in.yaml, in.errors, node, "rules")) {
        Fields fields(in.yaml, in.errors, item, "a rule", {"forbid", "require", "because"});
        const Yaml::Pair* const forbid = fields.find("forbid");
        const Yaml::Pair* const require = fields.find("require");
        if (!fields.is_map()) continue;
        if ((forbid == nullptr) == (require == nullptr)) {
            in.errors.at(item, forbid == nullptr ? "a rule needs a 'forbid' or a 'require'"
                                                 : "a rule has either a 'forbid' or a 'require', not both");
            continue;
        }
        Rule rule;
        if (const auto* f = fields.find("because"))
            rule.because = read_prose(in.yaml, in.errors, f->value, "because").value_or("");
        rule.forbid = forbid != nullptr;
        const Yaml::Node text = (rule.forbid ? forbid : require)->value;
        if (in.yaml.kind(text) != YamlKind::scalar) {
            in.errors.at(text, "an expression must be text, this is " + describe(in.yaml, text),
                         in.yaml.kind(text) == YamlKind::null ? std::vector<std::string>{}
                                                              : std::vector<std::string>{"quote the expression"});
            continue;
        }
        const auto prose = read_prose(in.yaml, in.errors, text, "an expression");
        if (!prose) continue;
        rule.text = *prose;
        rule.place = in.yaml.place_in(text, 0);
        rule.source_line = in.yaml.source_line(rule.place);
        auto parsed = parse_expr(rule.text, axes);
        if (const auto* error = std::get_if<ExprError>(&parsed)) {
            if (error->axis && axes[*error->axis].values.empty()) continue;  // the axis itself is wrong, which was said
            in.errors.at(in.yaml.place_in(text, error->offset), error->message);
            continue;
        }
        rule.expr = std::get<Expr>(std::move(parsed));
        if (const auto missing = only == nullptr ? std::nullopt : missing_axis(rule.expr, *only)) {
            const auto use = std::find_if(rule.expr.nodes.begin(), rule.expr.nodes.end(),
                                          [&](const ExprNode& n) { return n.op == Op::axis && n.axis == *missing; });
            in.errors.at(in.yaml.place_in(text, use->offset),
                         "shader " + quoted(only->name) + " does not have the axis " + quoted(axes[*missing].name));
            continue;
        }
        rules.push_back(std::move(rule));
    }
    return rules;
}

std::optional<Manifest> load_manifest(Files& files, const std::string& path, Diags& diags) {
    std::optional<std::string> text = read_source(files, path, diags);
    if (!text) return std::nullopt;
    const std::optional<Yaml> yaml = Yaml::parse(path, std::move(*text), diags);
    if (!yaml) return std::nullopt;
    Manifest out;
    out.path = path;
    out.folder = folder_of(path);
    out.name = stem_of(path);
    YamlErrors errors(*yaml, diags);
    Reader(*yaml, errors, out).read();
    if (errors.any()) return std::nullopt;
    return out;
}

}  // namespace kiln
