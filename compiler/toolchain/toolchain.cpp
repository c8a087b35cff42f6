// The real tools behind the seam: one source file per library, joined here.

#include "compiler/toolchain/toolchain.h"

#include "compiler/base/version.h"
#include "compiler/toolchain/cross.h"
#include "compiler/toolchain/glsl.h"
#include "compiler/toolchain/spirv.h"

namespace kiln {
namespace {

class RealToolchain final : public Toolchain {
public:
    std::string versions() const override { return versions_; }
    // Pruning, reflection and the edits before a translation are kiln's own.
    std::string identity() const override { return versions_ + "; kiln " + kiln_version; }
    Compiled compile(Stage stage, std::string_view text, const Options& options) override {
        return glsl_compile(stage, text, options);
    }
    Result<Words> prune(WordView words, const Options& options) override { return spirv_prune(words, options); }
    Result<Words> optimise(WordView words, const Options& options) override { return spirv_optimise(words, options); }
    std::vector<ToolMessage> validate(WordView words, const Options& options) override { return spirv_validate(words, options); }
    Result<Reflection> reflect(WordView words) override { return reflect_words(words); }
    std::vector<Translated> translate(WordView words, const std::vector<Target>& targets, const SlotLayout& slots) override {
        return cross_translate(words, targets, slots);
    }
    std::vector<ToolMessage> parse_back(Target target, Stage stage, std::string_view text) override {
        return glsl_parse_back(target, stage, text);
    }
    std::vector<ToolMessage> link_back(Target target, std::string_view vertex, std::string_view fragment) override {
        return glsl_link_back(target, vertex, fragment);
    }

private:
    const std::string versions_ = glsl_version() + "; " + spirv_version() + "; " + cross_version();
};

}  // namespace

std::unique_ptr<Toolchain> make_toolchain() { return std::make_unique<RealToolchain>(); }

}  // namespace kiln
