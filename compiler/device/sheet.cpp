// Every tile is drawn at three times its size and filtered down: nine samples a pixel, averaged after tone mapping so that
// highlights do not alias, in linear light before the sRGB curve.

#include "compiler/device/sheet.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "compiler/device/font.h"
#include "compiler/device/png.h"
#include "compiler/device/sheet_pick.h"
#include "compiler/device/sheet_scene.h"
#include "compiler/validate/validate_tasks.h"

namespace kiln {

namespace {

constexpr uint32_t samples = 3;  // a side
constexpr uint32_t gap = 10, label_lines = 2;
constexpr uint32_t label_height = label_lines * glyph_height + 8;

using Colour = std::array<float, 3>;  // linear light, [0, 1]

struct Picture {
    uint32_t width = 0, height = 0;
    std::vector<Colour> pixels;
    Colour& at(uint32_t x, uint32_t y) { return pixels[size_t{y} * width + x]; }
};

float as_float(uint32_t word) {
    float v;
    std::memcpy(&v, &word, 4);
    return std::isfinite(v) ? v : 0.0f;
}

float to_srgb(float v) {
    v = std::clamp(v, 0.0f, 1.0f);
    return v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1.0f / 2.4f) - 0.055f;
}
float from_srgb(float v) { return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f); }

// Scene radiance to display light. A fit of the ACES reference curve: Narkowicz 2015.
float tone_map(float v) {
    v = std::max(v, 0.0f) * 0.95f;
    return std::clamp(v * (2.51f * v + 0.03f) / (v * (2.43f * v + 0.59f) + 0.14f), 0.0f, 1.0f);
}

Colour backdrop(float y) {
    const float t = 0.035f + 0.05f * y;
    return {t * 0.85f, t * 0.95f, t * 1.15f};
}

// How one read-back is shown.
class Shown {
public:
    enum class As : uint8_t { radiance, values, motion, depth };
    Shown(const ReadBack& data, As as) : data_(data), as_(as) {
        if (as == As::radiance || as == As::values) return;
        float most = 0, least = 1e30f;
        for (size_t i = 0; i < data.words.size(); i += data.components)
            for (size_t c = 0; c < (as == As::depth ? 1u : 2u); ++c) {
                const float v = as_float(data.words[i + c]);
                if (as == As::depth && v >= 1.0f) continue;
                most = std::max(most, as == As::depth ? v : std::fabs(v));
                least = std::min(least, v);
            }
        low_ = least;
        scale_ = as == As::depth ? 1.0f / std::max(most - least, 1e-9f) : 1.0f / std::max(most, 1e-9f);
    }
    Colour pixel(size_t index) const {
        const uint32_t* w = &data_.words[index * data_.components];
        const auto channel = [&](size_t c) {
            const float v =
                data_.types.front() == BaseType::float32 ? as_float(w[c]) : static_cast<float>(static_cast<int32_t>(w[c])) / 8.0f;
            return v;
        };
        switch (as_) {
            case As::radiance:
                return {tone_map(channel(0)), tone_map(channel(1)), tone_map(channel(2))};
            case As::values:
                return {std::clamp(channel(0), 0.0f, 1.0f), std::clamp(channel(1), 0.0f, 1.0f),
                        std::clamp(channel(2), 0.0f, 1.0f)};
            case As::motion:
                return {from_srgb(0.5f + 0.45f * channel(0) * scale_), from_srgb(0.5f + 0.45f * channel(1) * scale_),
                        from_srgb(0.5f)};
            case As::depth:
                break;
        }
        const float nearness = 1.0f - (as_float(w[0]) - low_) * scale_;
        return {from_srgb(0.08f + 0.85f * nearness), from_srgb(0.08f + 0.85f * nearness), from_srgb(0.08f + 0.85f * nearness)};
    }

private:
    const ReadBack& data_;
    As as_;
    float low_ = 0, scale_ = 1;
};

// Fills a square of the picture with a filtered-down read-back.
void paint(Picture& to, uint32_t left, uint32_t top, uint32_t side, const Shown& shown, const ReadBack& depth, uint32_t from) {
    for (uint32_t y = 0; y < side; ++y)
        for (uint32_t x = 0; x < side; ++x) {
            const uint32_t x0 = x * from / side, x1 = std::max(x0 + 1, (x + 1) * from / side);
            const uint32_t y0 = y * from / side, y1 = std::max(y0 + 1, (y + 1) * from / side);
            Colour sum{};
            for (uint32_t sy = y0; sy < y1; ++sy)
                for (uint32_t sx = x0; sx < x1; ++sx) {
                    const size_t i = size_t{sy} * from + sx;
                    const Colour c = as_float(depth.words[i]) < 1.0f
                                         ? shown.pixel(i)
                                         : backdrop(static_cast<float>(sy) / static_cast<float>(from));
                    for (size_t k = 0; k < 3; ++k) sum[k] += c[k];
                }
            const float n = static_cast<float>((x1 - x0) * (y1 - y0));
            to.at(left + x, top + y) = {sum[0] / n, sum[1] / n, sum[2] / n};
        }
}

void paint_run(Picture& to, uint32_t left, uint32_t top, uint32_t side, const RunOutput& run, uint32_t from) {
    const ReadBack* depth = nullptr;
    std::vector<const ReadBack*> outputs;
    for (const ReadBack& r : run.values) {
        if (r.what == "depth") depth = &r;
        if (r.what.rfind("output ", 0) == 0) outputs.push_back(&r);
    }
    if (depth == nullptr) return;
    const auto two_channels = [](const ReadBack& r) {
        for (size_t i = 2; i < r.words.size(); i += 4)
            if (r.words[i] != 0 || r.words[i + 1] != 0) return false;
        return true;
    };
    if (outputs.empty()) return paint(to, left, top, side, Shown(*depth, Shown::As::depth), *depth, from);
    if (outputs.size() == 1) {
        const Shown::As as = two_channels(*outputs[0]) ? Shown::As::motion : Shown::As::radiance;
        return paint(to, left, top, side, Shown(*outputs[0], as), *depth, from);
    }
    const uint32_t across = outputs.size() <= 4 ? 2 : 3, part = side / across;
    for (size_t i = 0; i < outputs.size() && i < size_t{across} * across; ++i)
        paint(to, left + static_cast<uint32_t>(i % across) * part, top + static_cast<uint32_t>(i / across) * part, part,
              Shown(*outputs[i], two_channels(*outputs[i]) ? Shown::As::motion : Shown::As::values), *depth, from);
}

std::vector<std::string> wrap(const std::string& text, size_t width) {
    std::vector<std::string> out{""};
    for (size_t begin = 0; begin < text.size();) {
        const size_t end = std::min(text.find(' ', begin), text.size());
        const std::string word = text.substr(begin, end - begin);
        begin = end + 1;
        if (!out.back().empty() && out.back().size() + 1 + word.size() > width) out.emplace_back();
        out.back() += (out.back().empty() ? "" : " ") + word;
    }
    if (out.size() > label_lines) {
        out.resize(label_lines);
        out.back() = out.back().substr(0, width > 3 ? width - 3 : 0) + "...";
    }
    for (std::string& line : out) line = line.substr(0, width);
    return out;
}

void label(Picture& to, uint32_t left, uint32_t top, uint32_t width, const std::string& text, const Colour& ink) {
    const std::vector<std::string> lines = wrap(text, width / glyph_advance);
    for (size_t i = 0; i < lines.size(); ++i)
        draw_text(lines[i], [&](uint32_t x, uint32_t y) {
            const uint32_t px = left + x, py = top + static_cast<uint32_t>(i) * glyph_height + y;
            if (px < to.width && py < to.height) to.at(px, py) = ink;
        });
}

bool is_sun(const Space& space, const Digits& variant) {
    for (size_t a = 0; a < space.axes.size(); ++a) {
        const std::string& value = space.axes[a].values[variant[a]].name;
        if (value.find("direct") != std::string::npos || value.find("sun") != std::string::npos) return true;
    }
    return false;
}

std::string describe(const RunOutput& run, uint32_t side) {
    char text[160];
    std::snprintf(text, sizeof text, "%5.1f %% drawn", 100.0 * static_cast<double>(run.covered) / (double{1} * side * side));
    std::string out = text;
    for (const ReadBack& r : run.values) {
        if (r.what.rfind("output ", 0) != 0 || r.types.front() != BaseType::float32) continue;
        double sum[3] = {0, 0, 0};
        for (size_t i = 0; i < r.words.size(); i += 4)
            for (size_t c = 0; c < 3; ++c) sum[c] += static_cast<double>(as_float(r.words[i + c]));
        const double n = std::max<double>(1.0, static_cast<double>(run.covered));
        std::snprintf(text, sizeof text, ", %s mean %.4f %.4f %.4f", r.what.c_str(), sum[0] / n, sum[1] / n, sum[2] / n);
        out += text;
    }
    return out;
}

}  // namespace

Result<Sheet> render_sheet(ByteView table_bytes, const SheetOptions& options, Device& device, Toolchain& tools) {
    if (options.tile < 32 || options.tile > 1024 || options.count == 0 || options.count > 1024)
        return Error{Fault::usage, "a sheet has 1 to 1,024 tiles of 32 to 1,024 pixels"};
    Result<std::unique_ptr<TableView>> table = TableView::open(table_bytes);
    KILN_TRY(table);
    std::vector<TableShader>& shaders = (*table)->shaders();
    if (shaders.empty()) return input_error("the table has no shader");
    TableShader* shader = options.shader.empty() ? &shaders.front() : (*table)->shader(options.shader);
    if (shader == nullptr) return Error{Fault::input, "the table has no shader '" + options.shader + "'"};

    std::vector<std::pair<size_t, Digits>> chosen;
    for (const std::string& text : options.variants) {
        Result<Digits> variant = parse_variant(*shader, text);
        KILN_TRY(variant);
        chosen.push_back({pipeline_of(*shader, *variant), *variant});
        if (chosen.back().first >= shader->pipelines.size()) return input_error("no pipeline in the table draws " + text);
    }
    if (chosen.empty())
        for (const size_t i : pick_pipelines(*shader, options.count)) chosen.push_back({i, shader->pipelines[i].witness});

    const uint32_t count = static_cast<uint32_t>(chosen.size());
    const uint32_t columns = std::min(8u, count), rows = (count + columns - 1) / std::max(1u, columns);
    const uint32_t step_y = options.tile + label_height + gap;
    Picture picture;
    picture.width = gap + columns * (options.tile + gap);
    picture.height = gap + rows * step_y;
    picture.pixels.assign(size_t{picture.width} * picture.height, Colour{0.011f, 0.012f, 0.014f});

    Sheet sheet;
    TaskMaker maker(**table, nullptr, tools);
    const uint32_t side = options.tile * samples;
    for (uint32_t i = 0; i < count; ++i) {
        const auto& [index, variant] = chosen[i];
        Result<Task> task = maker.make(*shader, shader->pipelines[index]);
        KILN_TRY(task);
        PipelineRequest request;
        for (const StagePtr& s : task->job.optimised) request.stages.push_back(*s);
        request.size = side;
        request.depth_test = true;
        SheetScene scene;
        scene.directional = is_sun(shader->space, variant);
        request.inputs = {scene_inputs(request.stages, scene)};
        Result<PipelineOutput> drawn = device.run(request);
        KILN_TRY(drawn);
        const uint32_t left = gap + i % columns * (options.tile + gap), top = gap + i / columns * step_y;
        const bool good = drawn->errors.empty() && drawn->unsupported.empty() && drawn->runs.size() == 1;
        std::string line = shader->space.describe_variant(variant) + ": ";
        if (good) {
            paint_run(picture, left, top, options.tile, drawn->runs[0], side);
            line += describe(drawn->runs[0], side);
            if (drawn->runs[0].covered == 0) ++sheet.undrawn;
        } else {
            ++sheet.failed;
            line += !drawn->errors.empty()       ? drawn->errors.front()
                    : drawn->unsupported.empty() ? "nothing came back"
                                                 : drawn->unsupported;
        }
        label(picture, left, top + options.tile + 6, options.tile, short_label(shader->space, variant),
              good ? Colour{0.55f, 0.57f, 0.6f} : Colour{0.8f, 0.1f, 0.08f});
        sheet.summary += line + "\n";
        ++sheet.tiles;
    }
    Bytes rgb;
    rgb.reserve(picture.pixels.size() * 3);
    for (const Colour& c : picture.pixels)
        for (const float v : c) rgb.push_back(static_cast<uint8_t>(std::lrint(255.0f * to_srgb(v))));
    Result<Bytes> png = encode_png(rgb, picture.width, picture.height);
    KILN_TRY(png);
    sheet.png = std::move(*png);
    return sheet;
}

}  // namespace kiln
