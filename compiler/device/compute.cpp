#include "compiler/device/compute.h"

#include <algorithm>

#include "compiler/toolchain/glsl.h"
#include "compiler/toolchain/spirv.h"
#include "compiler/validate/inputs.h"
#include "compiler/validate/texels.h"

namespace kiln {

namespace {

std::string_view line_of(std::string_view text, uint32_t number) {
    for (uint32_t i = 1; i < number; ++i) {
        const size_t end = text.find('\n');
        if (end == std::string_view::npos) return {};
        text.remove_prefix(end + 1);
    }
    return text.substr(0, text.find('\n'));
}

std::string explain(const std::vector<ToolMessage>& messages, std::string_view text) {
    std::string out = "the compute shader does not compile";
    for (const ToolMessage& m : messages) {
        if (m.severity != Severity::error) continue;
        out += "\n" + (m.line != 0 ? std::to_string(m.line) + ": " : std::string()) + m.text;
        if (m.line != 0) out += "\n    " + std::string(line_of(text, m.line));
    }
    return out;
}

std::string element_name(const Binding& b, uint32_t i) { return b.name + "[" + std::to_string(i) + "]"; }

// What is given for element `i` of a binding: under "name[i]", else under "name".
template <class T>
const T* given(const std::vector<T>& list, const Binding& b, uint32_t i) {
    const std::string element = element_name(b, i);
    const T* whole = nullptr;
    for (const T& item : list) {
        if (b.descriptors > 1 && item.name == element) return &item;
        if (item.name == b.name) whole = &item;
    }
    return whole;
}

std::string shape_text(ImageDim dim, bool arrayed, bool multisampled) {
    constexpr const char* names[] = {"none", "1D", "2D", "3D", "cube", "rect", "buffer", "subpass"};
    const size_t i = static_cast<size_t>(dim);
    return std::string(i < std::size(names) ? names[i] : "?") + (multisampled ? " multisampled" : "") + (arrayed ? " array" : "");
}

Status fill_image(Binding& b, const Resource& r, const NamedImage* item) {
    const std::string named = "image '" + b.name + "' ";
    if (item == nullptr || item->image == nullptr) return input_error(named + "is not given");
    const ImageData& image = *item->image;
    if (image.dim != r.dim || image.arrayed != r.arrayed || image.multisampled != r.multisampled)
        return input_error(named + "is declared as " + shape_text(r.dim, r.arrayed, r.multisampled) + " and given as " +
                           shape_text(image.dim, image.arrayed, image.multisampled));
    if ((image.format == TexelFormat::standard ? image.base : BaseType::float32) != b.base)
        return input_error(named + "is given with texels of another type than it is declared with");
    const uint32_t faces = image.dim == ImageDim::cube ? 6 : 1;
    if (image.width == 0 || image.height == 0 || image.slices == 0 || image.mips == 0 || image.layers == 0 ||
        image.layers % faces != 0 || (!image.arrayed && image.layers != faces))
        return input_error(named + "has a size of 0 or the wrong number of layers");
    if (!image.multisampled && image.texels.size() != image_bytes(image))
        return input_error(named + "has " + std::to_string(image.texels.size()) + " bytes of " + name_of(image.format) +
                           " texels, and its size asks for " + std::to_string(image_bytes(image)));
    if (!b.images.empty() && b.sampler != item->sampler) return input_error(named + "has elements with different samplers");
    b.images.push_back(item->image);
    b.sampler = item->sampler;
    return {};
}

Status fill_buffer(Binding& b, const Resource& r, const NamedBuffer* item) {
    if (item == nullptr) return input_error("buffer '" + b.name + "' is not given");
    if (item->bytes.empty() || item->bytes.size() < r.bytes)
        return input_error("buffer '" + b.name + "' has " + std::to_string(item->bytes.size()) +
                           " bytes, and its block needs at least " + std::to_string(std::max(1u, r.bytes)));
    b.buffers.push_back(item->bytes);
    return {};
}

// A name given twice or unknown to the shader is a slip of whoever gave it.
template <class T>
Status check_names(const std::vector<T>& list, const std::vector<Binding>& bindings, const char* what, bool elements = true) {
    for (size_t i = 0; i < list.size(); ++i) {
        const auto known = [&](const Binding& b) {
            if (b.name == list[i].name) return true;
            for (uint32_t e = 0; e < b.descriptors && b.descriptors > 1 && elements; ++e)
                if (list[i].name == element_name(b, e)) return true;
            return false;
        };
        if (std::none_of(bindings.begin(), bindings.end(), known))
            return input_error(std::string("the shader has no ") + what + " '" + list[i].name + "'");
        for (size_t j = 0; j < i; ++j)
            if (list[j].name == list[i].name) return input_error(std::string(what) + " '" + list[i].name + "' is given twice");
    }
    return {};
}

Result<Inputs> inputs_of(const StageCode& stage, const ComputeData& data) {
    Inputs out;
    out.groups = data.groups;
    out.push_constants = data.push_constants;
    uint32_t push_bytes = 0;
    for (const Resource& r : stage.reflection.resources) {
        if (r.kind == ResourceKind::push_constants) {
            push_bytes = std::max(push_bytes, r.bytes);
            continue;
        }
        Binding b = bare_binding(r);
        for (uint32_t i = 0; i < b.descriptors; ++i) {
            switch (r.kind) {
                case ResourceKind::uniform_block:
                case ResourceKind::storage_block:
                    KILN_TRY(fill_buffer(b, r, given(data.buffers, b, i)));
                    break;
                case ResourceKind::combined_image:
                case ResourceKind::separate_image:
                case ResourceKind::storage_image:
                    KILN_TRY(fill_image(b, r, given(data.images, b, i)));
                    break;
                case ResourceKind::separate_sampler:
                    for (const NamedSampler& s : data.samplers)
                        if (s.name == b.name) b.sampler = s.state;
                    break;
                default:
                    return input_error("'" + r.name + "' is of a kind that cannot be given here");
            }
        }
        out.bindings.push_back(std::move(b));
    }
    if (data.push_constants.size() < push_bytes || (push_bytes == 0 && !data.push_constants.empty()))
        return input_error("there are " + std::to_string(data.push_constants.size()) +
                           " bytes of push constants, and the shader has " + std::to_string(push_bytes));
    KILN_TRY(check_names(data.buffers, out.bindings, "buffer"));
    KILN_TRY(check_names(data.images, out.bindings, "image"));
    KILN_TRY(check_names(data.samplers, out.bindings, "sampler", false));
    return out;
}

}  // namespace

ByteView ComputeResult::buffer(std::string_view name) const {
    for (const NamedBuffer& b : buffers)
        if (b.name == name) return b.bytes;
    return {};
}

const ReadBack* ComputeResult::image(std::string_view name) const {
    for (const ReadBack& i : images)
        if (i.what == name) return &i;
    return nullptr;
}

Result<StageCode> compute_stage(std::string_view glsl, Optimise optimise) {
    Options options;
    options.optimise = optimise;
    const Compiled compiled = glsl_compile(Stage::compute, glsl, options);
    if (compiled.words.empty()) return input_error(explain(compiled.messages, glsl));
    StageCode out;
    out.stage = Stage::compute;
    out.words = compiled.words;
    auto reflection = reflect_words(out.words);
    KILN_TRY(reflection);
    out.reflection = std::move(*reflection);
    if (optimise == Optimise::none) return out;
    const auto pruned = spirv_prune(out.words, options);
    KILN_TRY(pruned);
    auto words = spirv_optimise(*pruned, options);
    KILN_TRY(words);
    out.words = std::move(*words);
    return out;
}

Result<PipelineRequest> compute_request(const StageCode& stage, const std::vector<ComputeData>& runs) {
    PipelineRequest out;
    out.stages = {stage};
    if (runs.empty()) return input_error("there are no data to run with");
    for (const ComputeData& data : runs) {
        auto inputs = inputs_of(stage, data);
        KILN_TRY(inputs);
        out.inputs.push_back(std::move(*inputs));
    }
    return out;
}

ComputeResult result_of(RunOutput output) {
    ComputeResult out;
    for (ReadBack& r : output.values) {
        const std::string name = r.what.substr(std::min(r.what.find(' ') + 1, r.what.size()));
        if (r.what.rfind("buffer ", 0) == 0) {
            out.buffers.push_back({name, bytes_of(r.words)});
        } else {
            r.what = name;
            out.images.push_back(std::move(r));
        }
    }
    return out;
}

Result<std::vector<ComputeResult>> run_compute(Device& device, const StageCode& stage, const std::vector<ComputeData>& runs) {
    const auto request = compute_request(stage, runs);
    KILN_TRY(request);
    auto output = device.run(*request);
    KILN_TRY(output);
    if (!output->unsupported.empty()) return environment_error(output->unsupported);
    if (!output->errors.empty()) return input_error(output->errors.front());
    std::vector<ComputeResult> out;
    for (RunOutput& r : output->runs) out.push_back(result_of(std::move(r)));
    return out;
}

Result<ComputeResult> run_compute(Device& device, const StageCode& stage, const ComputeData& data) {
    auto all = run_compute(device, stage, std::vector<ComputeData>{data});
    KILN_TRY(all);
    return std::move(all->front());
}

uint32_t group_count(const StageCode& stage, size_t invocations) {
    const size_t local = std::max(1u, stage.reflection.workgroup[0]);
    return static_cast<uint32_t>((invocations + local - 1) / local);
}

}  // namespace kiln
