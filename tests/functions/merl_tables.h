#pragma once
// MERL tables of an analytic BRDF, as textures and as what stands for them in references.

#include "tests/device/fetch.h"
#include "tests/functions/function.h"
#include "uber/reference/fresnel.h"
#include "uber/reference/ggx.h"
#include "uber/reference/ggx_forms.h"
#include "uber/reference/merl_file.h"
#include "uber/reference/smith.h"

namespace kiln::test {

inline constexpr SamplerState merl_sampler{Filter::linear, MipFilter::none, Wrap::clamp, Comparison::off};

// GGX with height-correlated Smith and Schlick's Fresnel, per steradian; n is z.
struct Gold {
    double alpha;
    reference::Vec3<double> operator()(const reference::Vec3<double>& l, const reference::Vec3<double>& v) const {
        const reference::Vec3<double> n{0, 0, 1}, h = normalize(l + v);
        return reference::fresnel_schlick(dot(l, h), reference::Vec3<double>{1.0, 0.78, 0.34}) *
               (reference::ggx_distribution_cross(n, h, alpha) * reference::ggx_visibility(l.z, v.z, alpha));
    }
};
inline Gold gold(double roughness) { return {roughness * roughness}; }

class MerlTable {
public:
    template <class Brdf>
    explicit MerlTable(Brdf brdf) : MerlTable(reference::parse_merl("table", reference::merl_bytes(brdf))) {}
    explicit MerlTable(const reference::MerlFile& file) : texels_(reference::merl_texels(file)) {}

    std::shared_ptr<const ImageData> image() const {
        auto out = std::make_shared<ImageData>();
        out->dim = ImageDim::d3;
        out->format = TexelFormat::rgba32_float;
        out->width = reference::merl_columns;
        out->height = reference::merl_rows;
        out->slices = reference::merl_slices;
        out->texels = bytes_of(texels_);
        return out;
    }
    template <class T>
    reference::Vec4<T> read(int theta_h, int theta_d, int phi_d) const {
        const float* t = texels_.data() + 4 * ((theta_h * reference::merl_rows + theta_d) * reference::merl_columns + phi_d + 1);
        const auto number = [](float x) { return T(static_cast<double>(x)); };
        return {number(t[0]), number(t[1]), number(t[2]), number(t[3])};
    }

private:
    std::vector<float> texels_;
};

}  // namespace kiln::test
