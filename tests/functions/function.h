#pragma once
// Tests of uber/lib functions on the device: each is evaluated by a generated compute shader on tens of thousands of
// arguments and compared with its reference in double, within a bound that follows from Vulkan's precision rules
// (uber/reference/bounded.h) and not from what this driver gives. A test file reads
//
//     #include "tests/functions/function.h"
//     #include "uber/reference/ggx.h"
//
//     namespace kiln::test {
//     namespace {
//
//     using namespace reference;
//
//     TEST(Functions, Ggx) {                       // one gtest a file of uber/lib: all its functions share one shader
//         Functions ggx("ggx.glsl");               // or ("a.glsl", "b.glsl")
//         ggx.test("ggx_visibility(n_dot_l, n_dot_v, alpha)",
//                  [](auto n_dot_l, auto n_dot_v, auto alpha) { return ggx_visibility(n_dot_l, n_dot_v, alpha); },
//                  number("n_dot_l", linear(0, 1)), number("n_dot_v", linear(1e-4, 1)), number("alpha", linear(0.002, 1)));
//         ggx.run();
//     }
//
// The call is GLSL over the names of the arguments; the reference takes them in the order of the list, over any T. A call
// that holds a `;` is a block of statements that assigns `result`, for functions with `out` parameters, structures or
// results that are no floats: "vec3 t, b; basis(n, t, b); result = mat3(t, b, n);". A result is a float, vec2, vec3, vec4,
// mat3, mat4 or an array of one (std::array in the reference). Domains: arguments.h; a later argument may depend on an
// earlier one, such as near("h", "n", 8, "alpha").
//
// The samples: a lattice, random points from a fixed seed, and combinations of the arguments' extremes, together about
// 40,000. The shader is compiled twice, as glslang gives it and after kiln's optimiser.
//
// A sample passes when the device's value is finite and within reassociation_margin x Bounded's error of the reference. It
// is *undecided* when it fails, but a comparison on the way was too close to call: at most 1 % of the samples may be. It is
// *unbounded* when no bound holds, so that nothing was compared but that it is finite: at most 1 % as well.
//
//     .exactly(f)        compare with f (double only) and take the bound from the reference: where the GLSL computes a
//                        rewritten form, the reference given to test() follows it and f is the textbook form
//     .truth(f, r, a)    the model: |reference - f| <= r |f| + a for every sample, and reported; f in double only, r and a
//                        stated by theory
//     .skip(f)           samples for which f (double) is true lie outside the function's declared range
//     .undecided(share), .unbounded(share)   other limits, with the reason beside them
//     .named(name)       the name in reports; else what stands before the first parenthesis of the call
//
// Textures: Functions::texture binds one that all calls of the file see under its name; the reference's lambda captures a
// callable that stands for it.
//
// One line a function goes to standard output, for people and for tools/function_table.py, which makes a table of them in
// uber/README.md:
//
//     KILN_FUNCTION <name> <worst absolute> <worst relative> <worst ulp> <share of the bound> key=value...
//
// Relative errors and ulps are of the result's largest component, over the samples without a close decision whose
// bound is under 1 % of it: elsewhere the arguments leave fewer than seven bits, and the absolute error and the share of the
// bound are what tells.

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <tuple>

#include "compiler/device/compute.h"
#include "tests/functions/arguments.h"

namespace kiln::test {

template <class T>
using Evaluation = std::function<void(const uint32_t* words, T* result)>;

// One function under test, its types erased.
struct FunctionTest {
    struct Slot {
        std::string name, glsl, read;
        uint32_t first = 0, words = 0;
        Domain domain;
    };
    std::string name, call;
    std::vector<Slot> arguments;
    uint32_t words = 0;  // of all arguments
    ResultShape result;
    Evaluation<double> reference;
    Evaluation<float> single;
    Evaluation<reference::Bounded> bounded;
    Evaluation<double> exact, truth;  // may be empty
    std::function<bool(const uint32_t* words)> skip;
    double truth_relative = 0, truth_absolute = 0;
    double undecided_share = 0.01, unbounded_share = 0.01;
};

// What the samples of one function showed, worst over both compilations.
struct Figures {
    std::string name;
    uint64_t samples = 0, mismatches = 0, undecided = 0, unbounded = 0;
    double absolute = 0, relative = 0, ulps = 0, share = 0;  // device against the reference
    double rounding_ulps = 0;                                // the reference in float against double
    double implementation_ulps = 0;                          // the device against the reference in float
    double model_relative = 0;                               // the reference against the truth
    double typical_bound_ulps = 0;                           // median
    std::string worst;                                       // the sample that came nearest to its bound
};

template <class... Shapes>
class TypedFunction {
public:
    explicit TypedFunction(FunctionTest& function) : function_(function) {}
    TypedFunction& named(std::string name) { return function_.name = std::move(name), *this; }
    TypedFunction& undecided(double share) { return function_.undecided_share = share, *this; }
    TypedFunction& unbounded(double share) { return function_.unbounded_share = share, *this; }
    template <class F>
    TypedFunction& exactly(F f) {
        return function_.exact = evaluation<double>(f), *this;
    }
    template <class F>
    TypedFunction& truth(F f, double relative, double absolute = 0) {
        function_.truth = evaluation<double>(f);
        function_.truth_relative = relative, function_.truth_absolute = absolute;
        return *this;
    }
    template <class F>
    TypedFunction& skip(F f) {
        function_.skip = [f](const uint32_t* words) { return std::apply(f, arguments<double>(words)); };
        return *this;
    }

    template <class T, class F>
    static Evaluation<T> evaluation(F f) {
        return [f](const uint32_t* words, T* result) { flatten(std::apply(f, arguments<T>(words)), result); };
    }

private:
    template <class T>
    static auto arguments(const uint32_t* words) {
        return std::tuple<typename Shapes::template type<T>...>{Shapes::template load<T>(words)...};
    }
    FunctionTest& function_;
};

class Functions {
public:
    template <class... Files>
    explicit Functions(Files... files) : files_{std::string(files)...} {}

    // GLSL that stands after the included files: constants, structures, a wrapper.
    void declare(std::string glsl) { declared_ += std::move(glsl) + "\n"; }
    // "sampler2DShadow map". Without a state: linear with linear mips and repeat, or, to compare, linear, clamp and
    // LESS_OR_EQUAL.
    void texture(const std::string& declaration, std::shared_ptr<const ImageData> image,
                 std::optional<SamplerState> sampler = {});

    template <class F, class... Shapes>
    TypedFunction<Shapes...> test(std::string call, F reference, Argument<Shapes>... arguments) {
        using Typed = TypedFunction<Shapes...>;
        using Result = std::decay_t<std::invoke_result_t<F, typename Shapes::template type<double>...>>;
        FunctionTest& f = *tests_.emplace_back(std::make_unique<FunctionTest>());
        f.name = call.substr(0, call.find('('));
        f.call = std::move(call);
        f.result = ResultOf<Result>::shape();
        f.reference = Typed::template evaluation<double>(reference);
        f.single = Typed::template evaluation<float>(reference);
        f.bounded = Typed::template evaluation<kiln::reference::Bounded>(reference);
        (add(f, arguments), ...);
        return Typed(f);
    }

    // Runs everything; every breach is a failure of the current test. Under --costs (costs.h): measures, and gives nothing back.
    std::vector<Figures> run();
    // The same, with the breaches in `breaches`. For the harness's own tests.
    std::vector<Figures> evaluate(std::vector<std::string>& breaches);

    std::string shader() const;  // the generated text

private:
    std::string prelude() const;  // what stands before the harness's own text
    void measure() const;
    template <class Shape>
    static void add(FunctionTest& f, const Argument<Shape>& argument) {
        f.arguments.push_back({argument.name, Shape::glsl(), Shape::read(f.words), f.words, Shape::words, argument.domain});
        f.words += Shape::words;
    }

    std::vector<std::string> files_;
    std::string declared_, textures_;
    std::vector<NamedImage> images_;
    std::vector<bool> comparing_;
    std::vector<std::unique_ptr<FunctionTest>> tests_;
};

}  // namespace kiln::test
