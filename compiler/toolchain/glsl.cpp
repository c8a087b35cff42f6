// glslang keeps process-wide tables behind one lock and builds the symbol tables of a language version during the first
// parse that needs them, some 150 ms. Two threads that begin with the same version would only queue up on that lock, and
// older versions raced there, so the first parse of each version runs alone; later ones share nothing but the tables.
//
// A TShader owns the memory pool of everything parsed, and leaves the thread's current pool pointing at it. So a shader and
// its program always live and die inside one call here, the program first.

#include "compiler/toolchain/glsl.h"

#include <glslang/Public/ResourceLimits.h>
#include <glslang/Public/ShaderLang.h>
#include <glslang/SPIRV/GlslangToSpv.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <map>
#include <mutex>
#include <optional>
#include <shared_mutex>

#include "compiler/toolchain/messages.h"
#include "compiler/toolchain/text_depth.h"

namespace kiln {
namespace {

std::atomic<bool> started{false};

void start() {
    static const bool once = [] {
        glslang::InitializeProcess();
        started = true;
        return true;
    }();
    static_cast<void>(once);
}

// Lets the first caller of each `language` pass alone, and everybody else together.
class FirstAlone {
public:
    template <class Body>
    void run(const std::string& language, const Body& body) {
        {
            std::shared_lock shared(mutex_);
            if (seen_.count(language) != 0) return body();
        }
        std::unique_lock alone(mutex_);
        body();
        seen_[language] = true;
    }

private:
    std::shared_mutex mutex_;
    std::map<std::string, bool> seen_;
};
FirstAlone first_alone;

EShLanguage language_of(Stage stage) {
    switch (stage) {
        case Stage::vertex:
            return EShLangVertex;
        case Stage::tess_control:
            return EShLangTessControl;
        case Stage::tess_evaluation:
            return EShLangTessEvaluation;
        case Stage::geometry:
            return EShLangGeometry;
        case Stage::fragment:
            return EShLangFragment;
        case Stage::compute:
            return EShLangCompute;
        case Stage::task:
            return EShLangTask;
        case Stage::mesh:
            return EShLangMesh;
        case Stage::raygen:
            return EShLangRayGen;
        case Stage::intersection:
            return EShLangIntersect;
        case Stage::any_hit:
            return EShLangAnyHit;
        case Stage::closest_hit:
            return EShLangClosestHit;
        case Stage::miss:
            return EShLangMiss;
        case Stage::callable:
            return EShLangCallable;
    }
    return EShLangVertex;
}

glslang::EShTargetClientVersion client_of(uint32_t vulkan) {
    switch (vulkan) {
        case 0x100:
            return glslang::EShTargetVulkan_1_0;
        case 0x102:
            return glslang::EShTargetVulkan_1_2;
        case 0x103:
            return glslang::EShTargetVulkan_1_3;
        default:
            return glslang::EShTargetVulkan_1_1;
    }
}

// The line that says the language version, which selects glslang's tables; empty when there is none near the top.
std::string version_line(std::string_view text) {
    const size_t at = text.substr(0, 4096).find("#version");
    if (at == std::string_view::npos) return {};
    return std::string(text.substr(at, text.find('\n', at) - at));
}

bool is_line_directive(std::string_view line) {
    const size_t hash = line.find_first_not_of(" \t");
    if (hash == std::string_view::npos || line[hash] != '#') return false;
    const size_t word = line.find_first_not_of(" \t", hash + 1);
    return word != std::string_view::npos && line.substr(word).starts_with("line") && line.size() > word + 4 &&
           (line[word + 4] == ' ' || line[word + 4] == '\t');
}

// The text with every #line line emptied, so that lines count the text itself.
std::string without_line_directives(std::string_view text) {
    std::string out;
    out.reserve(text.size());
    while (!text.empty()) {
        const size_t end = std::min(text.find('\n'), text.size());
        if (!is_line_directive(text.substr(0, end))) out.append(text.substr(0, end));
        if (end < text.size()) out.push_back('\n');
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return out;
}

// The file that the first #line names: the name of the source in debug info.
std::string first_file(std::string_view text) {
    const size_t line = text.find("#line ");
    if (line == std::string_view::npos) return {};
    const std::string_view rest = text.substr(line, text.find('\n', line) - line);
    const size_t open = rest.find('"'), close = rest.rfind('"');
    if (open == std::string_view::npos || close <= open) return {};
    return std::string(rest.substr(open + 1, close - open - 1));
}

void append(std::vector<ToolMessage>& to, std::vector<ToolMessage> from) {
    to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
}

constexpr EShMessages vulkan_rules = static_cast<EShMessages>(EShMsgDefault | EShMsgSpvRules | EShMsgVulkanRules);

// In glslang's words a missing main is about "linking", and a missing #version about some old version that nobody wrote.
void say_it_plainly(std::vector<ToolMessage>& messages, std::string_view text) {
    for (ToolMessage& m : messages) {
        if (m.text.find("Missing entry point") != std::string::npos) m.text = "no main() in this stage";
        if (m.text == "memory exhausted") m.text = "the text nests deeper than the compiler can follow";
        const size_t stage = m.text.find(" stage: ");
        if (m.text.starts_with("Linking ") && stage != std::string::npos) m.text.erase(0, stage + 8);
        if (m.text.starts_with("#version: ") && version_line(text).empty()) {
            m.text = "no #version line in this stage: GLSL for Vulkan begins with one, 140 or higher";
        }
    }
}

void emit(glslang::TProgram& program, EShLanguage language, const Options& options, Compiled& out) {
    glslang::SpvOptions how;
    how.generateDebugInfo = options.debug;
    how.disableOptimizer = true;
    spv::SpvBuildLogger logger;
    glslang::GlslangToSpv(*program.getIntermediate(language), out.words, &logger, &how);
    append(out.messages, read_messages(logger.getAllMessages()));
    if (out.words.empty() && !has_error(out.messages)) out.messages.push_back({Severity::error, 0, "glslang made no SPIR-V"});
}

Compiled compile_here(Stage stage, std::string_view text, const Options& options, bool debug) {
    Compiled out;
    const EShLanguage language = language_of(stage);
    glslang::TShader shader(language);
    const char* strings[] = {text.data()};
    const int lengths[] = {static_cast<int>(text.size())};
    const std::string file = debug ? first_file(text) : std::string();
    const char* names[] = {file.c_str()};
    if (file.empty()) {
        shader.setStringsWithLengths(strings, lengths, 1);
    } else {
        shader.setStringsWithLengthsAndNames(strings, lengths, names, 1);
    }
    shader.setEntryPoint("main");
    shader.setSourceEntryPoint("main");
    shader.setEnvInput(glslang::EShSourceGlsl, language, glslang::EShClientVulkan, 100);
    shader.setEnvClient(glslang::EShClientVulkan, client_of(options.vulkan));
    shader.setEnvTarget(glslang::EShTargetSpv,
                        static_cast<glslang::EShTargetLanguageVersion>((options.spirv >> 8) << 16 | (options.spirv & 0xff) << 8));
    const EShMessages rules = debug ? static_cast<EShMessages>(vulkan_rules | EShMsgDebugInfo) : vulkan_rules;
    const bool parsed = shader.parse(GetDefaultResources(), 110, false, rules);
    out.messages = read_messages(shader.getInfoLog());
    if (parsed) {
        glslang::TProgram program;
        program.addShader(&shader);
        const bool linked = program.link(rules);
        append(out.messages, read_messages(program.getInfoLog()));
        if (linked && !has_error(out.messages)) emit(program, language, options, out);
    }
    if (!parsed && !has_error(out.messages))
        out.messages.push_back({Severity::error, 0, "glslang refused the text without a reason"});
    say_it_plainly(out.messages, text);
    if (has_error(out.messages)) out.words.clear();
    return out;
}

// One stage, parsed and linked alone, so that reflection can be asked about it.
class Alone {
public:
    Alone(EShLanguage language, std::string_view text) : shader_(language), text_(text) {
        if (std::optional<ToolMessage> problem = too_deep(text)) {
            messages.push_back(std::move(*problem));
            return;
        }
        strings_[0] = text_.data();
        lengths_[0] = static_cast<int>(text_.size());
        shader_.setStringsWithLengths(strings_, lengths_, 1);
        const bool parsed = shader_.parse(GetDefaultResources(), 100, false, EShMsgDefault);
        messages = read_messages(shader_.getInfoLog());
        if (!parsed && !has_error(messages))
            messages.push_back({Severity::error, 0, "glslang refused the text without a reason"});
    }
    glslang::TShader& shader() { return shader_; }
    std::vector<ToolMessage> messages;

private:
    glslang::TShader shader_;
    std::string_view text_;
    const char* strings_[1];
    int lengths_[1];
};

struct Global {
    std::string type;
    int location = -1;
    bool builtin = false;
};
using Globals = std::map<std::string, Global>;

struct StageFace {
    std::vector<ToolMessage> messages;
    Globals inputs, outputs, uniforms;
};

int location_of(const glslang::TType& type) {
    return type.getQualifier().hasLocation() ? static_cast<int>(type.getQualifier().layoutLocation) : -1;
}

Global describe(const glslang::TObjectReflection& object) {
    const glslang::TType& type = *object.getType();
    std::string words(glslang::TType::getBasicString(type.getBasicType()));
    words += " " + std::to_string(type.getVectorSize()) + " " + std::to_string(type.getMatrixCols()) + "x" +
             std::to_string(type.getMatrixRows()) + "[" + std::to_string(object.size) + "]";
    return {std::move(words), location_of(type), object.name.starts_with("gl_")};
}

StageFace look_at(EShLanguage language, std::string_view text) {
    StageFace face;
    Alone stage(language, text);
    face.messages = std::move(stage.messages);
    if (has_error(face.messages)) return face;
    glslang::TProgram program;
    program.addShader(&stage.shader());
    // An output counts when it is declared, an input only when it is read.
    const int options = EShReflectionIntermediateIO | (language == EShLangVertex ? EShReflectionAllIOVariables : 0);
    const bool linked = program.link(EShMsgDefault);
    append(face.messages, read_messages(program.getInfoLog()));
    if (!linked || !program.buildReflection(options)) {
        if (!has_error(face.messages)) face.messages.push_back({Severity::error, 0, "glslang could not link the stage alone"});
        return face;
    }
    for (int i = 0; i < program.getNumPipeInputs(); ++i)
        face.inputs[program.getPipeInput(i).name] = describe(program.getPipeInput(i));
    for (int i = 0; i < program.getNumPipeOutputs(); ++i) {
        face.outputs[program.getPipeOutput(i).name] = describe(program.getPipeOutput(i));
    }
    for (int i = 0; i < program.getNumUniformVariables(); ++i) {
        face.uniforms[program.getUniform(i).name] = describe(program.getUniform(i));
    }
    return face;
}

// An input that is read needs an output of its type: of its location where both say one, else of its name.
void match_faces(const StageFace& vertex, const StageFace& fragment, std::vector<ToolMessage>& messages) {
    for (const auto& [name, input] : fragment.inputs) {
        if (input.builtin) continue;
        const Global* output = nullptr;
        if (const auto same = vertex.outputs.find(name); same != vertex.outputs.end()) output = &same->second;
        const int location = input.location;
        if (location >= 0) {
            const auto there = std::find_if(vertex.outputs.begin(), vertex.outputs.end(),
                                            [location](const auto& o) { return o.second.location == location; });
            if (there != vertex.outputs.end()) output = &there->second;
        }
        if (output == nullptr) {
            messages.push_back({Severity::error, 0, "the vertex text has no output for the fragment input '" + name + "'"});
        } else if (output->type != input.type) {
            messages.push_back({Severity::error, 0, "'" + name + "' differs in type between the vertex and the fragment text"});
        }
    }
    for (const auto& [name, uniform] : fragment.uniforms) {
        const auto other = vertex.uniforms.find(name);
        if (other != vertex.uniforms.end() && other->second.type != uniform.type) {
            messages.push_back(
                {Severity::error, 0, "uniform '" + name + "' differs in type between the vertex and the fragment text"});
        }
    }
}

std::vector<ToolMessage> link_here(std::string_view vertex, std::string_view fragment) {
    const StageFace vertex_face = look_at(EShLangVertex, vertex);
    const StageFace fragment_face = look_at(EShLangFragment, fragment);
    std::vector<ToolMessage> messages = vertex_face.messages;
    append(messages, fragment_face.messages);
    if (has_error(messages)) return messages;
    Alone v(EShLangVertex, vertex), f(EShLangFragment, fragment);
    glslang::TProgram program;
    program.addShader(&v.shader());
    program.addShader(&f.shader());
    const bool linked = program.link(EShMsgDefault);
    append(messages, read_messages(program.getInfoLog()));
    if (!linked && !has_error(messages)) messages.push_back({Severity::error, 0, "glslang refused to link without a reason"});
    match_faces(vertex_face, fragment_face, messages);
    return messages;
}

template <class Body>
std::vector<ToolMessage> errors_of(const Body& body) {
    try {
        start();
        std::vector<ToolMessage> messages = body();
        std::erase_if(messages, [](const ToolMessage& m) { return m.severity != Severity::error; });
        return messages;
    } catch (const std::exception& problem) {
        return {{Severity::error, 0, std::string("glslang failed: ") + problem.what()}};
    }
}

}  // namespace

std::string glsl_version() {
    const glslang::Version v = glslang::GetVersion();
    return "glslang " + std::to_string(v.major) + "." + std::to_string(v.minor) + "." + std::to_string(v.patch) + v.flavor;
}

bool glsl_started() { return started; }

Compiled glsl_compile(Stage stage, std::string_view text, const Options& options) {
    Compiled out;
    if (text.size() > (size_t{1} << 30)) {
        out.messages.push_back({Severity::error, 0, "the preprocessed text is over 1 GiB"});
        return out;
    }
    if (std::optional<ToolMessage> problem = too_deep(text)) {
        out.messages.push_back(std::move(*problem));
        return out;
    }
    try {
        start();
        first_alone.run("vulkan " + version_line(text), [&] { out = compile_here(stage, text, options, options.debug); });
        // #line moved the messages' lines; a second parse without them says where in `text` they are.
        if (options.debug && !out.messages.empty()) {
            out.messages = compile_here(stage, without_line_directives(text), options, false).messages;
        }
    } catch (const std::exception& problem) {
        out.words.clear();
        out.messages.assign(1, {Severity::error, 0, std::string("glslang failed: ") + problem.what()});
    }
    return out;
}

std::vector<ToolMessage> glsl_parse_back(Target, Stage stage, std::string_view text) {
    return errors_of([&] {
        std::vector<ToolMessage> messages;
        first_alone.run("gl " + version_line(text), [&] { messages = Alone(language_of(stage), text).messages; });
        return messages;
    });
}

std::vector<ToolMessage> glsl_link_back(Target, std::string_view vertex, std::string_view fragment) {
    return errors_of([&] {
        std::vector<ToolMessage> messages;
        first_alone.run("gl " + version_line(vertex), [&] { messages = link_here(vertex, fragment); });
        return messages;
    });
}

}  // namespace kiln
