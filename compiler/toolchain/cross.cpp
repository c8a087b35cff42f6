// The only file that includes SPIRV-Cross, whose exceptions become refusals here. What is to be said to the library is worked
// out beforehand in edits.cpp, and which of its expressions to name in read_often.cpp.

#include "compiler/toolchain/cross.h"

#include <spirv_cross/spirv_cross_c.h>  // for its version

#include <exception>
#include <spirv_cross/spirv_hlsl.hpp>
#include <spirv_cross/spirv_msl.hpp>
#include <spirv_cross/spirv_parser.hpp>
#include <utility>

#include "compiler/reflect/spirv_enums.h"
#include "compiler/toolchain/edits.h"
#include "compiler/toolchain/limits.h"
#include "compiler/toolchain/read_often.h"

namespace kiln {
namespace {

namespace sc = spirv_cross;

// The library's words without its ids, which differ from variant to variant, and without advice that nobody here can take.
std::string clean(std::string why) {
    for (size_t at = why.find(" ID "); at != std::string::npos; at = why.find(" ID ", at)) {
        size_t end = at + 4;
        while (end < why.size() && why[end] >= '0' && why[end] <= '9') ++end;
        why.erase(at, end - at);
    }
    const size_t advice = why.find(" You can try");
    if (advice != std::string::npos) why.erase(advice);
    while (!why.empty() && (why.back() == '\n' || why.back() == '.')) why.pop_back();
    return why;
}

Translated refused(const std::string& reason) {
    std::string why = clean(reason);
    if (why.empty()) why = "SPIRV-Cross failed without a reason";
    return {{}, std::move(why)};
}

// The library writes an expression where it is read, and begins anew with a temporary for each that it met twice. Told of them
// beforehand it seldom has to: half of its work.
template <class Compiler>
class Told : public Compiler {
public:
    using Compiler::Compiler;
    void name_these(const std::vector<uint32_t>& ids) { this->forced_temporaries.insert(ids.begin(), ids.end()); }
};

// One target of one module. Its functions throw what the library throws.
class Translation {
public:
    Translation(Target target, const ir::View& view, const Edits& edits, const ReadOften& often)
        : target_(target), language_(language_of(target)), view_(view), edits_(edits), often_(often) {}

    template <class Tree>  // sc::ParsedIR, to be copied or taken
    std::string run(Tree&& tree, bool corrects_depth, bool flat_blocks) {
        const auto ready = [&](auto& compiler) {
            compiler.name_these(often_.ids);
            if (language_ == Language::hlsl) compiler.name_these(often_.by_component);
            set_common_options(compiler, corrects_depth, flat_blocks);
            if (is_gl() && edits_.separate) combine(compiler);
            for (const char* extension : edits_.extensions) compiler.require_extension(extension);
            apply(compiler);
        };
        if (language_ == Language::hlsl) {
            Told<sc::CompilerHLSL> compiler(std::forward<Tree>(tree));
            sc::CompilerHLSL::Options options = compiler.get_hlsl_options();
            options.shader_model = version_of(target_);
            options.point_size_compat = true;
            compiler.set_hlsl_options(options);
            ready(compiler);
            for (const Slot& s : edits_.slots) bind(compiler, s);
            return compiler.compile();
        }
        if (language_ == Language::msl) {
            Told<sc::CompilerMSL> compiler(std::forward<Tree>(tree));
            sc::CompilerMSL::Options options = compiler.get_msl_options();
            options.msl_version = version_of(target_);
            options.platform = sc::CompilerMSL::Options::macOS;
            options.texture_buffer_native = true;
            compiler.set_msl_options(options);
            ready(compiler);
            for (const Slot& s : edits_.slots) bind(compiler, s);
            return compiler.compile();
        }
        Told<sc::CompilerGLSL> compiler(std::forward<Tree>(tree));
        ready(compiler);
        return compiler.compile();
    }

private:
    bool is_gl() const { return language_ == Language::glsl || language_ == Language::essl; }

    void set_common_options(sc::CompilerGLSL& compiler, bool corrects_depth, bool flat_blocks) const {
        if (!is_gl()) return;
        sc::CompilerGLSL::Options options = compiler.get_common_options();
        options.version = version_of(target_);
        options.es = language_ == Language::essl;
        options.emit_push_constant_as_uniform_buffer = true;
        options.enable_420pack_extension = false;
        options.vertex.fixup_clipspace = corrects_depth;
        // Draw calls with a base instance came with GL 4.2; before, the term would be a uniform that nobody sets.
        options.vertex.support_nonzero_base_instance = target_ == Target::glsl450;
        options.force_flattened_io_blocks = flat_blocks;
        // Uniforms of both stages must agree in precision, and the vertex stage's is high.
        options.fragment.default_float_precision = sc::CompilerGLSL::Options::Highp;
        options.fragment.default_int_precision = sc::CompilerGLSL::Options::Highp;
        compiler.set_common_options(options);
    }

    // GL has no separate samplers: every pair that is used together becomes one, named and numbered by its two slots.
    void combine(sc::CompilerGLSL& compiler) const {
        const uint32_t dummy = compiler.build_dummy_sampler_for_combined_images();
        compiler.build_combined_image_samplers();
        for (const sc::CombinedImageSampler& pair : compiler.get_combined_image_samplers()) {
            const Slot* image = edits_.slot_of(pair.image_id);
            const Slot* sampler = pair.sampler_id == dummy ? image : edits_.slot_of(pair.sampler_id);
            if (!image || !sampler) continue;
            compiler.set_name(pair.combined_id, image->name + "_" + (sampler == image ? std::string("fetch") : sampler->name));
            compiler.set_decoration(pair.combined_id, spv::DecorationBinding, image->texture + sampler->unit_offset);
        }
    }

    void apply(sc::CompilerGLSL& compiler) const {
        for (const auto& [id, name] : edits_.names) compiler.set_name(id, name);
        for (const Edits::MemberName& m : edits_.member_names) compiler.set_member_name(m.type, m.member, m.name);
        if (!is_gl()) return;
        // Promises about the direction in which depth moves; GLSL before 4.20 and ESSL have no words for them, and need none.
        if (target_ != Target::glsl450)
            for (const auto mode :
                 {spv::ExecutionModeDepthGreater, spv::ExecutionModeDepthLess, spv::ExecutionModeDepthUnchanged})
                compiler.unset_execution_mode(mode);
        // ESSL has one blend source and so no word for the first; modules with a second are refused.
        if (language_ == Language::essl)
            for (const ir::Variable& v : view_.variables)
                if (v.storage == ir::sc_output) compiler.unset_decoration(v.id, spv::DecorationIndex);
        for (const Edits::Interpolate& i : edits_.interpolate) interpolate(compiler, i);
        for (const auto decoration : {spv::DecorationLocation, spv::DecorationComponent}) {
            if (edits_.unplaced.empty()) break;
            for (const uint32_t id : edits_.unplaced) compiler.unset_decoration(id, decoration);
            for (const Edits::MemberName& m : edits_.member_names) compiler.unset_member_decoration(m.type, m.member, decoration);
        }
        for (const auto& [id, number] : edits_.bindings) {
            compiler.unset_decoration(id, spv::DecorationDescriptorSet);
            compiler.set_decoration(id, spv::DecorationBinding, number);
        }
    }

    void interpolate(sc::CompilerGLSL& compiler, const Edits::Interpolate& i) const {
        const std::pair<spv::Decoration, bool> all[] = {
            {spv::DecorationFlat, i.how.flat},
            {spv::DecorationNoPerspective, i.how.no_perspective && language_ == Language::glsl},
            {spv::DecorationCentroid, i.how.centroid},
            {spv::DecorationSample, i.how.sample && target_ == Target::glsl450}};
        for (const auto& [decoration, wanted] : all) {
            if (i.is_member && wanted) compiler.set_member_decoration(i.id, i.member, decoration, 1);
            if (i.is_member && !wanted) compiler.unset_member_decoration(i.id, i.member, decoration);
            if (!i.is_member && wanted) compiler.set_decoration(i.id, decoration, 1);
            if (!i.is_member && !wanted) compiler.unset_decoration(i.id, decoration);
        }
    }

    template <class Binding>
    Binding place(const Slot& s) const {
        const bool push = s.kind == ResourceKind::push_constants;
        Binding b;
        b.stage = static_cast<spv::ExecutionModel>(view_.model);
        b.desc_set = push ? sc::ResourceBindingPushConstantDescriptorSet : s.set;
        b.binding = push ? sc::ResourceBindingPushConstantBinding : s.binding;
        return b;
    }

    void bind(sc::CompilerHLSL& compiler, const Slot& s) const {
        auto b = place<sc::HLSLResourceBinding>(s);
        b.cbv = {0, s.buffer};
        b.srv = {0, s.texture};
        b.sampler = {0, s.sampler};
        b.uav = {0, s.uav};
        compiler.add_hlsl_resource_binding(b);
    }

    void bind(sc::CompilerMSL& compiler, const Slot& s) const {
        auto b = place<sc::MSLResourceBinding>(s);
        b.msl_buffer = s.metal_buffer;
        b.msl_texture = s.metal_texture;
        b.msl_sampler = s.sampler;
        compiler.add_msl_resource_binding(b);
    }

    const Target target_;
    const Language language_;
    const ir::View& view_;
    const Edits& edits_;
    const ReadOften& often_;
};

}  // namespace

std::string cross_version() {
    return "SPIRV-Cross C API " + std::to_string(SPVC_C_API_VERSION_MAJOR) + "." + std::to_string(SPVC_C_API_VERSION_MINOR) +
           "." + std::to_string(SPVC_C_API_VERSION_PATCH);
}

std::vector<Translated> cross_translate(WordView words, const std::vector<Target>& targets, const SlotLayout& slots) {
    std::vector<Translated> out(targets.size());
    const auto refuse_all = [&](const std::string& why) {
        for (Translated& t : out) t = refused(why);
        return out;
    };
    const Result<ir::View> view = ir::read_view(words);
    if (!view) return refuse_all(view.error().message);
    const Result<Reflected> reflected = reflect_view(*view);
    if (!reflected) return refuse_all(reflected.error().message);

    const Features features = find_features(*view, *reflected);
    std::vector<size_t> todo;
    std::vector<Edits> edits(targets.size());
    for (size_t i = 0; i < targets.size(); ++i) {
        std::string why = targets[i] == Target::spirv ? "SPIR-V is not translated"
                                                      : target_limit(features, reflected->reflection.stage, targets[i]);
        if (why.empty()) {
            Result<Edits> plan = plan_edits(*view, *reflected, targets[i], slots);
            if (plan)
                edits[i] = std::move(*plan), edits[i].extensions = target_extensions(features, targets[i]);
            else
                why = plan.error().message;
        }
        if (why.empty())
            todo.push_back(i);
        else
            out[i] = refused(why);
    }
    if (todo.empty()) return out;

    sc::ParsedIR tree;
    try {
        sc::Parser parser(words.data(), words.size());
        parser.parse();
        tree = std::move(parser.get_parsed_ir());
    } catch (const std::exception& problem) {
        for (const size_t i : todo) out[i] = refused(problem.what());
        return out;
    }
    const ReadOften often = find_read_often(words);
    const bool corrects_depth = slots.rasterised == reflected->reflection.stage;
    const auto translate = [&](size_t i, auto&& copy_or_tree) {
        try {
            out[i].text = Translation(targets[i], *view, edits[i], often)
                              .run(std::forward<decltype(copy_or_tree)>(copy_or_tree), corrects_depth, slots.flat_blocks);
            // The name that SPIRV-Cross makes up for what it does not know.
            if (const size_t at = out[i].text.find("gl_BuiltIn_"); at != std::string::npos)
                out[i] =
                    refused("a built-in variable without a name in this language (SPIR-V's number " +
                            out[i].text.substr(at + 11, out[i].text.find_first_not_of("0123456789", at + 11) - at - 11) + ")");
        } catch (const std::exception& problem) {
            out[i] = refused(problem.what());
        }
    };
    const size_t last = todo.back();
    todo.pop_back();
    for (const size_t i : todo) translate(i, std::as_const(tree));
    translate(last, std::move(tree));
    return out;
}

}  // namespace kiln
