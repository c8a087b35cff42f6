#include "compiler/report/report.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "compiler/report/flip.h"
#include "compiler/report/pareto.h"
#include "compiler/report/shown.h"

namespace kiln::report {

namespace {

constexpr unsigned repeats = 31;
constexpr double least_ms = 2.2;       // 2 and some room, since loops are chosen from one short dispatch
constexpr uint32_t timed_pixels = 64;  // few, so that a dear shader's dispatch ends within the host's time slice

Error stopped() { return environment_error("interrupted"); }

void mark_fronts(std::vector<Measured>& members) {
    for (const Metric metric : {Metric::relmse, Metric::max_rel}) {
        std::vector<Cost> costs;
        for (const Measured& m : members)
            costs.push_back({std::max(m.timing.min, time_floor), m.value(metric), m.all.nonfinite == 0});
        const std::vector<bool> front = pareto_front(costs);
        for (size_t i = 0; i < members.size(); ++i)
            (metric == Metric::relmse ? members[i].front_relmse : members[i].front_max_rel) = front[i];
    }
}

Metrics pooled(const std::vector<std::vector<Measured>>& scenes, size_t member, Metrics Measured::*which) {
    Metrics out;
    const double n = static_cast<double>(scenes.size());
    for (const std::vector<Measured>& scene : scenes) {
        const Metrics& m = scene[member].*which;
        out.relmse += m.relmse / n;
        out.rmse += m.rmse / n;
        out.flip += m.flip / n;
        out.bias += std::fabs(m.bias) / n;
        out.max_rel = std::max(out.max_rel, m.max_rel);
        out.max_abs = std::max(out.max_abs, m.max_abs);
        out.nonfinite += m.nonfinite;
    }
    return out;
}

void pool(FamilyReport& report) {
    const double n = static_cast<double>(report.scenes.size());
    for (size_t i = 0; i < report.family.members.size(); ++i) {
        Measured out;
        out.all = pooled(report.scenes, i, &Measured::all);
        out.region = pooled(report.scenes, i, &Measured::region);
        out.rest = pooled(report.scenes, i, &Measured::rest);
        out.all_noise = pooled(report.scenes, i, &Measured::all_noise);
        out.region_noise = pooled(report.scenes, i, &Measured::region_noise);
        out.rest_noise = pooled(report.scenes, i, &Measured::rest_noise);
        if (!report.family.time_every_scene) out.timing = report.scenes[report.family.timed_scene][i].timing;
        for (const std::vector<Measured>& scene : report.scenes) {
            const Measured& m = scene[i];
            out.spirv = std::max(out.spirv, m.spirv);
            out.operations = std::max(out.operations, m.operations);
            out.bytes = std::max(out.bytes, m.bytes);
            if (!report.family.time_every_scene) continue;
            out.timing.min += m.timing.min / n;
            out.timing.median += m.timing.median / n;
            out.timing.p90 += m.timing.p90 / n;
            out.timing.baseline += m.timing.baseline / n;
            out.timing.jit_ms += m.timing.jit_ms / n;
            out.timing.dispatch_ms += m.timing.dispatch_ms / n;
            out.timing.repeats = m.timing.repeats;
        }
        report.together.push_back(std::move(out));
    }
    mark_fronts(report.together);
    for (std::vector<Measured>& scene : report.scenes) mark_fronts(scene);
}

// One scene's reference and what all members share in it.
struct Prepared {
    Points points;
    Reference truth;
    std::shared_ptr<const FlipReference> flip;
};

class Runner {
public:
    Runner(Library& library, Toolchain& tools, Bench& bench, const Effort& effort)
        : library_(library), tools_(tools), bench_(bench), effort_(effort) {}

    Result<Prepared> prepare(const Family& family, const Scene& scene) {
        auto kernel = build(Job::points, family, scene.resources, scene.glsl, "");
        KILN_TRY(kernel);
        Draw draw = whole(scene);
        Prepared out;
        out.points.stride = floats_of(family.fields);
        draw.results = out.points.stride * scene.width * scene.height;
        auto values = bench_.run(*kernel, scene.resources, draw);
        KILN_TRY(values);
        out.points.values = std::move(*values);
        if (scene.reference) {
            out.truth = scene.reference(out.points, effort_);
        } else {
            const auto of = std::find_if(family.members.begin(), family.members.end(),
                                         [&](const Member& m) { return m.name == scene.truth_member; });
            if (of == family.members.end()) return environment_error("nothing says what is true");
            auto picture = draw_picture(family, static_cast<size_t>(&scene - family.scenes.data()), *of, out.points);
            KILN_TRY(picture);
            out.truth.picture = std::move(picture->picture);
        }
        if (interrupted.load()) return stopped();
        out.flip = std::make_shared<FlipReference>(out.truth.picture, effort_.jobs);
        return out;
    }

    Result<double> baseline(const Family& family, const Scene& scene) {
        auto kernel = build(Job::baseline, family, scene.resources, scene.glsl, "");
        KILN_TRY(kernel);
        Draw draw = timed(scene);
        const auto ms = bench_.time(*kernel, scene.resources, draw, repeats, least_ms);
        KILN_TRY(ms);
        return *std::min_element(ms->ms.begin(), ms->ms.end()) * 1e6 / (double{group_size} * draw.groups * draw.loops);
    }

    struct Drawn {
        Picture picture;
        std::vector<Resource> resources;
        std::string glsl;
        uint64_t bytes = 0, spirv = 0, operations = 0;
    };
    Result<Drawn> draw_picture(const Family& family, size_t scene_index, const Member& member, const Points& points) {
        const Scene& scene = family.scenes[scene_index];
        const auto named = [&](const Error& e) { return Error{e.fault, family.name + ", " + member.name + ": " + e.message}; };
        Drawn out;
        out.resources = scene.resources;
        if (member.resources) {
            auto own = member.resources(scene_index, bench_, effort_);
            if (!own.ok()) return named(own.error());
            for (Resource& r : *own) {
                out.bytes += r.bytes;
                out.resources.push_back(std::move(r));
            }
        }
        const auto extra = member.scene_glsl.find(scene.name);
        out.glsl = (extra == member.scene_glsl.end() ? "" : extra->second + "\n") + member.glsl;
        auto kernel = build(Job::picture, family, out.resources, scene.glsl, out.glsl);
        if (!kernel.ok()) return named(kernel.error());
        out.spirv = kernel->bytes;
        out.operations = kernel->operations;
        Draw draw = whole(scene);
        draw.points = &points.values;
        draw.results = size_t{3} * scene.width * scene.height;
        const auto values = bench_.run(*kernel, out.resources, draw);
        if (!values.ok()) return named(values.error());
        out.picture = Picture(scene.width, scene.height);
        for (size_t i = 0; i < out.picture.rgb.size(); ++i) out.picture.rgb[i] = static_cast<double>((*values)[i]);
        return out;
    }

    // `baseline_ns`: time it, too.
    Result<Measured> member(const Family& family, size_t scene_index, const Member& member, const Prepared& stage,
                            const double* baseline_ns) {
        const Scene& scene = family.scenes[scene_index];
        auto drawn = draw_picture(family, scene_index, member, stage.points);
        KILN_TRY(drawn);
        Measured out;
        out.bytes = drawn->bytes;
        out.spirv = drawn->spirv;
        out.operations = drawn->operations;
        const Picture& x = drawn->picture;
        const Reference& truth = stage.truth;
        out.all = measure(x, truth.picture);
        out.all.flip = mean_of(stage.flip->against(x, effort_.jobs));
        const auto noise = [&](const Metrics& measured, const std::vector<bool>& where) {
            Metrics n = noise_of(measured, truth.picture, truth.variance, where);
            if (!member.random) return n;
            const Metrics own = sampling_noise_of(measured, x, truth.picture, where);
            n.rmse += own.rmse, n.relmse += own.relmse, n.bias += own.bias;
            return n;
        };
        out.all_noise = noise(out.all, {});
        if (!truth.region.empty()) {
            out.region = measure(x, truth.picture, truth.region);
            out.region_noise = noise(out.region, truth.region);
            std::vector<bool> rest = truth.region;
            rest.flip();
            out.rest = measure(x, truth.picture, rest);
            out.rest_noise = noise(out.rest, rest);
        }
        auto picture = shown(x, truth.picture);
        KILN_TRY(picture);
        auto map = error_map(x, truth.picture);
        KILN_TRY(map);
        out.picture = std::move(*picture);
        out.error_map = std::move(*map);
        if (baseline_ns != nullptr) {
            auto loop = build(Job::timing, family, drawn->resources, scene.glsl, drawn->glsl);
            KILN_TRY(loop);
            Draw many = timed(scene);
            const auto ms = bench_.time(*loop, drawn->resources, many, repeats, least_ms);
            KILN_TRY(ms);
            out.timing = times_of(*ms, *baseline_ns, double{group_size} * many.groups * many.loops);
            out.timing.scene = scene.name;
        }
        if (interrupted.load()) return stopped();
        return out;
    }

private:
    static Draw whole(const Scene& scene) {
        Draw d;
        d.width = scene.width;
        d.height = scene.height;
        d.groups = (scene.width * scene.height + group_size - 1) / group_size;
        return d;
    }
    static Draw timed(const Scene& scene) {
        Draw d = whole(scene);
        d.groups = timed_pixels / group_size;
        d.results = timed_pixels;
        d.loops = 4;  // at least: places in the picture
        d.seed = 1;
        return d;
    }
    Result<Kernel> build(Job job, const Family& family, const std::vector<Resource>& resources, const std::string& scene,
                         const std::string& member) {
        const auto text = library_.expanded(kernel_text(job, family.fields, resources, scene, member));
        KILN_TRY(text);
        return compile_kernel(*text, tools_);
    }

    Library& library_;
    Toolchain& tools_;
    Bench& bench_;
    const Effort& effort_;
};

}  // namespace

double Measured::value(Metric metric) const {
    switch (metric) {
        case Metric::relmse:
            return all.relmse;
        case Metric::rmse:
            return all.rmse;
        case Metric::max_rel:
            return all.max_rel;
        case Metric::max_abs:
            return all.max_abs;
        case Metric::bias:
            return std::fabs(all.bias);
        case Metric::flip:
            return all.flip;
        case Metric::nonfinite:
            return static_cast<double>(all.nonfinite);
        case Metric::region_rmse:
            return region.rmse;
        case Metric::rest_rmse:
            return rest.rmse;
        case Metric::time:
            return timing.min;
        case Metric::jit:
            return timing.jit_ms;
        case Metric::bytes:
            return static_cast<double>(bytes);
        case Metric::spirv:
            return static_cast<double>(spirv);
        case Metric::operations:
            return static_cast<double>(operations);
    }
    return 0.0;
}

double Measured::noise(Metric metric) const {
    switch (metric) {
        case Metric::relmse:
            return all_noise.relmse;
        case Metric::rmse:
            return all_noise.rmse;
        case Metric::max_rel:
            return all_noise.max_rel;
        case Metric::max_abs:
            return all_noise.max_abs;
        case Metric::bias:
            return all_noise.bias;
        case Metric::region_rmse:
            return region_noise.rmse;
        case Metric::rest_rmse:
            return rest_noise.rmse;
        default:
            return 0.0;
    }
}

Timing times_of(const Timed& member, double baseline_ns, double pixels) {
    Timing out;
    std::vector<double> ms = member.ms;
    std::sort(ms.begin(), ms.end());
    if (ms.empty()) return out;
    const auto ns = [&](double one) { return one * 1e6 / pixels - baseline_ns; };
    out.min = ns(ms.front());
    out.median = ns(ms[ms.size() / 2]);
    out.p90 = ns(ms[std::min(ms.size() - 1, ms.size() * 9 / 10)]);
    out.baseline = baseline_ns;
    out.dispatch_ms = ms.front();
    out.jit_ms = member.jit_ms;
    out.repeats = static_cast<unsigned>(ms.size());
    return out;
}

Result<std::vector<Family>> chosen_families(const ReportOptions& options) {
    std::vector<Family> all = all_families(options.quick, options.bc_encoder);
    if (options.families.empty()) return all;
    std::vector<Family> out;
    std::string known;
    for (const Family& f : all) known += (known.empty() ? "" : ", ") + std::to_string(f.number) + " " + f.name;
    for (const std::string& wanted : options.families)
        if (std::none_of(all.begin(), all.end(),
                         [&](const Family& f) { return wanted == f.name || wanted == std::to_string(f.number); }))
            return Error{Fault::usage, "no family '" + wanted + "'; there is " + known};
    for (Family& f : all)
        if (std::any_of(options.families.begin(), options.families.end(),
                        [&](const std::string& w) { return w == f.name || w == std::to_string(f.number); }))
            out.push_back(std::move(f));
    return out;
}

Result<Report> run_report(const ReportOptions& options, Library& library, Toolchain& tools, Bench& bench,
                          const Progress& progress) {
    auto families = chosen_families(options);
    KILN_TRY(families);
    size_t total = 0, done = 0;
    for (const Family& f : *families) total += f.scenes.size() * (f.members.size() + 1);
    const auto step = [&] {
        if (progress) progress("measured", ++done, total);
    };
    Effort effort;
    effort.quick = options.quick;
    Runner runner(library, tools, bench, effort);
    Report out;
    out.device = bench.info();
    out.quick = options.quick;
    for (Family& family : *families) {
        FamilyReport report;
        for (size_t s = 0; s < family.scenes.size(); ++s) {
            const Scene& scene = family.scenes[s];
            auto stage = runner.prepare(family, scene);
            if (!stage.ok()) return Error{stage.error().fault, family.name + ", " + scene.name + ": " + stage.error().message};
            auto png = shown(stage->truth.picture, stage->truth.picture);
            KILN_TRY(png);
            report.references.push_back(std::move(*png));
            report.standard_errors.push_back(stage->truth.standard_error());
            const bool timed = s == family.timed_scene || !options.quick || family.time_every_scene;
            Result<double> baseline = 0.0;
            if (timed) baseline = runner.baseline(family, scene);
            KILN_TRY(baseline);
            step();
            std::vector<Measured> members;
            for (size_t i = 0; i < family.members.size(); ++i) {
                auto m = runner.member(family, s, family.members[i], *stage, timed ? &*baseline : nullptr);
                KILN_TRY(m);
                members.push_back(std::move(*m));
                step();
            }
            report.scenes.push_back(std::move(members));
        }
        for (std::vector<Measured>& scene : report.scenes)
            for (size_t i = 0; i < scene.size(); ++i)
                if (scene[i].timing.repeats == 0) scene[i].timing = report.scenes[family.timed_scene][i].timing;
        report.family = std::move(family);
        pool(report);
        for (const Expectation& e : report.family.expectations)
            report.judged.push_back(
                judge(e, [&](const std::string& member, const std::string& scene, Metric metric) -> std::optional<Known> {
                    for (size_t i = 0; i < report.family.members.size(); ++i) {
                        if (report.family.members[i].name != member) continue;
                        const auto known = [&](const Measured& m) { return Known{m.value(metric), m.noise(metric)}; };
                        if (scene.empty()) return known(report.together[i]);
                        for (size_t s = 0; s < report.family.scenes.size(); ++s)
                            if (report.family.scenes[s].name == scene) return known(report.scenes[s][i]);
                    }
                    return std::nullopt;
                }));
        if (report.family.remarks)
            report.remarks =
                report.family.remarks([&](const std::string& member, const std::string& scene) -> std::optional<double> {
                    for (size_t i = 0; i < report.family.members.size(); ++i)
                        for (size_t s = 0; s < report.family.scenes.size(); ++s)
                            if (report.family.members[i].name == member && report.family.scenes[s].name == scene)
                                return report.scenes[s][i].timing.min;
                    return std::nullopt;
                });
        out.families.push_back(std::move(report));
    }
    return out;
}

}  // namespace kiln::report
