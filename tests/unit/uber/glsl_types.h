// GLSL's types and functions over KILN_SCALAR, as far as uber/lib uses them, so that its files compile as C++. No include
// guard: it is read once a precision, inside a namespace. Literals become KILN_SCALAR, so that all arithmetic is in it.

struct Real {
    KILN_SCALAR v = 0;
    Real() = default;
    Real(double x) : v(static_cast<KILN_SCALAR>(x)) {}
    explicit operator double() const { return static_cast<double>(v); }
};
inline Real make(KILN_SCALAR x) {
    Real r;
    r.v = x;
    return r;
}
inline Real operator-(Real a) { return make(-a.v); }
inline Real operator+(Real a, Real b) { return make(a.v + b.v); }
inline Real operator-(Real a, Real b) { return make(a.v - b.v); }
inline Real operator*(Real a, Real b) { return make(a.v * b.v); }
inline Real operator/(Real a, Real b) { return make(a.v / b.v); }
inline bool operator<(Real a, Real b) { return a.v < b.v; }
inline bool operator>(Real a, Real b) { return a.v > b.v; }
inline bool operator<=(Real a, Real b) { return a.v <= b.v; }
inline bool operator>=(Real a, Real b) { return a.v >= b.v; }
inline Real sqrt(Real x) { return make(std::sqrt(x.v)); }
inline Real inversesqrt(Real x) { return make(KILN_SCALAR(1) / std::sqrt(x.v)); }
inline Real exp2(Real x) { return make(std::exp2(x.v)); }
inline Real pow(Real x, Real y) { return make(std::pow(x.v, y.v)); }
inline Real abs(Real x) { return make(std::fabs(x.v)); }
inline Real min(Real a, Real b) { return b < a ? b : a; }
inline Real max(Real a, Real b) { return a < b ? b : a; }
inline Real clamp(Real x, Real low, Real high) { return min(max(x, low), high); }
inline Real mix(Real a, Real b, Real t) { return a * (1.0 - t) + b * t; }

struct vec2 {
    Real x, y;
    explicit vec2(Real a) : x(a), y(a) {}
    vec2(Real a, Real b) : x(a), y(b) {}
    vec2 swizzle_yx() const { return {y, x}; }
};
struct vec3 {
    Real x, y, z;
    vec3() = default;
    explicit vec3(Real a) : x(a), y(a), z(a) {}
    vec3(Real a, Real b, Real c) : x(a), y(b), z(c) {}
    vec3(vec2 a, Real c) : x(a.x), y(a.y), z(c) {}
    vec2 swizzle_xy() const { return {x, y}; }
};
struct vec4 {
    Real x, y, z, w;
    vec4(Real a, Real b, Real c, Real d) : x(a), y(b), z(c), w(d) {}
    vec4(vec3 a, Real d) : x(a.x), y(a.y), z(a.z), w(d) {}
    vec2 swizzle_xy() const { return {x, y}; }
    vec2 swizzle_zw() const { return {z, w}; }
    vec3 swizzle_xyz() const { return {x, y, z}; }
};
#define KILN_EACH(op)                                                                        \
    inline vec2 operator op(vec2 a, vec2 b) { return {a.x op b.x, a.y op b.y}; }             \
    inline vec2 operator op(vec2 a, Real b) { return a op vec2(b); }                         \
    inline vec2 operator op(Real a, vec2 b) { return vec2(a) op b; }                         \
    inline vec3 operator op(vec3 a, vec3 b) { return {a.x op b.x, a.y op b.y, a.z op b.z}; } \
    inline vec3 operator op(vec3 a, Real b) { return a op vec3(b); }                         \
    inline vec3 operator op(Real a, vec3 b) { return vec3(a) op b; }
KILN_EACH(+)
KILN_EACH(-)
KILN_EACH(*)
KILN_EACH(/)
#undef KILN_EACH
inline vec3 operator-(vec3 a) { return {-a.x, -a.y, -a.z}; }
inline vec2 abs(vec2 a) { return {abs(a.x), abs(a.y)}; }
inline vec3 abs(vec3 a) { return {abs(a.x), abs(a.y), abs(a.z)}; }
inline vec3 max(vec3 a, vec3 b) { return {max(a.x, b.x), max(a.y, b.y), max(a.z, b.z)}; }
inline vec3 clamp(vec3 x, vec3 low, vec3 high) {
    return {clamp(x.x, low.x, high.x), clamp(x.y, low.y, high.y), clamp(x.z, low.z, high.z)};
}
inline vec3 mix(vec3 a, vec3 b, Real t) { return {mix(a.x, b.x, t), mix(a.y, b.y, t), mix(a.z, b.z, t)}; }
inline Real dot(vec3 a, vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline vec3 cross(vec3 a, vec3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }

struct bvec3 {
    bool x, y, z;
};
inline bvec3 greaterThanEqual(vec3 a, vec3 b) { return {a.x >= b.x, a.y >= b.y, a.z >= b.z}; }
inline bvec3 lessThanEqual(vec3 a, vec3 b) { return {a.x <= b.x, a.y <= b.y, a.z <= b.z}; }
inline bool all(bvec3 b) { return b.x && b.y && b.z; }

struct mat3 {
    vec3 column[3];
    mat3(vec3 a, vec3 b, vec3 c) : column{a, b, c} {}
    const vec3& operator[](int i) const { return column[i]; }
};
inline vec3 operator*(const mat3& m, vec3 v) { return m[0] * v.x + m[1] * v.y + m[2] * v.z; }

// A depth map as a function of where it is read; comparison LESS_OR_EQUAL.
struct sampler2DShadow {
    Real (*depth)(vec2 uv);
};
struct samplerCubeShadow {
    Real (*depth)(vec3 direction);
};
inline Real textureLod(const sampler2DShadow& map, vec3 p, Real) { return p.z <= map.depth(vec2(p.x, p.y)) ? 1.0 : 0.0; }
inline Real texture(const samplerCubeShadow& map, vec4 p) { return p.w <= map.depth(vec3(p.x, p.y, p.z)) ? 1.0 : 0.0; }
