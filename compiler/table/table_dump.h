#pragma once
// What is in a table, as values for people and for JSON: the whole of it, or what some of a shader's variants resolve to.

#include <map>
#include <string>
#include <vector>

#include "compiler/table/table_read.h"

namespace kiln {

struct DumpValue {
    std::string name;
    int32_t number = 0;
    Count needed;  // variants that have it
};

struct DumpAxis {
    std::string name, macro;
    std::vector<DumpValue> values;
};

struct DumpStage {
    Stage stage = Stage::vertex;
    std::vector<std::string> axes;  // that decide the module
    size_t modules = 0;
    uint64_t spirv_bytes = 0;  // of those modules
};

struct DumpShader {
    std::string name;
    Count declared, legal, needed;
    std::vector<DumpAxis> axes;
    std::vector<DumpStage> stages;
    std::vector<std::string> rules;  // "forbid: light == none (nothing to see)"
    SlotLayout slots;
    size_t pipelines = 0;
};

struct TableDump {
    std::string name, tools;
    std::vector<std::string> scenes;
    std::map<Target, size_t> artifacts;  // texts a target; spirv: modules
    std::map<Target, size_t> holes;      // modules of a shader that a target cannot say; absent when none
    uint64_t bytes = 0, spirv_bytes = 0, text_bytes = 0, packed_bytes = 0;
    size_t modules = 0;
    std::vector<DumpShader> shaders;
};

TableDump dump_table(TableView& table);
std::string render(const TableDump& dump);

struct DumpModule {
    uint32_t module = 0;
    std::string digest;
    uint64_t bytes = 0;
    std::string shared;  // describe_condition of all needed variants that use it
    Reflection reflection;
    std::vector<Slot> uses;  // of the shader's slots
    std::vector<TableText> texts;
};

struct VariantDump {
    std::string shader;
    Count selected, legal, needed;
    std::vector<std::pair<Stage, std::vector<DumpModule>>> stages;  // the modules that the selected needed variants reach
};

// `selected` is a set of the shader's diagram: one variant, or all that some axis=value words leave open.
VariantDump dump_variants(TableView& table, TableShader& shader, Set selected);
std::string render(const VariantDump& dump);

struct DumpedText {
    Stage stage = Stage::vertex;
    uint32_t module = 0;
    std::string text;
    std::string refusal;  // why there is no text
};

// The stages' texts in one target but spirv. An Error (the user's) when the selection leaves a stage more than one module,
// naming the axes to say more about, when nothing selected is needed, or when the table has no such target.
Result<std::vector<DumpedText>> dump_texts(TableView& table, TableShader& shader, Set selected, Target target);

}  // namespace kiln
