#include "compiler/toolchain/spirv_operands.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "compiler/toolchain/glsl.h"
#include "compiler/toolchain/read_often.h"
#include "compiler/toolchain/spirv.h"
#include "tests/unit/translate/feature_shaders.h"

namespace kiln {
namespace {

void expect_equal(const ParsedModule& ours, const ParsedModule& theirs, const std::string& what) {
    ASSERT_EQ(ours.instructions.size(), theirs.instructions.size()) << what;
    for (size_t i = 0; i < ours.instructions.size(); ++i) {
        const ParsedInstruction &a = ours.instructions[i], &b = theirs.instructions[i];
        ASSERT_TRUE(a.at == b.at && a.op == b.op && a.length == b.length && a.result == b.result && a.first_id == b.first_id &&
                    a.ids == b.ids)
            << what << ": instruction " << i << ", opcode " << b.op;
    }
    EXPECT_EQ(ours.id_words, theirs.id_words) << what;
}

TEST(SpirvOperands, SaysWhatSpirvToolsSaysOfEveryFeatureInEveryForm) {
    size_t known = 0, all = 0;
    for (const FeatureShader& feature : feature_shaders) {
        Options options;
        options.vulkan = 0x103;
        const Compiled raw = glsl_compile(feature.stage, std::string("#version 460\n") + feature.text, options);
        if (raw.words.empty()) continue;
        std::vector<Words> forms = {raw.words};
        for (const Optimise how : {Optimise::performance, Optimise::size}) {
            options.optimise = how;
            const Result<Words> pruned = spirv_prune(raw.words, options);
            ASSERT_TRUE(pruned.ok()) << feature.name;
            const Result<Words> final = spirv_optimise(*pruned, options);
            ASSERT_TRUE(final.ok()) << feature.name;
            forms.push_back(*pruned);
            forms.push_back(*final);
        }
        for (const Words& words : forms) {
            ParsedModule ours, theirs;
            ++all;
            ASSERT_TRUE(spirv_parse(words, options, theirs)) << feature.name;
            if (!read_operands(words, ours)) continue;
            ++known;
            expect_equal(ours, theirs, feature.name);
        }
    }
    EXPECT_GT(all, 400u);
    EXPECT_GT(known * 10, all * 7) << "of " << all << " modules, only " << known << " are read without SPIRV-Tools";
}

TEST(SpirvOperands, RefusesWhatIsNoModule) {
    const Result<Words> pruned = spirv_prune(glsl_compile(Stage::fragment, "#version 450\nvoid main() {}", {}).words, {});
    ASSERT_TRUE(pruned.ok());
    const Words& good = *pruned;
    ParsedModule out;
    ASSERT_TRUE(read_operands(good, out));
    EXPECT_FALSE(read_operands({}, out));
    for (size_t length = 0; length < good.size(); ++length) {
        // A module cut between two instructions is well formed as far as this goes; nothing may be read past its end.
        const Words cut(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(length));
        if (!read_operands(cut, out)) continue;
        for (const ParsedInstruction& in : out.instructions) EXPECT_LE(in.at + in.length, cut.size());
    }
    Words endless = good;
    endless[5] = 0;
    EXPECT_FALSE(read_operands(endless, out));
    Words unknown = good;
    unknown[5] = 1u << 16 | 0x1fff;
    EXPECT_FALSE(read_operands(unknown, out));
}

// The opcodes of what is named, sorted.
struct Named {
    std::vector<uint16_t> ids, by_component;
};

Named named_in(const std::string& body) {
    const Words words = glsl_compile(Stage::fragment,
                                     "#version 450\nlayout(location=0) in vec4 v; layout(location=0) out vec4 o;\n"
                                     "layout(binding=0) uniform sampler2D t; layout(binding=1) uniform B { int n; vec4 u; };\n"
                                     "void main() {\n" +
                                         body + "\n}\n",
                                     {})
                            .words;
    EXPECT_FALSE(words.empty()) << body;
    const Result<Words> pruned = spirv_prune(words, {});
    const Result<Words> final = pruned.ok() ? spirv_optimise(*pruned, {}) : pruned;
    if (!final.ok()) return {};
    ParsedModule parsed;
    EXPECT_TRUE(read_operands(*final, parsed));
    const ReadOften often = find_read_often(*final);
    const auto opcodes = [&](const std::vector<uint32_t>& ids) {
        std::vector<uint16_t> out;
        for (const uint32_t id : ids)
            for (const ParsedInstruction& in : parsed.instructions)
                if (in.result == id) out.push_back(in.op);
        std::sort(out.begin(), out.end());
        return out;
    };
    return {opcodes(often.ids), opcodes(often.by_component)};
}

using Opcodes = std::vector<uint16_t>;
constexpr uint16_t f_add = 129, f_mul = 133, sample_implicit = 87, sample_explicit = 88;

TEST(ReadOften, NamesWhatIsReadTwiceAndNothingElse) {
    EXPECT_EQ(named_in("o = v + u;").ids, Opcodes());
    EXPECT_EQ(named_in("vec4 a = v + u; o = a * a;").ids, Opcodes({f_add}));
    EXPECT_EQ(named_in("vec4 a = v + u; o = a * u;").ids, Opcodes());
    EXPECT_EQ(named_in("float a = v.x * u.x; o = vec4(a);").ids, Opcodes()) << "a splat is one text";
    EXPECT_EQ(named_in("vec4 a = v * u; o = vec4(a.x, a.w, 0.0, 1.0);").ids, Opcodes({f_mul}));
}

TEST(ReadOften, NamesWhatALoopReads) {
    const std::string loop = "for (int i = 0; i < n; ++i) s = max(s, ";
    EXPECT_EQ(named_in("vec4 a = v * u, s = v; " + loop + "a); o = s;").ids, Opcodes({f_mul}));
    const Named inside = named_in("vec4 s = v; " + loop + "v * u); o = s;");
    EXPECT_EQ(std::count(inside.ids.begin(), inside.ids.end(), f_mul), 0);
}

TEST(ReadOften, NamesSamplesWhoseDerivativesABranchWouldChange) {
    EXPECT_EQ(named_in("vec4 a = texture(t, v.xy); if (n > 3) o = a; else o = v;").ids, Opcodes({sample_implicit}));
    EXPECT_EQ(named_in("vec4 a = texture(t, v.xy) * u; if (n > 3) o = a; else o = v;").ids, Opcodes({sample_implicit}));
    EXPECT_EQ(named_in("o = texture(t, v.xy);").ids, Opcodes());
    const Named explicit_lod = named_in("vec4 a = textureLod(t, v.xy, 0.0); if (n > 3) o = a; else o = v;");
    EXPECT_EQ(std::count(explicit_lod.ids.begin(), explicit_lod.ids.end(), sample_explicit), 0);
}

TEST(ReadOften, CountsComparisonsOfVectorsForTargetsThatUnrollThem) {
    const Named named = named_in("vec3 a = v.xyz + u.xyz; o = vec4(all(lessThan(a, vec3(1.0))));");
    EXPECT_EQ(named.ids, Opcodes());
    EXPECT_EQ(named.by_component, Opcodes({f_add}));
}

TEST(ReadOften, SurvivesWhatIsNoModule) {
    EXPECT_TRUE(find_read_often({}).ids.empty());
    const Words words = {0x07230203, 0x10000, 0, 0, 0};
    EXPECT_TRUE(find_read_often(words).ids.empty());
}

}  // namespace
}  // namespace kiln
