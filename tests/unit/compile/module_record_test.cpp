#include "compiler/modules/module_record.h"

#include <gtest/gtest.h>

namespace kiln {
namespace {

Reflection rich() {
    Reflection r;
    r.stage = Stage::compute;
    r.workgroup = {8, 4, 2};
    r.writes_depth = true;
    Resource block;
    block.name = "Scene";
    block.set = 3;
    block.binding = 9;
    block.array = {4, 0};
    block.bytes = 128;
    Member member;
    member.name = "lights[].position";
    member.type = {BaseType::float16, 4, 3, {7, 0}};
    member.offset = 16;
    member.strides = {32, 16};
    member.row_major = true;
    block.members = {member, Member()};
    Resource image;
    image.kind = ResourceKind::storage_image;
    image.dim = ImageDim::cube;
    image.arrayed = image.readonly = true;
    image.sampled = BaseType::uint32;
    image.format = 33;
    r.resources = {block, image};
    Varying varying;
    varying.name = "uv";
    varying.location = 5;
    varying.flat = varying.patch = true;
    r.inputs = {varying};
    r.outputs = {Varying(), varying};
    return r;
}

ModuleRecord example() {
    ModuleRecord record;
    record.raw = sha256(as_bytes(std::string_view("raw")));
    record.pruned = sha256(as_bytes(std::string_view("pruned")));
    record.module = sha256(as_bytes(std::string_view("module")));
    record.messages = {{Severity::warning, 12, "careful"}, {Severity::note, 0, ""}};
    record.reflection = rich();
    return record;
}

TEST(ModuleRecord, RoundTrips) {
    const Digest key = sha256({});
    const ModuleRecord record = example();
    const std::optional<ModuleRecord> back = read_module_record(key, write_module_record(key, record));
    ASSERT_TRUE(back.has_value());
    EXPECT_EQ(record.raw, back->raw);
    EXPECT_EQ(record.pruned, back->pruned);
    EXPECT_EQ(record.module, back->module);
    EXPECT_EQ(record.reflection, back->reflection);
    ASSERT_EQ(2u, back->messages.size());
    EXPECT_EQ("careful", back->messages[0].text);
    EXPECT_EQ(12u, back->messages[0].line);
    EXPECT_EQ(write_module_record(key, record), write_module_record(key, *back));
}

TEST(ModuleRecord, RefusesDamageOfEveryKind) {
    const Digest key = sha256({});
    const Bytes good = write_module_record(key, example());
    for (size_t n = 0; n < good.size(); ++n) {
        const Bytes cut(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(n));
        EXPECT_FALSE(read_module_record(key, cut).has_value()) << n;
    }
    for (size_t n = 0; n < good.size(); ++n) {
        Bytes flipped = good;
        flipped[n] = static_cast<uint8_t>(flipped[n] ^ 1);
        EXPECT_FALSE(read_module_record(key, flipped).has_value()) << n;
    }
    EXPECT_FALSE(read_module_record(sha256(as_bytes(std::string_view("another"))), good).has_value());
}

TEST(ModuleRecord, EveryFieldThatMattersChangesTheAction) {
    const Options plain;
    const Digest base = module_action("tools", plain, Stage::vertex, "text");
    EXPECT_EQ(base, module_action("tools", plain, Stage::vertex, "text"));
    EXPECT_NE(base, module_action("tools 2", plain, Stage::vertex, "text"));
    EXPECT_NE(base, module_action("tools", plain, Stage::fragment, "text"));
    EXPECT_NE(base, module_action("tools", plain, Stage::vertex, "text "));
    for (int field = 0; field < 4; ++field) {
        Options options;
        if (field == 0) options.optimise = Optimise::size;
        if (field == 1) options.vulkan = 0x103;
        if (field == 2) options.spirv = 0x106;
        if (field == 3) options.debug = true;
        EXPECT_NE(base, module_action("tools", options, Stage::vertex, "text")) << field;
    }
    Options macros;  // decides about classes, not about a class
    macros.undefined_macros = UndefinedMacros::zero;
    EXPECT_EQ(base, module_action("tools", macros, Stage::vertex, "text"));
}

}  // namespace
}  // namespace kiln
