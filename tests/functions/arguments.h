#pragma once
// Where the arguments of a function under test come from. Every domain maps points of a unit cube to values, so that a
// lattice and random points cover it alike, and lists extremes: its ends, the floats beside them, zeros, denormals.

#include <functional>
#include <initializer_list>
#include <map>
#include <string>
#include <vector>

#include "tests/functions/shapes.h"

namespace kiln::test {

// The arguments of one sample that are made already.
class Known {
public:
    Known(const std::map<std::string, uint32_t>& places, const uint32_t* words) : places_(places), words_(words) {}
    double number(const std::string& name) const { return from_word<double>(*at(name)); }
    reference::Vec3<double> vector3(const std::string& name) const {
        const uint32_t* w = at(name);
        return Vector<3>::load<double>(w);
    }

private:
    const uint32_t* at(const std::string& name) const;
    const std::map<std::string, uint32_t>& places_;
    const uint32_t* words_;
};

struct Domain {
    uint32_t dimensions = 0;                                                               // of the cube
    std::function<void(const double* point, const Known& known, uint32_t* words)> inside;  // point: each in [0, 1]
    uint32_t extremes = 0;
    std::function<void(uint32_t which, const Known& known, uint32_t* words)> extreme;
};

template <class Shape>
struct Argument {
    std::string name;  // as the call says it
    Domain domain;
};

// Numbers of one kind, for number() and the vectors.
struct Range {
    std::function<float(double)> inside;
    std::vector<float> extremes;
    // Boundaries of branches and the like, each with the floats beside it that are in the range.
    Range also(std::initializer_list<double> more) const;
    // Exactly these, in the range or not.
    Range with(std::initializer_list<double> more) const;
    float low = 0, high = 0;
};
Range linear(double low, double high);       // evenly spread
Range logarithmic(double low, double high);  // low > 0; evenly spread in the logarithm
Range either_sign(double low, double high);  // +- logarithmic, and 0
Range finite();                              // any float that is no infinity and no NaN
Range values(std::initializer_list<double> list);

Argument<Scalar> number(std::string name, Range range);
Argument<Vector<2>> vector2(std::string name, Range range);
Argument<Vector<3>> vector3(std::string name, Range range);
Argument<Vector<4>> vector4(std::string name, Range range);
Argument<Vector<3>> colour(std::string name);  // [0, 1]
Argument<Matrix<3>> matrix3(std::string name, Range range);
Argument<Matrix<4>> matrix4(std::string name, Range range);

// Unit vectors, as near as fp32 gives them: all, or those with n.v in [0, 1], where `n` names an earlier argument.
Argument<Vector<3>> unit(std::string name);
Argument<Vector<3>> hemisphere(std::string name, std::string n);
// Unit vectors at an angle of up to `reach` radians from the earlier argument `n`, or `reach` times the earlier number `scale`
// (half vectors of a lobe of width alpha). Denser towards n; n itself and its neighbours among the extremes.
Argument<Vector<3>> near(std::string name, std::string n, double reach, std::string scale = "");

Argument<Integer> integer(std::string name, int low, int high);
Argument<Unsigned> bits(std::string name);  // any 32

// n of the kind: array<9>(vector3("sh", linear(-1, 1))).
template <uint32_t n, class Element>
Argument<Array<Element, n>> array(const Argument<Element>& element) {
    const Domain one = element.domain;
    Domain all = one;
    all.dimensions = one.dimensions * n;
    all.inside = [one](const double* point, const Known& known, uint32_t* words) {
        for (uint32_t i = 0; i < n; ++i) one.inside(point + i * one.dimensions, known, words + i * Element::words);
    };
    all.extreme = [one](uint32_t which, const Known& known, uint32_t* words) {
        for (uint32_t i = 0; i < n; ++i) one.extreme((which * (i + 1) + i) % one.extremes, known, words + i * Element::words);
    };
    return {element.name, all};
}

}  // namespace kiln::test
