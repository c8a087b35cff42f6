#pragma once
// glslang, in our own types. Its process-wide state and built-in symbol tables cost about 150 ms and are made by the first
// compile, never by glsl_version(). Every function may be called from several threads at once.

#include <string>
#include <string_view>
#include <vector>

#include "compiler/toolchain/toolchain.h"

namespace kiln {

// "glslang 12.0.0". Does not start glslang.
std::string glsl_version();

// True once something was compiled or parsed back in this process.
bool glsl_started();

// Vulkan GLSL to unoptimised SPIR-V with entry point main. Words are empty exactly when there is an error among the messages.
// With options.debug, names, lines and source stay; `#line` lines of the text then rule the lines in the SPIR-V, but never the
// lines of the messages, which always count the text handed over.
Compiled glsl_compile(Stage stage, std::string_view text, const Options& options);

// Parses OpenGL GLSL or ESSL as an emitted text of `target` must be written. Error messages only; empty: it parses.
std::vector<ToolMessage> glsl_parse_back(Target target, Stage stage, std::string_view text);

// Joins a vertex and a fragment text as a driver's linker would: both parse, every input that the fragment text reads has an
// output of equal type (by location where both say one, else by name), and uniforms of one name agree.
std::vector<ToolMessage> glsl_link_back(Target target, std::string_view vertex, std::string_view fragment);

}  // namespace kiln
