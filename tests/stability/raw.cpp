#include "tests/stability/raw.h"

#include <cmath>
#include <set>
#include <sstream>

#include "tests/functions/library_run.h"
#include "tests/stability/watch.h"

namespace kiln::test {

namespace {

const char* const shapes = R"(
vec4 wide(float a) { return vec4(a); }
vec4 wide(vec2 a) { return a.xyyy; }
vec4 wide(vec3 a) { return a.xyzz; }
vec4 wide(vec4 a) { return a; }
)";

// Expression k of sample i is at results[k * samples + i].
std::string text(const Shader& shader, size_t samples, const std::vector<Expression>& expressions, bool watched) {
    std::set<std::string> seen;
    std::string out = shader.extensions + "layout(local_size_x = 16) in;\n" +
                      "layout(set = 0, binding = 0) readonly buffer In { float inputs[]; };\n" +
                      "layout(set = 0, binding = 1) buffer Out { vec4 results[]; };\n" +
                      "layout(set = 0, binding = 2) buffer Hidden { uint hidden[]; };\n" + (watched ? watching : "");
    for (const std::string& file : shader.files) out += library(file, seen);
    int binding = 3;
    for (const auto& [declaration, image] : shader.textures)
        out += "layout(set = 0, binding = " + std::to_string(binding++) + ") uniform " + declaration + ";\n";
    out += shapes + std::string("float x[12];\nvec2 u2(int i) { return vec2(x[i], x[i + 1]); }\n") +
           "vec3 u3(int i) { return vec3(x[i], x[i + 1], x[i + 2]); }\n" + shader.declared;
    for (size_t k = 0; k < expressions.size(); ++k) {
        const std::string& e = expressions[k].glsl;
        out += "vec4 expression_" + std::to_string(k) + "() {\n    vec4 result = vec4(0.0);\n    " +
               (e.find(';') == std::string::npos ? "result = wide(" + e + ");" : e) + "\n    return result;\n}\n";
    }
    out += "void main() {\n    const uint i = gl_GlobalInvocationID.x;\n    if (i >= " + std::to_string(samples) +
           "u) return;\n    for (int c = 0; c < 12; ++c) x[c] = inputs[12u * i + uint(c)];\n";
    for (size_t k = 0; k < expressions.size(); ++k) {
        const std::string at = "[" + std::to_string(k * samples) + "u + i]";
        out += (watched ? "    watched_non_finite = 0;\n" : "") + std::string("    results") + at + " = expression_" +
               std::to_string(k) + "();\n    hidden" + at + " = " + (watched ? "uint(watched_non_finite)" : "0u") + ";\n";
    }
    return out + "}\n";
}

ComputeResult run(const std::string& glsl, Optimise optimise, const ComputeData& data) {
    const Result<StageCode> stage = compute_stage("#version 450\n" + glsl, optimise);
    EXPECT_TRUE(stage.ok()) << (stage.ok() ? "" : stage.error().message);
    if (!stage.ok()) return {};
    Result<ComputeResult> out = run_compute(device(), *stage, data);
    EXPECT_TRUE(out.ok()) << (out.ok() ? "" : out.error().message);
    return out.ok() ? std::move(*out) : ComputeResult();
}

}  // namespace

std::vector<Raw> raw(const Shader& shader, const std::vector<Sample>& samples, const std::vector<Expression>& expressions) {
    const size_t n = samples.size(), all = n * expressions.size();
    ComputeData data;
    data.buffers = {{"In", bytes_of(samples)}, {"Out", Bytes(all * sizeof(Texel))}, {"Hidden", Bytes(all * 4)}};
    for (const auto& texture : shader.textures) data.images.push_back(texture.second);
    data.groups[0] = static_cast<uint32_t>((n + 15) / 16);
    std::vector<uint32_t> hidden =
        values_of<uint32_t>(run(text(shader, n, expressions, true), Optimise::none, data).buffer("Hidden"));
    hidden.resize(all);
    std::vector<Raw> out;
    for (const auto& [optimise, how] : {std::pair{Optimise::none, "unoptimised"}, {Optimise::performance, "optimised"}}) {
        std::vector<Texel> values = values_of<Texel>(run(text(shader, n, expressions, false), optimise, data).buffer("Out"));
        values.resize(all);
        for (size_t k = 0; k < expressions.size(); ++k) {
            const auto part = [&](auto& v) {
                const auto first = v.begin() + static_cast<std::ptrdiff_t>(k * n);
                return std::decay_t<decltype(v)>(first, first + static_cast<std::ptrdiff_t>(n));
            };
            out.push_back({expressions[k].name + ", " + how, part(values), part(hidden)});
        }
    }
    return out;
}

size_t Raw::non_finite() const {
    size_t n = 0;
    for (const Texel& t : values)
        n += std::isfinite(t[0]) && std::isfinite(t[1]) && std::isfinite(t[2]) && std::isfinite(t[3]) ? 0 : 1;
    return n;
}

size_t Raw::hiding() const {
    size_t n = 0;
    for (const uint32_t h : hidden) n += h > 0 ? 1 : 0;
    return n;
}

std::string text_of(const Sample& s) {
    std::ostringstream out;
    for (const float x : s) out << (out.tellp() > 0 ? ", " : "(") << x;
    return out.str() + ")";
}

void expect_finite(const Raw& r, const std::vector<Sample>& samples) {
    expect_each(
        r, samples,
        [](const Raw& q, size_t i) {
            return std::isfinite(q.values[i][0]) && std::isfinite(q.values[i][1]) && std::isfinite(q.values[i][2]) &&
                   std::isfinite(q.values[i][3]);
        },
        "not finite");
    expect_each(
        r, samples, [](const Raw& q, size_t i) { return q.hidden[i] == 0; }, "not finite before a clamp, min or max");
}

std::vector<float> neighbourhood(const std::vector<float>& values) {
    std::vector<float> out;
    std::mt19937 random(4);
    for (size_t i = 0; i < values.size(); ++i) {
        out.insert(out.end(), {values[i], std::nextafter(values[i], -largest_float), std::nextafter(values[i], largest_float)});
        if (i + 1 < values.size())
            for (int k = 0; k < 3; ++k)
                out.push_back(std::uniform_real_distribution<float>(std::min(values[i], values[i + 1]),
                                                                    std::max(values[i], values[i + 1]))(random));
    }
    return out;
}

std::vector<Sample> grid(const std::vector<std::vector<float>>& columns) {
    std::vector<Sample> out{Sample{}};
    for (size_t c = 0; c < columns.size(); ++c) {
        std::vector<Sample> next;
        for (const Sample& s : out)
            for (const float v : columns[c]) {
                next.push_back(s);
                next.back()[c] = v;
            }
        out = std::move(next);
    }
    return out;
}

std::array<double, 3> Directions::unit() {
    std::normal_distribution<double> normal;
    std::array<double, 3> v{normal(random_), normal(random_), normal(random_)};
    const double size = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (double& c : v) c /= size;
    return v;
}

std::array<double, 3> Directions::tilted(const std::array<double, 3>& n, double angle) {
    std::array<double, 3> t = unit(), out{};
    const double along = t[0] * n[0] + t[1] * n[1] + t[2] * n[2];
    double size = 0;
    for (size_t c = 0; c < 3; ++c) t[c] -= along * n[c], size += t[c] * t[c];
    for (size_t c = 0; c < 3; ++c) out[c] = std::cos(angle) * n[c] + std::sin(angle) * t[c] / std::sqrt(size);
    return out;
}

double Directions::uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }

void put(Sample& s, size_t at, const std::array<double, 3>& v) {
    for (size_t c = 0; c < 3; ++c) s[at + c] = static_cast<float>(v[c]);
}

std::array<double, 3> get(const Sample& s, size_t at) {
    return {static_cast<double>(s[at]), static_cast<double>(s[at + 1]), static_cast<double>(s[at + 2])};
}

}  // namespace kiln::test
