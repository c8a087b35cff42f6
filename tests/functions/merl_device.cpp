// A MERL file from disk to a shader: written, loaded, made a texture, looked up on the device by directions, and held against
// the look-up in double and against the BRDF that the file was made of, bin by bin of theta_h.

#include <unistd.h>

#include <filesystem>

#include "tests/functions/library_run.h"
#include "tests/functions/merl_tables.h"
#include "uber/reference/furnace.h"
#include "uber/reference/random.h"

namespace kiln::test {
namespace {

using namespace reference;

class MerlOnDevice : public testing::Test {
protected:
    MerlOnDevice() : path_(testing::TempDir() + "kiln_merl_" + std::to_string(getpid()) + ".binary") {}
    ~MerlOnDevice() override { std::filesystem::remove(path_); }
    void write(const std::vector<unsigned char>& bytes) const {
        std::ofstream out(path_, std::ios::binary);
        out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
        ASSERT_TRUE(out.good());
    }
    std::string path_;
};

struct Asked {
    Vec3<double> l, h;  // rounded to float
    Vec3<double> v;
};

struct Found {
    std::vector<Vec3<double>> coordinates;
    std::vector<Vec3<double>> nearest, between, filtered;
};

// The three look-ups on the device, by directions.
Found look_up(const MerlTable& table, const std::vector<Asked>& asked) {
    std::vector<Texel> directions;
    for (const Asked& a : asked)
        for (const Vec3<double>& d : {a.l, a.h})
            directions.push_back({static_cast<float>(d.x), static_cast<float>(d.y), static_cast<float>(d.z), 0});
    const uint32_t width = 1024, height = static_cast<uint32_t>(directions.size() / width) + 1;
    directions.resize(size_t{width} * height);
    constexpr SamplerState still{Filter::nearest, MipFilter::nearest, Wrap::clamp, Comparison::off};
    const std::vector<Texel> seen =
        compute("", {"merl.glsl"}, R"(
    const int which = i / 4;
    const vec3 l = texelFetch(directions, ivec2(2 * which % 1024, 2 * which / 1024), 0).xyz;
    const vec3 h = texelFetch(directions, ivec2((2 * which + 1) % 1024, (2 * which + 1) / 1024), 0).xyz;
    const vec3 c = merl_coordinates(vec3(0.0, 0.0, 1.0), l, h);
    if (i % 4 == 0) result.xyz = c;
    if (i % 4 == 1) result.xyz = merl_lookup_nearest(table, c);
    if (i % 4 == 2) result.xyz = merl_lookup(table, c);
    if (i % 4 == 3) result.xyz = merl_lookup_filtered(table, c);
)",
                static_cast<uint32_t>(4 * asked.size()),
                {{"directions", image_of(TexelFormat::rgba32_float, width, height, bytes_of(directions)), still},
                 {"table", table.image(), merl_sampler}},
                "layout(set = 0, binding = 1) uniform sampler2D directions;\n"
                "layout(set = 0, binding = 2) uniform sampler3D table;\n");
    Found out;
    for (size_t i = 0; i < seen.size(); ++i)
        (i % 4 == 0   ? out.coordinates
         : i % 4 == 1 ? out.nearest
         : i % 4 == 2 ? out.between
                      : out.filtered)
            .push_back({at(seen[i], 0), at(seen[i], 1), at(seen[i], 2)});
    return out;
}

// Directions of these coordinates, rounded to floats; v follows from what was rounded.
Asked directions_of(const Vec3<double>& coordinates) {
    const auto rounded = [](const Vec3<double>& d) {
        return map(d, [](double x) { return static_cast<double>(static_cast<float>(x)); });
    };
    const MerlDirections d = merl_directions(coordinates);
    const Vec3<double> l = rounded(d.l), h = rounded(d.h);
    return {l, h, normalize(h * (2 * dot(l, h)) - l)};
}

double apart(const Vec3<double>& a, const Vec3<double>& b) {
    return std::fmax(std::fabs(a.x / b.x - 1), std::fmax(std::fabs(a.y / b.y - 1), std::fabs(a.z / b.z - 1)));
}

TEST_F(MerlOnDevice, FileToShader) {
    const Gold brdf = gold(0.3);
    std::vector<unsigned char> bytes = merl_bytes(brdf);
    write(bytes);
    const MerlFile file = load_merl(path_);
    ASSERT_EQ(file.error, "");
    // The file says -1 wherever light or view are below the horizon, and so does the warning.
    const auto unmeasured = static_cast<size_t>(std::count(file.measured.begin(), file.measured.end(), false));
    EXPECT_GT(unmeasured, size_t{merl_plane} / 10);
    EXPECT_EQ(file.warning, path_ + ": " + std::to_string(3 * unmeasured) +
                                " of 4374000 values are negative, above 1e38 or not numbers and count as 0");
    const MerlTable table(file);

    // Twelve places in each bin of theta_h up to 60 degrees whose neighbours are all measured.
    constexpr int bins = 73, places = 12;
    Random random(11);
    std::vector<Asked> asked;
    for (int bin = 0; bin < bins; ++bin)
        for (int i = 0; i < places; ++i)
            asked.push_back(directions_of({bin + std::fmax(random(), 1e-3), 0.5 + 24 * random(), 180 * random()}));
    const Found found = look_up(table, asked);
    ASSERT_EQ(found.filtered.size(), asked.size());

    const auto read = [&](int h, int d, int phi) { return table.read<double>(h, d, phi); };
    // |d ln D / d coordinate| is at most 2 3^0.75 / x, x the coordinate of theta_h = alpha; the chord is a square of that over
    // 8 off, the nearest bin half of it (merl_test.cpp). theta_d and phi_d change the BRDF by less than a tenth of that.
    const double slope = 2 * std::pow(3.0, 0.75) / (90 * std::sqrt(brdf.alpha / (0.5 * pi)));
    double worst_device = 0, worst_filtered = 0;
    std::vector<double> nearest_of_bin(bins), between_of_bin(bins);
    for (size_t i = 0; i < asked.size(); ++i) {
        const Vec3<double>& c = found.coordinates[i];
        const size_t bin = i / places;
        // Against the look-up in double at the device's coordinates: sums of eight products, none negative, and a quotient.
        const Vec3<double> expected = merl_lookup<double>(read, c);
        worst_device = std::fmax(worst_device, apart(found.between[i], expected));
        EXPECT_LT(apart(found.between[i], expected), 32 * 0x1p-23) << i;
        EXPECT_LT(apart(found.nearest[i], merl_lookup_nearest<double>(read, c)), 4 * 0x1p-23) << i;
        // Filtered: each weight within 2^-8, so three times that of what neighbours differ by, at most `slope` of the value.
        worst_filtered = std::fmax(worst_filtered, apart(found.filtered[i], expected));
        EXPECT_LT(apart(found.filtered[i], expected), 3 * std::expm1(slope) / 256 + 32 * 0x1p-23) << i;
        // The device's coordinates: atan within 4096 ulp in all, theta_h's root from a sine of no fewer digits than 2^-23/theta.
        const Vec3<double> exact = merl_coordinates(Vec3<double>{0, 0, 1}, asked[i].l, asked[i].h);
        EXPECT_NEAR(c.x, exact.x, 1e-3 * exact.x + 1e-3);
        EXPECT_NEAR(c.y, exact.y, 1e-3 * exact.y + 1e-3);
        // Against the BRDF itself.
        const Vec3<double> truth = brdf(asked[i].l, asked[i].v);
        nearest_of_bin[bin] = std::fmax(nearest_of_bin[bin], apart(found.nearest[i], truth));
        between_of_bin[bin] = std::fmax(between_of_bin[bin], apart(found.between[i], truth));
    }
    for (int bin = 0; bin < bins; bin += 6)
        std::printf("KILN_MERL theta_h bin %d (%.3f to %.3f degrees): nearest %.4f, between bins %.5f of the BRDF\n", bin,
                    90.0 * bin * bin / 8100, 90.0 * (bin + 1) * (bin + 1) / 8100, nearest_of_bin[static_cast<size_t>(bin)],
                    between_of_bin[static_cast<size_t>(bin)]);
    std::printf("KILN_MERL device against double: eight fetches %.2g, filtered %.2g\n", worst_device, worst_filtered);
    for (int bin = 0; bin < bins; ++bin) {
        EXPECT_LT(nearest_of_bin[static_cast<size_t>(bin)], 1.1 * std::expm1(0.5 * slope)) << bin;
        EXPECT_LT(between_of_bin[static_cast<size_t>(bin)], 1.1 * slope * slope / 8) << bin;
    }

    // Two planes of bins changed over, as a reader of another layout would have them, is far outside of all that.
    MerlFile other = file;
    for (int h = 0; h < 90; ++h)
        for (int d = 0; d < 90; ++d)
            for (int phi = 0; phi < 180; ++phi) {
                const auto from = static_cast<size_t>(merl_index({d, h, phi})), to = static_cast<size_t>(merl_index({h, d, phi}));
                other.measured[to] = file.measured[from];
                for (size_t plane = 0; plane < 3; ++plane)
                    other.values[plane * merl_plane + to] = file.values[plane * merl_plane + from];
            }
    const Found wrong = look_up(MerlTable(other), {asked[places * 5]});
    EXPECT_GT(apart(wrong.between[0], brdf(asked[places * 5].l, asked[places * 5].v)), 0.3);
}

// Beside bins of -1 a look-up keeps to what was measured.
TEST_F(MerlOnDevice, UnmeasuredBinsDoNotDarken) {
    const auto white = [](const Vec3<double>&, const Vec3<double>&) { return splat3(1 / pi); };
    write(merl_bytes(white));
    const MerlFile file = load_merl(path_);
    ASSERT_EQ(file.error, "");
    Random random(3);
    std::vector<Asked> asked;
    size_t border = 0;
    std::vector<bool> held;
    while (asked.size() < 2000) {
        const Vec3<double> c{90 * random(), 90 * random(), 180 * random()};
        const std::array<int, 3> bin = merl_bin(c);
        if (!file.measured[static_cast<size_t>(merl_index(bin))]) continue;
        const MerlCorners m = merl_corners(c);
        bool all = true;
        for (int k = 0; k < 8; ++k)
            all = all && file.measured[static_cast<size_t>(merl_index(
                             {(k & 1 ? m.high : m.low)[0], (k & 2 ? m.high : m.low)[1], (k & 4 ? m.high : m.low)[2]}))];
        border += all ? 0 : 1;
        asked.push_back(directions_of(c));
    }
    EXPECT_GT(border, 20u);
    const Found found = look_up(MerlTable(file), asked);
    for (size_t i = 0; i < asked.size(); ++i) {
        EXPECT_NEAR(found.between[i].x * pi, 1.0, 1e-5) << i;
        EXPECT_NEAR(found.filtered[i].x * pi, 1.0, 1e-5) << i;
    }
    // What holds nothing gives nothing.
    MerlFile none = file;
    none.measured.assign(none.measured.size(), false);
    const Found dark = look_up(MerlTable(none), asked);
    for (size_t i = 0; i < asked.size(); ++i) EXPECT_EQ(dark.between[i].x + dark.filtered[i].x + dark.nearest[i].x, 0.0) << i;
}

TEST_F(MerlOnDevice, OtherSizesAreRefused) {
    std::vector<unsigned char> bytes(merl_file_size);
    bytes[0] = bytes[4] = 90, bytes[8] = 180;
    write(bytes);
    EXPECT_EQ(load_merl(path_).error, "");
    bytes.push_back(0);
    write(bytes);
    EXPECT_EQ(load_merl(path_).error, path_ + ": 34992013 bytes; a MERL file has 34992012");
    bytes.resize(100);
    write(bytes);
    EXPECT_EQ(load_merl(path_).error, path_ + ": 100 bytes; a MERL file has 34992012");
    EXPECT_TRUE(load_merl(path_).values.empty());
}

}  // namespace
}  // namespace kiln::test
