#ifndef KILN_GI_CORNELL_GLSL
#define KILN_GI_CORNELL_GLSL
// Three small rooms to hold forms of indirect light against one another; GI_SCENE chooses. Include before gi_path.glsl.
//   0  a Cornell box in [-1, 1]^3, open towards +z, with a low and a tall block, lit by gi_cornell_lamp
//   1  a furnace: the closed box, every wall of emission 1 and albedo GI_FURNACE_ALBEDO a; radiance is 1 / (1 - a)
//   2  two facing plates, 1 x 1 at distance 1: the lower black, the upper of emission 1 and albedo 0; the mean irradiance of
//      the lower is pi F, F = 0.199824896
#include "gi_quad.glsl"

#ifndef GI_SCENE
#define GI_SCENE 0
#endif
#ifndef GI_FURNACE_ALBEDO
#define GI_FURNACE_ALBEDO 0.5
#endif

#if GI_SCENE == 0
#define GI_QUADS 15
const GiQuad gi_scene_quads[GI_QUADS] = GiQuad[](
    GiQuad(vec3(-1.0, -1.0, -1.0), vec3(0.0, 0.0, 2.0), vec3(2.0, 0.0, 0.0),
           vec3(0.725, 0.71, 0.68), vec3(0.0)),
    GiQuad(vec3(-1.0, 1.0, -1.0), vec3(2.0, 0.0, 0.0), vec3(0.0, 0.0, 2.0),
           vec3(0.725, 0.71, 0.68), vec3(0.0)),
    GiQuad(vec3(-1.0, -1.0, -1.0), vec3(2.0, 0.0, 0.0), vec3(0.0, 2.0, 0.0),
           vec3(0.725, 0.71, 0.68), vec3(0.0)),
    GiQuad(vec3(-1.0, -1.0, -1.0), vec3(0.0, 2.0, 0.0), vec3(0.0, 0.0, 2.0),
           vec3(0.63, 0.065, 0.05), vec3(0.0)),
    GiQuad(vec3(1.0, -1.0, -1.0), vec3(0.0, 0.0, 2.0), vec3(0.0, 2.0, 0.0),
           vec3(0.14, 0.45, 0.091), vec3(0.0)),
    GiQuad(vec3(0.05, -0.4, 0.05), vec3(0.0, 0.0, 0.6), vec3(0.6, 0.0, 0.0),
           vec3(0.725, 0.71, 0.68), vec3(0.0)),
    GiQuad(vec3(0.05, -1.0, 0.65), vec3(0.6, 0.0, 0.0), vec3(0.0, 0.6, 0.0),
           vec3(0.725, 0.71, 0.68), vec3(0.0)),
    GiQuad(vec3(0.05, -1.0, 0.05), vec3(0.0, 0.6, 0.0), vec3(0.6, 0.0, 0.0),
           vec3(0.725, 0.71, 0.68), vec3(0.0)),
    GiQuad(vec3(0.05, -1.0, 0.05), vec3(0.0, 0.0, 0.6), vec3(0.0, 0.6, 0.0),
           vec3(0.725, 0.71, 0.68), vec3(0.0)),
    GiQuad(vec3(0.65, -1.0, 0.05), vec3(0.0, 0.6, 0.0), vec3(0.0, 0.0, 0.6),
           vec3(0.725, 0.71, 0.68), vec3(0.0)),
    GiQuad(vec3(-0.7, 0.2, -0.6), vec3(0.0, 0.0, 0.6), vec3(0.6, 0.0, 0.0),
           vec3(0.725, 0.71, 0.68), vec3(0.0)),
    GiQuad(vec3(-0.7, -1.0, 0.0), vec3(0.6, 0.0, 0.0), vec3(0.0, 1.2, 0.0),
           vec3(0.725, 0.71, 0.68), vec3(0.0)),
    GiQuad(vec3(-0.7, -1.0, -0.6), vec3(0.0, 1.2, 0.0), vec3(0.6, 0.0, 0.0),
           vec3(0.725, 0.71, 0.68), vec3(0.0)),
    GiQuad(vec3(-0.7, -1.0, -0.6), vec3(0.0, 0.0, 0.6), vec3(0.0, 1.2, 0.0),
           vec3(0.725, 0.71, 0.68), vec3(0.0)),
    GiQuad(vec3(-0.1, -1.0, -0.6), vec3(0.0, 1.2, 0.0), vec3(0.0, 0.0, 0.6),
           vec3(0.725, 0.71, 0.68), vec3(0.0)));
#elif GI_SCENE == 1
#define GI_QUADS 6
const GiQuad gi_scene_quads[GI_QUADS] = GiQuad[](
    GiQuad(vec3(-1.0, -1.0, -1.0), vec3(0.0, 0.0, 2.0), vec3(2.0, 0.0, 0.0),
           vec3(GI_FURNACE_ALBEDO), vec3(1.0)),
    GiQuad(vec3(-1.0, 1.0, -1.0), vec3(2.0, 0.0, 0.0), vec3(0.0, 0.0, 2.0),
           vec3(GI_FURNACE_ALBEDO), vec3(1.0)),
    GiQuad(vec3(-1.0, -1.0, -1.0), vec3(2.0, 0.0, 0.0), vec3(0.0, 2.0, 0.0),
           vec3(GI_FURNACE_ALBEDO), vec3(1.0)),
    GiQuad(vec3(-1.0, -1.0, -1.0), vec3(0.0, 2.0, 0.0), vec3(0.0, 0.0, 2.0),
           vec3(GI_FURNACE_ALBEDO), vec3(1.0)),
    GiQuad(vec3(1.0, -1.0, -1.0), vec3(0.0, 0.0, 2.0), vec3(0.0, 2.0, 0.0),
           vec3(GI_FURNACE_ALBEDO), vec3(1.0)),
    GiQuad(vec3(-1.0, -1.0, 1.0), vec3(0.0, 2.0, 0.0), vec3(2.0, 0.0, 0.0),
           vec3(GI_FURNACE_ALBEDO), vec3(1.0)));
#else
#define GI_QUADS 2
const GiQuad gi_scene_quads[GI_QUADS] = GiQuad[](
    GiQuad(vec3(-0.5, -0.5, -0.5), vec3(0.0, 0.0, 1.0), vec3(1.0, 0.0, 0.0), vec3(0.0), vec3(0.0)),
    GiQuad(vec3(-0.5, 0.5, -0.5), vec3(1.0, 0.0, 0.0), vec3(0.0, 0.0, 1.0), vec3(0.0), vec3(1.0)));
#endif
#define GI_QUAD(i) gi_scene_quads[i]

// Below the middle of the ceiling, shining down. Scenes 1 and 2 are lit by their walls alone.
GiLamp gi_cornell_lamp() {
    return GiLamp(vec3(0.0, 0.9, 0.0), vec3(0.0, -1.0, 0.0), vec3(GI_SCENE == 0 ? 1.0 : 0.0));
}

#endif
