#pragma once
// A family: ways of computing one thing, from cheap to dear, the scenes they are judged on, what is true there, and what we
// expected before measuring. All of it is data; compiler/report/families/ has one file a family.
//
// A member is GLSL over the functions of uber/lib:
//     vec3 shade(Point p)
// where Point is a struct of the family's fields. A scene's text gives the points that it asks about:
//     Point point_at(vec2 u)          u in [0, 1)^2: where in the scene's picture
// One invocation shades one point. For the picture, points are computed once, on the device, and members and reference read
// the same rounded numbers; for timing, a loop computes points as it goes.

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "compiler/base/jobs.h"
#include "compiler/report/expectation.h"
#include "compiler/report/picture.h"
#include "compiler/validate/device.h"
#include "uber/reference/numbers.h"

namespace kiln::report {

using Vec3d = reference::Vec3<double>;

struct Field {
    std::string type;  // float, vec2, vec3, vec4
    std::string name;
};

// Something that a shader reads: declared in GLSL without its layout, bound as `binding` says but for set and number.
struct Resource {
    std::string declaration;  // "uniform sampler2D lut", "readonly buffer Lut { float lut[]; }"
    Binding binding;
    uint64_t bytes = 0;  // in the format that it is stored in
};

// The points of a picture as the device computed them: `stride` floats each, fields in their order.
struct Points {
    size_t stride = 0;
    std::vector<float> values;
    size_t count() const { return stride == 0 ? 0 : values.size() / stride; }
    const float* at(size_t i) const { return values.data() + i * stride; }
    double scalar(size_t i, size_t offset) const { return static_cast<double>(at(i)[offset]); }
    Vec3d vector(size_t i, size_t offset) const { return {scalar(i, offset), scalar(i, offset + 1), scalar(i, offset + 2)}; }
};

struct Effort {
    bool quick = false;
    Jobs jobs{0};
};

struct Reference {
    Picture picture;
    std::vector<double> variance;   // of every number of the picture, where Monte Carlo found it; else empty
    std::vector<bool> region;       // a part judged by itself: a flag a pixel, or empty
    double standard_error() const;  // RMS over the picture, relative to its mean
};

struct Scene {
    std::string name, what;
    uint32_t width = 64, height = 64;
    std::string glsl = {};
    std::vector<Resource> resources;
    std::string truth;  // in words: closed form, quadrature …
    std::function<Reference(const Points&, const Effort&)> reference;
    std::string truth_member;  // in place of `reference`: this member's picture
};

// Runs compute shaders for whoever bakes a map; bench.h has the real one.
class Bench;

struct Member {
    std::string name, what;
    std::string glsl = {};
    bool random = false;  // other directions or places in every pixel: its picture is noisy
    std::function<Result<std::vector<Resource>>(size_t scene, Bench& bench, const Effort& effort)> resources = {};
    std::map<std::string, std::string> scene_glsl = {};  // by scene: put before `glsl`
};

// Least ns a pixel of a member in a scene, by their names.
using TimeOf = std::function<std::optional<double>(const std::string& member, const std::string& scene)>;

struct Family {
    unsigned number = 0;
    std::string name, title, what;
    std::vector<Field> fields;
    std::vector<Scene> scenes;
    std::vector<Member> members;
    Metric primary = Metric::relmse;
    // The scene whose time stands for all of them, and the only one that is timed when quick; unless what is shaded decides the
    // time: then every scene is timed, and their mean stands for all.
    size_t timed_scene = 0;
    bool time_every_scene = false;
    std::string region;  // what the scenes' region is, in words
    std::vector<Expectation> expectations;
    // Further sentences that follow from the times: one a line.
    std::function<std::vector<std::string>(const TimeOf& ns)> remarks;
};

// Marks the members of these prefixes as random.
void mark_random(Family& family, const std::vector<std::string>& prefixes);

// A closed form a pixel, spread over the effort's threads.
Reference per_point(const Points& points, uint32_t width, uint32_t height, const Effort& effort,
                    const std::function<Vec3d(size_t point)>& value);

// Built-in families in the order of their numbers. `quick` makes smaller scenes and leaves out the dearest members.
// `bc_encoder`: as in ReportOptions.
std::vector<Family> all_families(bool quick, const std::string& bc_encoder);

}  // namespace kiln::report
