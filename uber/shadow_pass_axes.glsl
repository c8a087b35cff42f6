// The values of shadow_pass's axis macros by name. The numbers are the manifest's (manifests/shadow_pass.yaml).

#define KIND_PLAIN 0
#define KIND_MOMENTS 1

#define LIGHT_DIRECTIONAL 1    // numbered as surface has them
#define LIGHT_POINT 2
#define LIGHT_SPOT 3
