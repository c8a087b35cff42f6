#pragma once
// A table as our own types, for dump, diff, explain and validate: what the runtime reader resolves, rebuilt as sets and maps,
// so that questions about all variants at once need no listing.

#include <memory>
#include <string>
#include <vector>

#include "compiler/base/digest.h"
#include "compiler/base/result.h"
#include "compiler/runtime/kiln.h"
#include "compiler/space/space.h"
#include "compiler/table/table_map.h"
#include "compiler/toolchain/toolchain.h"

namespace kiln {

struct TableStage {
    Stage stage = Stage::vertex;
    std::vector<uint32_t> axes;     // those that decide the module, ascending
    LeafMaps::Ref map = 0;          // variant -> module of the table, in TableShader::maps; right inside `needed` only
    std::vector<uint32_t> modules;  // that some needed variant uses, ascending
};

struct TableRule {
    std::string text, because;
    bool forbid = true;
    Set broken;
};

struct TablePipeline {
    std::vector<uint32_t> modules;  // one a stage
    std::string count;              // decimal
    Digits witness;
};

struct TableShader {
    Space space;  // axes, diagram, legal and needed as the table says; its `rules` are empty, see below
    std::unique_ptr<LeafMaps> maps;
    std::vector<TableStage> stages;
    std::vector<TableRule> rules;
    std::vector<TablePipeline> pipelines;
    SlotLayout slots;
    kiln_shader raw;  // the runtime's handle
    // The needed variants whose `stage` (an index) resolves to `module`.
    Set variants_of(size_t stage, uint32_t module);
};

struct TableModule {
    Stage stage = Stage::vertex;
    WordView words;  // in place
    Digest digest;   // of the words, as recorded
};

// One artifact of a shader's module: a text, or why there is none.
struct TableText {
    Target target = Target::glsl450;
    std::optional<uint32_t> artifact;
    uint32_t size = 0;
    std::string refusal;
};

class TableView {
public:
    // Opens and verifies. The view keeps its own copy of the bytes. Errors are the user's (Fault::input).
    static Result<std::unique_ptr<TableView>> open(ByteView bytes);

    ByteView bytes() const { return {reinterpret_cast<const uint8_t*>(storage_.data()), size_}; }
    const kiln_table& raw() const { return table_; }
    const kiln_info& info() const { return info_; }
    std::string name() const { return {info_.name.data, info_.name.size}; }
    std::string tools() const { return {info_.tools.data, info_.tools.size}; }
    const std::vector<Target>& targets() const { return targets_; }
    const std::vector<std::string>& scenes() const { return scenes_; }
    std::vector<TableShader>& shaders() { return shaders_; }
    TableShader* shader(const std::string& name);

    TableModule module(uint32_t index) const;
    Reflection reflection(uint32_t module) const;
    // One per target of the table but spirv, in its order.
    std::vector<TableText> texts(const TableShader& shader, uint32_t module) const;
    std::string text(uint32_t artifact) const;

private:
    TableView() = default;
    bool read_shader(uint32_t index, TableShader& out);
    bool read_axes(TableShader& out);
    bool read_stages(TableShader& out, const std::vector<uint32_t>& fields);
    bool read_rules(TableShader& out, const std::vector<uint32_t>& fields);
    std::optional<LeafMaps::Ref> read_map(TableShader& out, const kiln_diagram& from, const std::vector<uint32_t>& fields) const;

    std::vector<uint64_t> storage_;
    size_t size_ = 0;
    kiln_table table_{};
    kiln_info info_{};
    std::vector<Target> targets_;
    std::vector<std::string> scenes_;
    std::vector<TableShader> shaders_;
};

}  // namespace kiln
