// The only file that includes SPIRV-Cross, by its C interface, which turns the library's exceptions into results. A module
// is parsed once; every target gets a copy of that tree but the last, which gets the tree itself. What is to be said to the
// library is worked out beforehand in edits.cpp.

#include "compiler/toolchain/cross.h"

#include <spirv_cross/spirv_cross_c.h>

#include <memory>

#include "compiler/reflect/spirv_enums.h"
#include "compiler/toolchain/edits.h"
#include "compiler/toolchain/limits.h"

namespace kiln {
namespace {

struct ContextEnd {
    void operator()(spvc_context_s* c) const { spvc_context_destroy(c); }
};
using Context = std::unique_ptr<spvc_context_s, ContextEnd>;

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

// One target of one module. Every step returns false after the library reported an error.
class Translation {
public:
    Translation(spvc_context context, spvc_compiler compiler, Target target, const ir::View& view)
        : context_(context), compiler_(compiler), target_(target), language_(language_of(target)), view_(view) {}

    Translated run(const Edits& edits, bool corrects_depth, bool flat_blocks) {
        if (!set_options(corrects_depth, flat_blocks) || !combine(edits)) return last_error();
        for (const char* extension : edits.extensions)
            if (!ok(spvc_compiler_require_extension(compiler_, extension))) return last_error();
        apply(edits);
        if (!bind(edits)) return last_error();
        const char* text = nullptr;
        if (!ok(spvc_compiler_compile(compiler_, &text))) return last_error();
        return {text, {}};
    }

private:
    static bool ok(spvc_result r) { return r == SPVC_SUCCESS; }
    Translated last_error() const { return refused(spvc_context_get_last_error_string(context_)); }
    bool is_gl() const { return language_ == Language::glsl || language_ == Language::essl; }

    bool set_options(bool corrects_depth, bool flat_blocks) {
        spvc_compiler_options o = nullptr;
        if (!ok(spvc_compiler_create_compiler_options(compiler_, &o))) return false;
        bool good = true;
        const auto flag = [&](spvc_compiler_option option, bool value) {
            good &= ok(spvc_compiler_options_set_bool(o, option, value ? SPVC_TRUE : SPVC_FALSE));
        };
        const auto number = [&](spvc_compiler_option option, unsigned value) {
            good &= ok(spvc_compiler_options_set_uint(o, option, value));
        };
        const unsigned version = version_of(target_);
        if (is_gl()) {
            const bool es = language_ == Language::essl;
            number(SPVC_COMPILER_OPTION_GLSL_VERSION, version);
            flag(SPVC_COMPILER_OPTION_GLSL_ES, es);
            flag(SPVC_COMPILER_OPTION_GLSL_EMIT_PUSH_CONSTANT_AS_UNIFORM_BUFFER, true);
            flag(SPVC_COMPILER_OPTION_GLSL_ENABLE_420PACK_EXTENSION, false);
            flag(SPVC_COMPILER_OPTION_FIXUP_DEPTH_CONVENTION, corrects_depth);
            // Draw calls with a base instance came with GL 4.2; before, the term would be a uniform that nobody sets.
            flag(SPVC_COMPILER_OPTION_GLSL_SUPPORT_NONZERO_BASE_INSTANCE, target_ == Target::glsl450);
            flag(SPVC_COMPILER_OPTION_GLSL_FORCE_FLATTENED_IO_BLOCKS, flat_blocks);
            // Uniforms of both stages must agree in precision, and the vertex stage's is high.
            flag(SPVC_COMPILER_OPTION_GLSL_ES_DEFAULT_FLOAT_PRECISION_HIGHP, true);
            flag(SPVC_COMPILER_OPTION_GLSL_ES_DEFAULT_INT_PRECISION_HIGHP, true);
        } else if (language_ == Language::hlsl) {
            number(SPVC_COMPILER_OPTION_HLSL_SHADER_MODEL, version);
            flag(SPVC_COMPILER_OPTION_HLSL_POINT_SIZE_COMPAT, true);
        } else {
            number(SPVC_COMPILER_OPTION_MSL_VERSION, version);
            number(SPVC_COMPILER_OPTION_MSL_PLATFORM, SPVC_MSL_PLATFORM_MACOS);
            flag(SPVC_COMPILER_OPTION_MSL_TEXTURE_BUFFER_NATIVE, true);
        }
        return good && ok(spvc_compiler_install_compiler_options(compiler_, o));
    }

    // GL has no separate samplers: every pair that is used together becomes one, named and numbered by its two slots.
    bool combine(const Edits& edits) {
        if (!is_gl() || !edits.separate) return true;
        spvc_variable_id dummy = 0;
        if (!ok(spvc_compiler_build_dummy_sampler_for_combined_images(compiler_, &dummy))) return false;
        if (!ok(spvc_compiler_build_combined_image_samplers(compiler_))) return false;
        const spvc_combined_image_sampler* pairs = nullptr;
        size_t count = 0;
        if (!ok(spvc_compiler_get_combined_image_samplers(compiler_, &pairs, &count))) return false;
        for (size_t i = 0; i < count; ++i) {
            const Slot* image = edits.slot_of(pairs[i].image_id);
            const Slot* sampler = pairs[i].sampler_id == dummy ? image : edits.slot_of(pairs[i].sampler_id);
            if (!image || !sampler) continue;
            const std::string name = image->name + "_" + (sampler == image ? std::string("fetch") : sampler->name);
            spvc_compiler_set_name(compiler_, pairs[i].combined_id, name.c_str());
            spvc_compiler_set_decoration(compiler_, pairs[i].combined_id, SpvDecorationBinding,
                                         image->texture + sampler->unit_offset);
        }
        return true;
    }

    void apply(const Edits& edits) {
        for (const auto& [id, name] : edits.names) spvc_compiler_set_name(compiler_, id, name.c_str());
        for (const Edits::MemberName& m : edits.member_names)
            spvc_compiler_set_member_name(compiler_, m.type, m.member, m.name.c_str());
        if (!is_gl()) return;
        // Promises about the direction in which depth moves; GLSL before 4.20 and ESSL have no words for them, and need none.
        if (target_ != Target::glsl450)
            for (const auto mode : {SpvExecutionModeDepthGreater, SpvExecutionModeDepthLess, SpvExecutionModeDepthUnchanged})
                spvc_compiler_unset_execution_mode(compiler_, mode);
        // ESSL has one blend source and so no word for the first; modules with a second are refused.
        if (language_ == Language::essl)
            for (const ir::Variable& v : view_.variables)
                if (v.storage == ir::sc_output) spvc_compiler_unset_decoration(compiler_, v.id, SpvDecorationIndex);
        for (const Edits::Interpolate& i : edits.interpolate) interpolate(i);
        for (const auto decoration : {SpvDecorationLocation, SpvDecorationComponent}) {
            if (edits.unplaced.empty()) break;
            for (const uint32_t id : edits.unplaced) spvc_compiler_unset_decoration(compiler_, id, decoration);
            for (const Edits::MemberName& m : edits.member_names)
                spvc_compiler_unset_member_decoration(compiler_, m.type, m.member, decoration);
        }
        for (const auto& [id, number] : edits.bindings) {
            spvc_compiler_unset_decoration(compiler_, id, SpvDecorationDescriptorSet);
            spvc_compiler_set_decoration(compiler_, id, SpvDecorationBinding, number);
        }
    }

    void interpolate(const Edits::Interpolate& i) {
        const std::pair<SpvDecoration, bool> all[] = {
            {SpvDecorationFlat, i.how.flat},
            {SpvDecorationNoPerspective, i.how.no_perspective && language_ == Language::glsl},
            {SpvDecorationCentroid, i.how.centroid},
            {SpvDecorationSample, i.how.sample && target_ == Target::glsl450}};
        for (const auto& [decoration, wanted] : all) {
            if (i.is_member && wanted) spvc_compiler_set_member_decoration(compiler_, i.id, i.member, decoration, 1);
            if (i.is_member && !wanted) spvc_compiler_unset_member_decoration(compiler_, i.id, i.member, decoration);
            if (!i.is_member && wanted) spvc_compiler_set_decoration(compiler_, i.id, decoration, 1);
            if (!i.is_member && !wanted) spvc_compiler_unset_decoration(compiler_, i.id, decoration);
        }
    }

    bool bind(const Edits& edits) {
        bool good = true;
        const auto model = static_cast<SpvExecutionModel>(view_.model);
        for (const Slot& s : edits.slots) {
            const bool push = s.kind == ResourceKind::push_constants;
            if (language_ == Language::hlsl) {
                spvc_hlsl_resource_binding b;
                spvc_hlsl_resource_binding_init(&b);
                b.stage = model;
                b.desc_set = push ? SPVC_HLSL_PUSH_CONSTANT_DESC_SET : s.set;
                b.binding = push ? SPVC_HLSL_PUSH_CONSTANT_BINDING : s.binding;
                b.cbv = {0, s.buffer};
                b.srv = {0, s.texture};
                b.sampler = {0, s.sampler};
                b.uav = {0, s.uav};
                good &= ok(spvc_compiler_hlsl_add_resource_binding(compiler_, &b));
            } else if (language_ == Language::msl) {
                spvc_msl_resource_binding b;
                spvc_msl_resource_binding_init(&b);
                b.stage = model;
                b.desc_set = push ? SPVC_MSL_PUSH_CONSTANT_DESC_SET : s.set;
                b.binding = push ? SPVC_MSL_PUSH_CONSTANT_BINDING : s.binding;
                b.msl_buffer = s.metal_buffer;
                b.msl_texture = s.metal_texture;
                b.msl_sampler = s.sampler;
                good &= ok(spvc_compiler_msl_add_resource_binding(compiler_, &b));
            }
        }
        return good;
    }

    spvc_context context_;
    spvc_compiler compiler_;
    Target target_;
    Language language_;
    const ir::View& view_;
};

spvc_backend backend_of(Target target) {
    switch (language_of(target)) {
        case Language::hlsl:
            return SPVC_BACKEND_HLSL;
        case Language::msl:
            return SPVC_BACKEND_MSL;
        default:
            return SPVC_BACKEND_GLSL;
    }
}

}  // namespace

std::string cross_version() {
    unsigned major = 0, minor = 0, patch = 0;
    spvc_get_version(&major, &minor, &patch);
    return "SPIRV-Cross C API " + std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(patch);
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

    spvc_context raw = nullptr;
    if (spvc_context_create(&raw) != SPVC_SUCCESS) return refuse_all("SPIRV-Cross: out of memory");
    const Context context(raw);
    for (const size_t i : todo) {
        spvc_parsed_ir tree = nullptr;
        spvc_compiler compiler = nullptr;
        if (spvc_context_parse_spirv(raw, words.data(), words.size(), &tree) != SPVC_SUCCESS ||
            spvc_context_create_compiler(raw, backend_of(targets[i]), tree, SPVC_CAPTURE_MODE_TAKE_OWNERSHIP, &compiler) !=
                SPVC_SUCCESS)
            out[i] = refused(spvc_context_get_last_error_string(raw));
        else
            out[i] = Translation(raw, compiler, targets[i], *view)
                         .run(edits[i], slots.rasterised == reflected->reflection.stage, slots.flat_blocks);
        spvc_context_release_allocations(raw);
    }
    return out;
}

}  // namespace kiln
