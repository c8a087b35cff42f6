// The values of surface's axis macros by name, and the defaults of axes that a manifest may leave out. The numbers are the
// manifests' (surface.yaml, renderer.yaml): a value's place in its list.

#define PASS_FORWARD 0
#define PASS_GBUFFER 1
#define PASS_DEPTH 2
#define PASS_VELOCITY 3

#define LIGHT_NONE 0
#define LIGHT_DIRECTIONAL 1
#define LIGHT_POINT 2
#define LIGHT_SPOT 3

#define MATERIAL_BLINN_PHONG 0
#define MATERIAL_PBR_MR 1
#define MATERIAL_PBR_SG 2
#define MATERIAL_DISNEY 3
#define MATERIAL_BLINN_PHONG_RAW 4
#define MATERIAL_BLINN_PHONG_LECTURE 5
#define MATERIAL_PBR_LECTURE 6

#define LIGHTMAP_NONE 0
#define LIGHTMAP_FLAT 1
#define LIGHTMAP_SH_LQ 2
#define LIGHTMAP_SH_HQ 3
#define LIGHTMAP_SH_LECTURE 4

#define SHADOW_NONE 0
#define SHADOW_HARD 1
#define SHADOW_PCF3 2
#define SHADOW_PCF5 3
#define SHADOW_PCF7 4
#define SHADOW_PCSS 5
#define SHADOW_VSM 6
#define SHADOW_VSSM 7
#define SHADOW_LECTURE 8

#define PROBES_NONE 0
#define PROBES_SH_L1 1
#define PROBES_SH_L2 2

#define IBL_NONE 0
#define IBL_SPLIT_SUM 1

#define REFLECTION_NONE 0
#define REFLECTION_BOX 1
#define REFLECTION_BLENDED 2

#define GEOMETRY_HEIGHT_CORRELATED 0
#define GEOMETRY_HAMMON 1

#define PRECISION_FP32 0
#define PRECISION_MEDIUMP 1

#ifndef PASS
#define PASS PASS_FORWARD
#endif
#ifndef MATERIAL
#define MATERIAL MATERIAL_BLINN_PHONG
#endif
#ifndef LIGHTMAP
#define LIGHTMAP LIGHTMAP_NONE
#endif
#ifndef TWO_SIDED
#define TWO_SIDED 0
#endif
#ifndef SHADOW
#define SHADOW SHADOW_NONE
#endif
#ifndef CASCADES
#define CASCADES 1
#endif
#ifndef PROBES
#define PROBES PROBES_NONE
#endif
#ifndef IBL
#define IBL IBL_NONE
#endif
#ifndef REFLECTION
#define REFLECTION REFLECTION_NONE
#endif
#ifndef GEOMETRY
#define GEOMETRY GEOMETRY_HEIGHT_CORRELATED
#endif
#ifndef NORMAL_MAP
#define NORMAL_MAP 0
#endif
#ifndef ALPHA_TEST
#define ALPHA_TEST 0
#endif
#ifndef PRECISION
#define PRECISION PRECISION_FP32
#endif
// 1: the light alone, added over a picture that has what does not depend on it.
#ifndef ADDITIVE
#define ADDITIVE 0
#endif

// Colours between 0 and what a half float holds; places, depths and what is squared stay out of it.
#if PRECISION == PRECISION_MEDIUMP
#define MEDIUM mediump
#else
#define MEDIUM
#endif
