#pragma once
// A compute shader run from its GLSL text: data go in by name, and what it wrote comes out by name. For function tests and
// measurements. Nothing is kept between calls; the Device passed in does all the keeping.
//
//   Result<StageCode> stage = compute_stage(text);                       // compiled once
//   ComputeData data;
//   data.buffers = {{"In", bytes_of(xs)}, {"Out", Bytes(xs.size() * 4)}};  // by block name
//   data.groups = {group_count(*stage, xs.size()), 1, 1};
//   Result<ComputeResult> result = run_compute(device, *stage, data);
//   std::vector<float> ys = values_of<float>(result->buffer("Out"));

#include <cstring>
#include <span>
#include <string_view>

#include "compiler/manifest/manifest.h"
#include "compiler/validate/device.h"

namespace kiln {

// Elements of an array of buffers or images go by "name[2]"; without such, all get what is given for "name". The elements of one
// array share their sampler.
struct NamedBuffer {
    std::string name;  // of the block, not of its instance
    Bytes bytes;
};
struct NamedImage {
    std::string name;
    std::shared_ptr<const ImageData> image;  // the same pointer is uploaded once, however often it is run with
    std::optional<SamplerState> sampler;     // of combined images; see Binding::sampler
};
struct NamedSampler {
    std::string name;
    SamplerState state;
};

struct ComputeData {
    std::vector<NamedBuffer> buffers;    // every storage and uniform block
    std::vector<NamedImage> images;      // every combined, separate and storage image
    std::vector<NamedSampler> samplers;  // separate samplers that are not to be the usual ones (Binding::sampler)
    Bytes push_constants;
    std::array<uint32_t, 3> groups{1, 1, 1};
};

struct ComputeResult {
    std::vector<NamedBuffer> buffers;              // storage blocks that are not readonly, as the run left them; by set, binding
    std::vector<ReadBack> images;                  // storage images likewise, mip 0, `what` being the name alone
    ByteView buffer(std::string_view name) const;  // empty when there is none
    const ReadBack* image(std::string_view name) const;
};

// Compiles a whole text: it starts with #version, and #include lines are resolved already. An input Error carries every message
// with the line it is about. The reflection is that of the unoptimised module, so that a buffer which nothing uses can be given.
Result<StageCode> compute_stage(std::string_view glsl, Optimise optimise = Optimise::none);

// For Device::run and Device::time. An input Error names what is missing, unknown, too small or of another shape.
Result<PipelineRequest> compute_request(const StageCode& stage, const std::vector<ComputeData>& runs);
ComputeResult result_of(RunOutput output);

// Where the device objects or cannot run this, an Error says so.
Result<ComputeResult> run_compute(Device& device, const StageCode& stage, const ComputeData& data);
Result<std::vector<ComputeResult>> run_compute(Device& device, const StageCode& stage, const std::vector<ComputeData>& runs);

// Workgroups that give at least so many invocations along x.
uint32_t group_count(const StageCode& stage, size_t invocations);

template <class T>
Bytes bytes_of(std::span<const T> values) {
    Bytes out(values.size_bytes());
    if (!out.empty()) std::memcpy(out.data(), values.data(), out.size());
    return out;
}
template <class T>
Bytes bytes_of(const std::vector<T>& values) {
    return bytes_of(std::span<const T>(values));
}
template <class T>
std::vector<T> values_of(ByteView bytes) {
    std::vector<T> out(bytes.size() / sizeof(T));
    if (!out.empty()) std::memcpy(out.data(), bytes.data(), out.size() * sizeof(T));
    return out;
}

}  // namespace kiln
