#include "oracle.h"

#include <glslang/Public/ResourceLimits.h>
#include <glslang/Public/ShaderLang.h>

#include <memory>

#include "compiler/base/files.h"

namespace oracle {

namespace {

EShLanguage language(kiln::Stage stage) {
    switch (stage) {
        case kiln::Stage::vertex:
            return EShLangVertex;
        case kiln::Stage::tess_control:
            return EShLangTessControl;
        case kiln::Stage::tess_evaluation:
            return EShLangTessEvaluation;
        case kiln::Stage::geometry:
            return EShLangGeometry;
        case kiln::Stage::fragment:
            return EShLangFragment;
        case kiln::Stage::compute:
            return EShLangCompute;
        case kiln::Stage::task:
            return EShLangTask;
        case kiln::Stage::mesh:
            return EShLangMesh;
        case kiln::Stage::raygen:
            return EShLangRayGen;
        case kiln::Stage::intersection:
            return EShLangIntersect;
        case kiln::Stage::any_hit:
            return EShLangAnyHit;
        case kiln::Stage::closest_hit:
            return EShLangClosestHit;
        case kiln::Stage::miss:
            return EShLangMiss;
        case kiln::Stage::callable:
            return EShLangCallable;
    }
    return EShLangFragment;
}

class Includer final : public glslang::TShader::Includer {
public:
    explicit Includer(const std::map<std::string, std::string>& files) : files_(files) {}
    IncludeResult* includeLocal(const char* name, const char* includer, size_t depth) override {
        if (depth > 100) return nullptr;
        return find(kiln::join_path(kiln::folder_of(includer), name));
    }
    IncludeResult* includeSystem(const char* name, const char*, size_t depth) override {
        if (depth > 100) return nullptr;
        return find(kiln::normal_path(name));
    }
    void releaseInclude(IncludeResult* result) override { delete result; }

private:
    IncludeResult* find(const std::string& path) {
        const auto at = files_.find(path);
        if (at == files_.end()) return nullptr;
        return new IncludeResult(at->first, at->second.data(), at->second.size(), nullptr);
    }
    const std::map<std::string, std::string>& files_;
};

}  // namespace

Answer preprocess(kiln::Stage stage, const std::map<std::string, std::string>& files, const std::string& root,
                  const std::string& preamble) {
    static const bool once = glslang::InitializeProcess();
    static_cast<void>(once);
    Answer answer;
    glslang::TShader shader(language(stage));
    const std::string& source = files.at(root);
    const char* const texts[] = {source.c_str()};
    const int lengths[] = {static_cast<int>(source.size())};
    shader.setStringsWithLengths(texts, lengths, 1);
    const std::string before = "#extension GL_GOOGLE_include_directive : require\n" + preamble;
    shader.setPreamble(before.c_str());
    shader.setEnvInput(glslang::EShSourceGlsl, language(stage), glslang::EShClientVulkan, 100);
    shader.setEnvClient(glslang::EShClientVulkan, glslang::EShTargetVulkan_1_1);
    shader.setEnvTarget(glslang::EShTargetSpv, glslang::EShTargetSpv_1_3);
    Includer includer(files);
    const auto messages = static_cast<EShMessages>(EShMsgSpvRules | EShMsgVulkanRules);
    answer.ok = shader.preprocess(GetDefaultResources(), 110, ENoProfile, false, false, messages, &answer.text, includer);
    answer.log = shader.getInfoLog();
    return answer;
}

}  // namespace oracle
