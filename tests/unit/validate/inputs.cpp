#include "compiler/validate/inputs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <set>

#include "compiler/validate/blocks.h"

namespace kiln {
namespace {

Member member(const char* name, uint8_t rows, uint8_t columns, uint32_t offset, BaseType base = BaseType::float32) {
    Member m;
    m.name = name;
    m.type.base = base;
    m.type.rows = rows;
    m.type.columns = columns;
    m.offset = offset;
    return m;
}

float at(const Bytes& b, size_t offset) {
    float v;
    std::memcpy(&v, b.data() + offset, 4);
    return v;
}

Resource block(std::vector<Member> members, uint32_t bytes) {
    Resource r;
    r.name = "block";
    r.bytes = bytes;
    r.members = std::move(members);
    return r;
}

TEST(Inputs, ElementsOfNestedArrays) {
    Member m = member("lights[].w", 1, 1, 8);
    m.type.array = {2, 3};
    m.strides = {64, 16};
    EXPECT_EQ(element_offsets(m), (std::vector<size_t>{8, 24, 40, 72, 88, 104}));
    m.strides.clear();
    m.array_stride = 16;
    EXPECT_EQ(element_offsets(m), (std::vector<size_t>{8, 24, 40, 56, 72, 88}));
    m.type.array = {0};
    m.strides = {32};
    EXPECT_EQ(element_offsets(m).size(), run_time_elements);
}

TEST(Inputs, OrdinaryValuesAreInRange) {
    const Resource r = block({member("f", 1, 1, 0), member("v", 4, 1, 16), member("d", 3, 1, 32),
                              member("n", 1, 1, 44, BaseType::int32), member("b", 1, 1, 48, BaseType::boolean)},
                             64);
    for (uint64_t seed = 0; seed < 200; ++seed) {
        const Bytes b = fill_block(r, seed, false);
        for (const size_t o : {0u, 16u, 20u, 24u, 28u}) {
            EXPECT_GE(at(b, o), 0.1f);
            EXPECT_LT(at(b, o), 1.0f);
        }
        const float length = std::sqrt(at(b, 32) * at(b, 32) + at(b, 36) * at(b, 36) + at(b, 40) * at(b, 40));
        EXPECT_GT(length, 0.79f);
        EXPECT_LT(length, 1.21f);
        EXPECT_TRUE(b[44] == 1 || b[44] == 2);
        EXPECT_LE(b[48], 1);
    }
}

TEST(Inputs, RowMajorIsTheTranspose) {
    Member m = member("m", 4, 4, 0);
    m.matrix_stride = 16;
    const Bytes columns = fill_block(block({m}, 64), 5, false);
    m.row_major = true;
    const Bytes rows = fill_block(block({m}, 64), 5, false);
    for (size_t r = 0; r < 4; ++r)
        for (size_t c = 0; c < 4; ++c) EXPECT_EQ(at(columns, c * 16 + r * 4), at(rows, r * 16 + c * 4));
    EXPECT_EQ(at(columns, 60), 1.0f);
}

TEST(Inputs, NamesDecideAndSlotsDoNot) {
    const Bytes a = fill_block(block({member("x", 1, 1, 0), member("y", 1, 1, 4)}, 16), 1, false);
    const Bytes b = fill_block(block({member("y", 1, 1, 0), member("x", 1, 1, 4)}, 16), 1, false);
    EXPECT_EQ(at(a, 0), at(b, 4));
    EXPECT_EQ(at(a, 4), at(b, 0));
    EXPECT_NE(at(a, 0), at(a, 4));
    StageCode s;
    s.stage = Stage::fragment;
    Resource t;
    t.kind = ResourceKind::combined_image;
    t.dim = ImageDim::d2;
    t.name = "albedo";
    s.reflection.resources = {t};
    const auto first = make_inputs({s}, {}).bindings.at(0).images.at(0);
    s.reflection.resources[0].binding = 7;
    EXPECT_EQ(make_inputs({s}, {}).bindings.at(0).images.at(0)->texels, first->texels);
    s.reflection.resources[0].name = "gloss";
    EXPECT_NE(make_inputs({s}, {}).bindings.at(0).images.at(0)->texels, first->texels);
}

TEST(Inputs, HostileReflectionStaysBounded) {
    Member m = member("m", 4, 1, 0xfffffff0u);
    m.type.array = {0xffffffffu, 0xffffffffu};
    m.strides = {0xffffffffu, 0xffffffffu};
    m.matrix_stride = 0xffffffffu;
    Member wide = member("w", 200, 200, 4);
    Resource r = block({m, wide}, 0xffffffffu);
    r.array = {0xffffffffu};
    StageCode s;
    s.stage = Stage::compute;
    s.reflection.workgroup = {0, 0xffffffffu, 1};
    r.array.clear();
    s.reflection.resources = {r};
    const Inputs in = make_inputs({s}, {});
    EXPECT_LE(in.bindings.at(0).buffers.at(0).size(), size_t{16} << 20);
    EXPECT_EQ(in.groups[1], 1u);
    EXPECT_LE(word_types(r).size(), size_t{4} << 20);
}

TEST(Inputs, AttributesByNameAndOnePosition) {
    StageCode s;
    Varying a, b, c;
    a.name = "normal", a.location = 0, a.type.rows = 3;
    b.name = "place", b.location = 4, b.type.rows = 3;
    c.name = "joints", c.location = 5, c.type.rows = 4, c.type.base = BaseType::uint32;
    s.reflection.inputs = {a, b, c};
    EXPECT_EQ(position_candidates({s}), (std::vector<std::string>{"normal", "place"}));
    InputOptions o;
    o.position = "place";
    const Inputs in = make_inputs({s}, o);
    ASSERT_EQ(in.attributes.size(), 3u);
    EXPECT_EQ(in.vertices, grid_vertices);
    EXPECT_EQ(in.attributes[1].data.size(), size_t{grid_vertices} * 12);
    EXPECT_FLOAT_EQ(at(in.attributes[1].data, 0), 0.95f * grid_position(0)[0]);
    for (size_t i = 0; i < in.attributes[2].data.size(); i += 4) EXPECT_LE(in.attributes[2].data[i], 3);
}

TEST(Inputs, TheGridCoversItsSquareOnce) {
    double area = 0;
    int fronts = 0;
    for (uint32_t t = 0; t < grid_vertices; t += 3) {
        const auto a = grid_position(t), b = grid_position(t + 1), c = grid_position(t + 2);
        const double twice = static_cast<double>((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]));
        area += std::fabs(twice) / 2;
        fronts += twice > 0;
    }
    EXPECT_NEAR(area, 4.0, 1e-5);
    EXPECT_EQ(fronts, static_cast<int>(grid_vertices / 6));
}

}  // namespace
}  // namespace kiln
