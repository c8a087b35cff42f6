// 1 and 0.5 in turn, eight times across uv = [0, 1].
float stripes(vec2 uv) {
    return fract(uv.x * 8.0) < 0.5 ? 1.0 : 0.5;
}
