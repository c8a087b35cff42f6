#pragma once
// What GLSL expressions over uber/lib give on the device, as they are: read back without a clamp, since clamp, min and max
// turn a NaN into a number here (and may elsewhere). Every expression runs as glslang gives it and after kiln's optimiser, and
// a third time with every argument of clamp, min and max looked at: how many of them were not finite.

#include <limits>
#include <random>

#include "tests/device/fetch.h"

namespace kiln::test {

// The inputs of one invocation: x[0] to x[11] in the expressions, u2(i), u3(i) the vectors from x[i] on.
using Sample = std::array<float, 12>;

struct Expression {
    std::string name;
    std::string glsl;  // a float, vec2, vec3 or vec4; with a `;` statements that assign the vec4 `result`
};

struct Raw {
    std::string name;              // of the expression, and how it was compiled
    std::vector<Texel> values;     // one a sample; components that the expression has not repeat its last one
    std::vector<uint32_t> hidden;  // arguments of clamp, min and max that were not finite, of the third run

    double at(size_t sample, size_t component = 0) const { return static_cast<double>(values[sample][component]); }
    size_t non_finite() const;  // samples
    size_t hiding() const;      // samples with a count above 0
};

struct Shader {
    std::vector<std::string> files;                            // below uber/lib
    std::string declared;                                      // GLSL after them
    std::string extensions;                                    // lines before everything
    std::vector<std::pair<std::string, NamedImage>> textures;  // declaration such as "sampler2D map"; the image's name is its
};

// Two a given expression: unoptimised, optimised.
std::vector<Raw> raw(const Shader& shader, const std::vector<Sample>& samples, const std::vector<Expression>& expressions);

// No value is infinite or not a number, and none was on the way into a clamp, min or max.
void expect_finite(const Raw& r, const std::vector<Sample>& samples);

// `holds(raw, i)` for every sample; says where it does not.
template <class F>
void expect_each(const Raw& r, const std::vector<Sample>& samples, F holds, const char* what);

std::string text_of(const Sample& s);

template <class F>
void expect_each(const Raw& r, const std::vector<Sample>& samples, F holds, const char* what) {
    size_t wrong = 0;
    std::string first;
    for (size_t i = 0; i < r.values.size(); ++i)
        if (!holds(r, i)) {
            if (wrong++ == 0)
                first = text_of(samples[i]) + " gives " + std::to_string(r.values[i][0]) + " " + std::to_string(r.values[i][1]) +
                        " " + std::to_string(r.values[i][2]);
        }
    EXPECT_EQ(wrong, 0u) << r.name << " of " << r.values.size() << ": " << what << "; " << first;
}

// Samples: a column of values, each with the floats beside it, and random ones between neighbours.
std::vector<float> neighbourhood(const std::vector<float>& values);
// All combinations.
std::vector<Sample> grid(const std::vector<std::vector<float>>& columns);

// Random unit vectors and frames, from one fixed seed a Directions.
class Directions {
public:
    explicit Directions(uint32_t seed) : random_(seed) {}
    std::array<double, 3> unit();
    // At the angle from n, in a random plane.
    std::array<double, 3> tilted(const std::array<double, 3>& n, double angle);
    double uniform(double low, double high);

private:
    std::mt19937 random_;
};
void put(Sample& s, size_t at, const std::array<double, 3>& v);
std::array<double, 3> get(const Sample& s, size_t at);

inline constexpr float largest_float = std::numeric_limits<float>::max();

}  // namespace kiln::test
