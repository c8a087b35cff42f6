#version 450
// From a map of moments to what a filter reads: a summed-area table, rows first and then columns, or the next mip level.
//
// One work group sums one line in pieces of 256 texels (Hillis and Steele 1986 within a piece, a carry between them), in a
// fixed order, so that equal maps give equal tables. Sums of N^2 texels in fp32 keep about N^2 |q| 2^-24: centre q.

#define OPERATION_SUM_ROWS 0
#define OPERATION_SUM_COLUMNS 1
#define OPERATION_HALVE 2

layout(set = 0, binding = 0, rg32f) uniform readonly image2D source;
layout(set = 0, binding = 1, rg32f) uniform writeonly image2D target;

#if OPERATION == OPERATION_HALVE

layout(local_size_x = 8, local_size_y = 8) in;

// The mean of 2 x 2 texels; an odd side's last texel stands for the missing one too.
void main() {
    const ivec2 place = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(place, imageSize(target)))) {
        return;
    }
    const ivec2 last = imageSize(source) - 1;
    const ivec2 low = min(2 * place, last);
    const ivec2 high = min(2 * place + 1, last);
    const vec2 sum = imageLoad(source, low).xy + imageLoad(source, ivec2(high.x, low.y)).xy +
                     imageLoad(source, ivec2(low.x, high.y)).xy + imageLoad(source, high).xy;
    imageStore(target, place, vec4(0.25 * sum, 0.0, 0.0));
}

#else

layout(local_size_x = 256) in;
shared vec2 sums[2][256];

ivec2 texel(int along, int line) {
#if OPERATION == OPERATION_SUM_ROWS
    return ivec2(along, line);
#else
    return ivec2(line, along);
#endif
}

void main() {
    const ivec2 size = imageSize(source);
#if OPERATION == OPERATION_SUM_ROWS
    const int length = size.x;
#else
    const int length = size.y;
#endif
    const int line = int(gl_WorkGroupID.x);
    const int lane = int(gl_LocalInvocationID.x);
    vec2 carry = vec2(0.0);
    for (int start = 0; start < length; start += 256) {
        const int along = start + lane;
        sums[0][lane] = along < length ? imageLoad(source, texel(along, line)).xy : vec2(0.0);
        barrier();
        int now = 0;
        for (int reach = 1; reach < 256; reach *= 2) {
            sums[1 - now][lane] = sums[now][lane] + (lane >= reach ? sums[now][lane - reach] : vec2(0.0));
            now = 1 - now;
            barrier();
        }
        if (along < length) {
            imageStore(target, texel(along, line), vec4(carry + sums[now][lane], 0.0, 0.0));
        }
        carry += sums[now][255];
        barrier();
    }
}

#endif
