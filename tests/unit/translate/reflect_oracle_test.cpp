// The oracle is SPIRV-Cross's own reflection, as its program prints it. Every number in its JSON that ours has as well must
// be the same.

#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <map>

#include "tests/unit/translate/mini_build.h"

namespace kiln {
namespace {

// As much JSON as `spirv-cross --reflect` prints.
struct Json {
    std::map<std::string, Json> fields;
    std::vector<Json> items;
    std::string text;  // of a string or a number
    const Json& at(const std::string& name) const {
        static const Json none;
        const auto found = fields.find(name);
        return found == fields.end() ? none : found->second;
    }
    bool has(const std::string& name) const { return fields.count(name) != 0; }
    uint32_t number() const { return static_cast<uint32_t>(std::stoul(text)); }
};

class JsonReader {
public:
    explicit JsonReader(const std::string& text) : text_(text) {}
    Json value() {
        Json out;
        const char c = peek();
        if (c == '{' || c == '[') {
            const char end = c == '{' ? '}' : ']';
            for (++at_; peek() != end;) {
                if (peek() == ',') ++at_;
                if (c == '[') {
                    out.items.push_back(value());
                    continue;
                }
                const std::string name = string();
                EXPECT_EQ(peek(), ':');
                ++at_;
                out.fields[name] = value();
            }
            ++at_;
        } else if (c == '"') {
            out.text = string();
        } else {
            while (at_ < text_.size() && std::string(",]} \n").find(text_[at_]) == std::string::npos) out.text += text_[at_++];
        }
        return out;
    }

private:
    char peek() {
        while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\n')) ++at_;
        return at_ < text_.size() ? text_[at_] : ']';
    }
    std::string string() {
        peek();
        std::string out;
        for (++at_; at_ < text_.size() && text_[at_] != '"'; ++at_) out += text_[at_];
        ++at_;
        return out;
    }
    const std::string& text_;
    size_t at_ = 0;
};

std::string run_tool(const Words& words) {
    const std::string path = testing::TempDir() + "kiln_reflect_" + std::to_string(words.size()) + ".spv";
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(words.data()), static_cast<std::streamsize>(words.size() * 4));
    std::string out;
    if (FILE* pipe = popen(("spirv-cross " + path + " --reflect 2>/dev/null").c_str(), "r")) {
        char buffer[4096];
        for (size_t n; (n = fread(buffer, 1, sizeof buffer, pipe)) > 0;) out.append(buffer, n);
        pclose(pipe);
    }
    std::remove(path.c_str());
    return out;
}

// Its members, flattened with our names.
void flatten(const Json& types, const std::string& type, const std::string& prefix, uint32_t offset,
             std::map<std::string, uint32_t>& out) {
    for (const Json& m : types.at(type).at("members").items) {
        const std::string name = prefix + m.at("name").text;
        const uint32_t at = offset + m.at("offset").number();
        if (m.at("type").text[0] == '_')
            flatten(types, m.at("type").text, name + (m.has("array") ? "[]." : "."), at, out);
        else
            out[name] = at;
    }
}

void compare(const Json& oracle, const Reflection& ours) {
    const std::map<std::string, ResourceKind> sections = {{"textures", ResourceKind::combined_image},
                                                          {"separate_images", ResourceKind::separate_image},
                                                          {"separate_samplers", ResourceKind::separate_sampler},
                                                          {"images", ResourceKind::storage_image},
                                                          {"ssbos", ResourceKind::storage_block},
                                                          {"ubos", ResourceKind::uniform_block},
                                                          {"push_constants", ResourceKind::push_constants},
                                                          {"subpass_inputs", ResourceKind::input_attachment}};
    size_t seen = 0;
    for (const auto& [section, kind] : sections)
        for (const Json& j : oracle.at(section).items) {
            ++seen;
            const Resource* r = nullptr;
            for (const Resource& x : ours.resources)
                if (x.name == j.at("name").text ||
                    (kind == ResourceKind::push_constants && x.kind == kind))  // it names push constants by the variable
                    r = &x;
            ASSERT_NE(r, nullptr) << j.at("name").text;
            EXPECT_EQ(r->kind, kind) << r->name;
            if (kind != ResourceKind::push_constants) {
                EXPECT_EQ(r->set, j.at("set").number()) << r->name;
                EXPECT_EQ(r->binding, j.at("binding").number()) << r->name;
            }
            if (j.has("block_size")) {
                EXPECT_EQ(r->bytes, j.at("block_size").number()) << r->name;
            }
            EXPECT_EQ(r->array.size(), j.at("array").items.size()) << r->name;
            std::map<std::string, uint32_t> members;
            flatten(oracle.at("types"), j.at("type").text, "", 0, members);
            EXPECT_EQ(r->members.size(), members.size()) << r->name;
            for (const Member& m : r->members) {
                ASSERT_EQ(members.count(m.name), 1U) << r->name << " " << m.name;
                EXPECT_EQ(m.offset, members[m.name]) << r->name << " " << m.name;
            }
        }
    EXPECT_EQ(seen, ours.resources.size());
    const auto locations = [](const std::vector<Varying>& list) {
        std::map<std::string, uint32_t> out;
        for (const Varying& v : list) out[v.name] = v.location;
        return out;
    };
    const auto inputs = locations(ours.inputs), outputs = locations(ours.outputs);
    for (const Json& j : oracle.at("inputs").items) EXPECT_EQ(inputs.at(j.at("name").text), j.at("location").number());
    for (const Json& j : oracle.at("outputs").items) EXPECT_EQ(outputs.at(j.at("name").text), j.at("location").number());
}

TEST(ReflectOracle, AgreesWithSpirvCross) {
    if (std::system("spirv-cross --help >/dev/null 2>&1") != 0) GTEST_SKIP() << "spirv-cross is not installed";
    const std::pair<Stage, const char*> shaders[] = {{Stage::vertex, R"(
layout(set=0, binding=0) uniform Camera { mat4 view; mat4 proj; vec3 eye; float near_; };
layout(set=2, binding=1) uniform Bones { mat4x3 bones[16]; };
layout(push_constant) uniform Push { mat4 model; uint id; } push;
layout(location=0) in vec3 at; layout(location=1) in vec4 tangent; layout(location=3) in uvec4 joints;
layout(location=0) out vec3 world; layout(location=2) out mat3 turn; layout(location=5) flat out uint id;
void main() { vec4 w = push.model * vec4(bones[joints.x] * vec4(at, 1), near_); world = w.xyz - eye; turn = mat3(view);
              id = push.id; gl_Position = proj * view * w + tangent; })"},
                                                     {Stage::fragment, R"(
struct Light { vec4 at; vec3 colour; int kind; }; struct Box { vec2 low, high; Light inner[2]; };
layout(set=1, binding=2) uniform Lights { Light lights[8]; Box box; layout(offset=1024) vec4 last; };
layout(set=1, binding=0) uniform sampler2D albedo; layout(set=1, binding=1) uniform samplerCube sky[2];
layout(set=0, binding=4) uniform texture2D detail; layout(set=0, binding=5) uniform sampler linear;
layout(set=3, binding=0, rgba16f) uniform image2D target_;
layout(location=0) in vec2 uv; layout(location=0) out vec4 a; layout(location=1) out vec4 b;
void main() { a = texture(albedo, uv) + texture(sky[1], vec3(uv, 1)) + lights[3].at + box.inner[1].at + last;
              b = texture(sampler2D(detail, linear), uv) + vec4(lights[1].kind); imageStore(target_, ivec2(0), a); })"},
                                                     {Stage::compute, R"(
layout(local_size_x=64) in; struct P { vec3 at; float mass; mat2 m; };
layout(std430, set=0, binding=0) readonly buffer In { uint count; P from[]; };
layout(std430, set=0, binding=1) buffer Out { float sums[4]; vec3 v; P into[]; };
layout(std140, set=0, binding=2) uniform U { float k[3]; vec4 scale; };
void main() { into[gl_GlobalInvocationID.x] = from[count]; sums[1] += k[2] * scale.x; v = from[0].at; })"}};
    for (const auto& [stage, text] : shaders) {
        const Words words = spirv_of(stage, text);
        const Result<Reflection> ours = reflect_words(words);
        ASSERT_TRUE(ours.ok());
        const std::string json = run_tool(words);
        ASSERT_FALSE(json.empty());
        compare(JsonReader(json).value(), *ours);
    }
}

}  // namespace
}  // namespace kiln
