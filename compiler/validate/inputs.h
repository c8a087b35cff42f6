#pragma once
// Deterministic inputs for a pipeline, from its reflection and a seed. Values are *ordinary*: what typical shading code
// expects, so that a non-finite output is the shader's fault. The policy (a name decides nothing but the seed):
//
//   float, vec2, vec4      each component in [0.1, 1)
//   vec3                   as above, scaled to a length in [0.8, 1.2): serves as a direction, a colour, a position
//   matrices               close to the identity: rotations of up to 0.35 rad, scale near 0.9; a mat4 squeezes z into (0, 1) and
//                          has a slight perspective, so chains of model, view and projection keep a grid on screen
//   integers               1 or 2 in blocks, 0 to 3 in textures and vertex data: counts, loops and indices stay small
//   booleans               0 or 1
//   textures               16x16 (cube faces 16, slices 4, layers 3 or 6), smooth noise in [0.1, 1) with a full mip chain
//   depth textures         smooth noise around 0.5, so that comparisons go both ways
//   run-time arrays        64 elements
//   vertex data            a grid of 10x10 cells in alternating winding; one attribute is the position (x, y in [-0.95, 0.95]),
//                          the others vary smoothly with it
//
// Mood::mixed is the second set: floats take both signs. It serves comparison only, since pow(-0.3, 2.2) is nobody's bug.
// A resource's data depends on its *name* and members' names, never on its slot: bound by the published numbers, a wrong
// number then shows in the picture.

#include <optional>

#include "compiler/validate/device.h"

namespace kiln {

enum class Mood : uint8_t { ordinary = 0, mixed = 1 };  // first_instance of a draw; in verdict keys: append only

inline constexpr uint32_t inputs_version = 1;  // part of verdict keys: raise with any change of the policy
inline constexpr uint32_t grid_cells = 10;
inline constexpr uint32_t grid_vertices = grid_cells * grid_cells * 6;
inline constexpr uint32_t run_time_elements = 64;

struct InputOptions {
    uint64_t seed = 1;
    Mood mood = Mood::ordinary;
    std::string position;   // name of the vertex input that gets the grid; empty: the one of lowest location that can
    uint32_t vertices = 0;  // 0: the grid, or 3 for a user's vertex stage without inputs
};

// A resource's place and type, with nothing bound yet.
Binding bare_binding(const Resource& resource);

Inputs make_inputs(const std::vector<StageCode>& stages, const InputOptions& options);

// Names of the vertex inputs that could be the position: float vectors of two or more components, by location.
std::vector<std::string> position_candidates(const std::vector<StageCode>& stages);

// Position of a grid vertex in [-1, 1].
std::array<float, 2> grid_position(uint32_t vertex);

// Bytes that one block needs with its run-time array.
size_t block_bytes(const Resource& block);

// Offsets from the block's start of every element of a member, in order; a run-time dimension counts `run_time_elements`.
std::vector<size_t> element_offsets(const Member& member);

}  // namespace kiln
