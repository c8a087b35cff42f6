// The values of surface's axis macros by name. The numbers are the manifest's (manifests/surface.yaml): a value's place
// in its list.

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

#define LIGHTMAP_NONE 0
#define LIGHTMAP_FLAT 1
#define LIGHTMAP_SH_LQ 2
#define LIGHTMAP_SH_HQ 3

#define SHADOW_NONE 0
#define SHADOW_HARD 1
