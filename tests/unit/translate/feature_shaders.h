#pragma once
// Shaders for one language feature each, for the tests of what a target can say. Without their #version line.

#include "compiler/manifest/stage.h"

namespace kiln {

struct FeatureShader {
    Stage stage;
    const char* name;
    const char* text;
};

inline constexpr FeatureShader feature_shaders[] = {
    {Stage::fragment, "addcarry", R"(layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
uint c; uint s=uaddCarry(uv.x,uv.y,c); o=vec4(s,c,0,0);
})"},
    {Stage::fragment, "arrays", R"(const vec4 K[4]=vec4[](vec4(1),vec4(2),vec4(3),vec4(4));
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
vec4 a[4]=K; a[iv.x&3]=v; o=K[iv.y&3]+a[iv.z&3];
})"},
    {Stage::fragment, "arrshadow", R"(layout(binding=0) uniform sampler2DArrayShadow t;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=vec4(texture(t,v));
})"},
    {Stage::fragment, "atomicf", R"(#extension GL_EXT_shader_atomic_float:require
layout(binding=0) buffer B{float f;};
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
atomicAdd(f,1.); o=v;
})"},
    {Stage::fragment, "bary", R"(#extension GL_EXT_fragment_shader_barycentric:require
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=gl_BaryCoordEXT.xyzx;
})"},
    {Stage::fragment, "bfe", R"(layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=vec4(bitfieldExtract(iv.x,2,5),bitfieldExtract(uv.x,2,5),bitfieldInsert(uv.x,uv.y,3,4),0);
})"},
    {Stage::fragment, "bitcount", R"(layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=vec4(bitCount(iv.x));
})"},
    {Stage::fragment, "bitrev", R"(layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=vec4(bitfieldReverse(uv.x));
})"},
    {Stage::fragment, "bools", R"(layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
bvec4 b=lessThan(v,v.yzwx); o=mix(v,v.wzyx,b); if(any(b)&&!all(not(b))) o*=2.;
})"},
    {Stage::compute, "catomic", R"(layout(local_size_x=8) in;
layout(binding=0) buffer B{uint a; int b; uint c[];}; shared uint s;
void main(){
atomicAdd(a,1u); atomicMin(b,-1); atomicCompSwap(c[0],1u,2u); atomicExchange(s,3u); atomicOr(s,4u); a+=s;
})"},
    {Stage::compute, "cbufarr", R"(layout(local_size_x=8) in;
layout(binding=0) buffer B{uint a[];} b[2]; layout(binding=2) uniform U{vec4 a;} u[2]; layout(push_constant) uniform P{uint i;};
void main(){
b[i].a[0]=uint(u[i].a.x);
})"},
    {Stage::compute, "ccoherent", R"(layout(local_size_x=8) in;
layout(binding=0) coherent volatile buffer B{uint a[];}; layout(binding=1) restrict writeonly buffer C{uint c[];};
void main(){
c[0]=a[1]; memoryBarrier();
})"},
    {Stage::compute, "cdouble", R"(layout(local_size_x=8) in;
layout(binding=0) buffer B{double d; dvec3 e;};
void main(){
d=d*2.0lf+e.x;
})"},
    {Stage::compute, "cimg", R"(layout(local_size_x=8) in;
layout(binding=0,r32f) uniform image2D i; layout(binding=1,r32i) uniform iimage2D k;
void main(){
vec4 a=imageLoad(i,ivec2(gl_GlobalInvocationID.xy)); imageStore(i,ivec2(0),a); imageAtomicExchange(k,ivec2(1),2); imageAtomicCompSwap(k,ivec2(1),2,3);
})"},
    {Stage::compute, "cint64atomic", R"(layout(local_size_x=8) in;
#extension GL_EXT_shader_atomic_int64:require
#extension GL_ARB_gpu_shader_int64:require
layout(binding=0) buffer B{uint64_t d;};
void main(){
atomicAdd(d,1UL);
})"},
    {Stage::fragment, "clipdist", R"(in float gl_ClipDistance[2];
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=vec4(gl_ClipDistance[0]);
})"},
    {Stage::fragment, "comp", R"(layout(location=3) in vec2 a; layout(location=3,component=2) in vec2 b;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=vec4(a,b);
})"},
    {Stage::compute, "cspec", R"(layout(local_size_x=8) in;
layout(local_size_x_id=1,local_size_y_id=2) in; layout(binding=0) buffer B{uvec3 a; };
void main(){
a=gl_WorkGroupSize;
})"},
    {Stage::compute, "csub", R"(layout(local_size_x=8) in;
#extension GL_KHR_shader_subgroup_basic:require
layout(binding=0) buffer B{uint a; };
void main(){
a=gl_SubgroupSize+gl_SubgroupInvocationID+gl_NumSubgroups;
})"},
    {Stage::fragment, "cubearr", R"(layout(binding=0) uniform samplerCubeArray t;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=texture(t,v);
})"},
    {Stage::fragment, "cubearrshadow", R"(layout(binding=0) uniform samplerCubeArrayShadow t;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=vec4(texture(t,v,0.5));
})"},
    {Stage::fragment, "cubeshadow", R"(layout(binding=0) uniform samplerCubeShadow t;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=vec4(texture(t,v));
})"},
    {Stage::fragment, "debugprintf", R"(#extension GL_EXT_debug_printf:require
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
debugPrintfEXT("x %f",v.x); o=v;
})"},
    {Stage::fragment, "demote", R"(#extension GL_EXT_demote_to_helper_invocation:require
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
if(v.x<0.) demote; o=v+float(helperInvocationEXT());
})"},
    {Stage::fragment, "devaddr", R"(#extension GL_EXT_buffer_reference:require
layout(buffer_reference,std430) buffer R{vec4 a;}; layout(push_constant) uniform P{R r;};
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=r.a;
})"},
    {Stage::fragment, "dfdx", R"(layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=dFdx(v)+dFdyFine(v)+fwidthCoarse(v);
})"},
    {Stage::fragment, "double", R"(layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
double d=double(v.x)*2.0lf; o=vec4(float(sqrt(d)));
})"},
    {Stage::fragment, "dualsrc", R"(layout(location=0,index=1) out vec4 o2;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=v;o2=v;
})"},
    {Stage::fragment, "firstsource", R"(layout(location=0,index=0) out vec4 o;
layout(location=0) in vec4 v;
void main(){
o=v;
})"},
    {Stage::fragment, "nonuniformsized", R"(#extension GL_EXT_nonuniform_qualifier:require
layout(binding=0) uniform sampler2D t[4];
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
void main(){
o=texture(t[nonuniformEXT(iv.x)],v.xy);
})"},
    {Stage::geometry, "ginstanced",
     R"(layout(triangles,invocations=2) in; layout(triangle_strip,max_vertices=3) out; layout(location=0) in vec4 a[]; layout(location=0) out vec4 b; void main(){ for(int i=0;i<3;i++){ gl_Position=gl_in[i].gl_Position; b=a[i]*float(gl_InvocationID); EmitVertex();} EndPrimitive(); })"},
    {Stage::fragment, "early", R"(layout(early_fragment_tests) in;
layout(binding=0) buffer B{uint n;};
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
atomicAdd(n,1); o=v;
})"},
    {Stage::fragment, "fetchonly", R"(#extension GL_EXT_samplerless_texture_functions:require
layout(binding=0) uniform texture2D t;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=texelFetch(t,iv.xy,0);
})"},
    {Stage::fragment, "findmsb", R"(layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=vec4(findMSB(iv.x),findLSB(uv.x),findMSB(uv.y),0);
})"},
    {Stage::fragment, "fma", R"(layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=fma(v,v,v);
})"},
    {Stage::fragment, "fragdepth", R"(layout(depth_less) out float gl_FragDepth;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=v; gl_FragDepth=v.x;
})"},
    {Stage::fragment, "frexp", R"(layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
int e; float m=frexp(v.x,e); o=vec4(m,e,0,0);
})"},
    {Stage::geometry, "g",
     R"(layout(triangles) in; layout(triangle_strip,max_vertices=3) out; layout(location=0) in vec4 a[]; layout(location=0) out vec4 b; void main(){ for(int i=0;i<3;i++){ gl_Position=gl_in[i].gl_Position; b=a[i]; gl_Layer=i; EmitVertex();} EndPrimitive(); })"},
    {Stage::fragment, "gather", R"(layout(binding=0) uniform sampler2D t;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=textureGather(t,v.xy);
})"},
    {Stage::fragment, "gathercomp", R"(layout(binding=0) uniform sampler2D t;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=textureGather(t,v.xy,2);
})"},
    {Stage::fragment, "gatheroff", R"(layout(binding=0) uniform sampler2D t;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=textureGatherOffset(t,v.xy,ivec2(1,2),1);
})"},
    {Stage::fragment, "gatheroffs", R"(layout(binding=0) uniform sampler2D t;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
const ivec2 q[4]=ivec2[](ivec2(0),ivec2(1),ivec2(2),ivec2(3)); o=textureGatherOffsets(t,v.xy,q);
})"},
    {Stage::fragment, "gathershadow", R"(layout(binding=0) uniform sampler2DShadow t;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=textureGather(t,v.xy,v.z);
})"},
    {Stage::fragment, "half", R"(#extension GL_EXT_shader_explicit_arithmetic_types_float16:require
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
f16vec4 a=f16vec4(v)*2.0hf; o=vec4(a);
})"},
    {Stage::fragment, "half16st", R"(#extension GL_EXT_shader_16bit_storage:require
layout(binding=0) buffer B{float16_t h[];};
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=vec4(float(h[iv.x]));
})"},
    {Stage::fragment, "iblock", R"(layout(location=3) in VS{vec3 n; flat int k; mat2 m;} vs;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=vec4(vs.n,vs.k)+vs.m[0].x;
})"},
    {Stage::fragment, "image",
     R"(layout(binding=0,rgba8) uniform image2D a; layout(binding=1,r32ui) uniform uimage2D b; layout(binding=2,rgba16f) writeonly uniform image3D c;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=imageLoad(a,iv.xy); imageAtomicAdd(b,iv.xy,1u); imageStore(c,iv.xyz,v); o.x+=imageSize(a).x;
})"},
    {Stage::fragment, "imagecube",
     R"(layout(binding=0,rgba8) uniform imageCube a;layout(binding=1,rgba8) uniform image1D b;layout(binding=2,rgba8) uniform image2DMS m;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=imageLoad(a,iv.xyz)+imageLoad(b,iv.x)+imageLoad(m,iv.xy,1);
})"},
    {Stage::fragment, "imagenofmt", R"(layout(binding=0) writeonly uniform image2D a;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
imageStore(a,iv.xy,v); o=v;
})"},
    {Stage::fragment, "imagenoreadfmt", R"(#extension GL_EXT_shader_image_load_formatted:require
layout(binding=0) uniform image2D a;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=imageLoad(a,iv.xy);
})"},
    {Stage::fragment, "imgbuf", R"(layout(binding=0,rgba32f) uniform imageBuffer b;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=imageLoad(b,iv.x); imageStore(b,0,v);
})"},
    {Stage::fragment, "imgr8",
     R"(layout(binding=0,rg16f) uniform image2D a;layout(binding=1,r8) uniform image2D b;layout(binding=2,rgb10_a2) uniform image2D c;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=imageLoad(a,iv.xy)+imageLoad(b,iv.xy)+imageLoad(c,iv.xy);imageStore(a,iv.xy,v);
})"},
    {Stage::fragment, "imulx", R"(layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
int a,b; imulExtended(iv.x,iv.y,a,b); o=vec4(a,b,0,0);
})"},
    {Stage::fragment, "inarr", R"(layout(location=3) in vec4 a[2];
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=a[0]+a[iv.x&1];
})"},
    {Stage::fragment, "int16", R"(#extension GL_EXT_shader_explicit_arithmetic_types_int16:require
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
int16_t a=int16_t(iv.x)*3s; o=vec4(float(a));
})"},
    {Stage::fragment, "int64", R"(#extension GL_ARB_gpu_shader_int64:require
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
int64_t a=int64_t(iv.x)*3L; o=vec4(float(a));
})"},
    {Stage::fragment, "int8st", R"(#extension GL_EXT_shader_8bit_storage:require
layout(binding=0) buffer B{uint8_t h[];};
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=vec4(uint(h[iv.x]));
})"},
    {Stage::fragment, "interp", R"(layout(location=5) in vec4 q;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=interpolateAtCentroid(q)+interpolateAtSample(q,2)+interpolateAtOffset(q,vec2(0.1));
})"},
    {Stage::fragment, "invariantprec", R"(precise vec4 q(vec4 a){return a*a+a;}
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
precise vec4 x=v*v+v; o=x;
})"},
    {Stage::fragment, "isnan", R"(layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=vec4(isnan(v.x),isinf(v.y),0,0);
})"},
    {Stage::fragment, "istruct", R"(struct S{vec3 n; vec2 k;}; layout(location=3) in S s;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=vec4(s.n,s.k.x);
})"},
    {Stage::fragment, "itex", R"(layout(binding=0) uniform isampler2D t; layout(binding=1) uniform usampler2DArray u;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=vec4(texture(t,v.xy))+vec4(texture(u,v.xyz));
})"},
    {Stage::fragment, "keyword",
     R"(layout(binding=0) uniform sampler2D sample_; layout(binding=1) uniform Half{vec4 half_; vec4 float4; vec4 texture2d; vec4 thread;};
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
vec4 float3=v; vec4 input1=v*2.; o=texture(sample_,v.xy)+half_+float3+float4+texture2d+thread+input1;
})"},
    {Stage::fragment, "layer", R"(layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=vec4(gl_Layer,gl_ViewportIndex,gl_PrimitiveID,gl_FrontFacing);
})"},
    {Stage::fragment, "ldexp", R"(layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=vec4(ldexp(v.x,iv.x));
})"},
    {Stage::fragment, "mats", R"(layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
mat3 m=mat3(v.xyz,v.yzx,v.zxy); mat2 k=mat2(v); mat4 q=mat4(v,v.yzwx,v.zwxy,v.wxyz); o=vec4(inverse(m)*v.xyz,determinant(k))+inverse(q)*v; o+=outerProduct(v,v)[1]; o.xyz+=transpose(mat3x2(v.xy,v.yz,v.zw))[0].xxx;
})"},
    {Stage::fragment, "mixes", R"(layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=mod(v,v.yzwx)+roundEven(v)+round(v)+trunc(v)+fract(v)+sign(v)+vec4(sign(iv))+faceforward(v,v,v)+refract(v,v,.5)+reflect(v,v)+smoothstep(0.,1.,v)+step(v,v)+acosh(v)+asinh(v)+atanh(v)+atan(v,v)+exp2(v)+inversesqrt(v)+degrees(v)+radians(v)+vec4(distance(v,v),length(v),normalize(v.x),cross(v.xyz,v.zyx).x);
})"},
    {Stage::fragment, "modf", R"(layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
float i; float f=modf(v.x,i); o=vec4(f,i,0,0);
})"},
    {Stage::fragment, "mrt", R"(layout(location=1) out ivec2 o1; layout(location=2) out uint o2; layout(location=4) out float o4;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=v;o1=iv.xy;o2=uv.x;o4=v.x;
})"},
    {Stage::fragment, "multiview", R"(#extension GL_EXT_multiview:require
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=vec4(gl_ViewIndex);
})"},
    {Stage::fragment, "nonuniform", R"(#extension GL_EXT_nonuniform_qualifier:require
layout(binding=0) uniform sampler2D t[];
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=texture(t[nonuniformEXT(iv.x)],v.xy);
})"},
    {Stage::compute, "numwg", R"(layout(local_size_x=8) in;
layout(binding=0) buffer B{uvec3 a; };
void main(){
a=gl_NumWorkGroups+gl_WorkGroupSize;
})"},
    {Stage::fragment, "outarr", R"(layout(location=1) out vec4 oo[2];
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=v;oo[0]=v;oo[1]=v;
})"},
    {Stage::fragment, "pack", R"(layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=vec4(packHalf2x16(v.xy),packUnorm4x8(v),packSnorm2x16(v.xy),packUnorm2x16(v.xy)); o+=unpackHalf2x16(uv.x).xyxy+unpackSnorm4x8(uv.y);
})"},
    {Stage::fragment, "packdouble", R"(layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=vec4(float(packDouble2x32(uv.xy)));
})"},
    {Stage::fragment, "pointcoord", R"(layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=gl_PointCoord.xyxy;
})"},
    {Stage::fragment, "pushlayout", R"(layout(push_constant) uniform P{vec3 a; float b; float c[5]; mat2 m; vec2 d;};
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=vec4(a,b)+c[3]+m[1].x+d.x;
})"},
    {Stage::fragment, "pushsimple", R"(layout(push_constant) uniform P{mat4 m; vec4 t; int i;} p;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=p.m*p.t+p.i;
})"},
    {Stage::fragment, "quad", R"(#extension GL_KHR_shader_subgroup_quad:require
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=subgroupQuadSwapHorizontal(v);
})"},
    {Stage::fragment, "querylevels", R"(layout(binding=0) uniform sampler2D t;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=vec4(textureQueryLevels(t));
})"},
    {Stage::fragment, "querylod", R"(layout(binding=0) uniform sampler2D t;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=vec4(textureQueryLod(t,v.xy),0,0);
})"},
    {Stage::fragment, "samplevars", R"(layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=vec4(gl_SampleID,gl_SamplePosition,gl_SampleMaskIn[0]); gl_SampleMask[0]=1;
})"},
    {Stage::fragment, "separate", R"(#extension GL_EXT_samplerless_texture_functions:require
layout(binding=0) uniform texture2D t; layout(binding=1) uniform sampler s;layout(binding=2) uniform sampler s2;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=texture(sampler2D(t,s),v.xy)+texture(sampler2D(t,s2),v.xy)+texelFetch(t,iv.xy,0)+vec4(textureSize(t,0).xyxy);
})"},
    {Stage::fragment, "separr", R"(layout(binding=0) uniform texture2D t[3]; layout(binding=1) uniform sampler s;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=texture(sampler2D(t[1],s),v.xy)+texture(sampler2D(t[2],s),v.xy);
})"},
    {Stage::fragment, "sepboth",
     R"(layout(binding=0) uniform texture2D t; layout(binding=1) uniform samplerShadow s;layout(binding=2) uniform sampler s2;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=vec4(texture(sampler2DShadow(t,s),v.xyz))+texture(sampler2D(t,s2),v.xy);
})"},
    {Stage::fragment, "sepshadow", R"(layout(binding=0) uniform texture2D t; layout(binding=1) uniform samplerShadow s;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=vec4(texture(sampler2DShadow(t,s),v.xyz));
})"},
    {Stage::fragment, "shaderclock", R"(#extension GL_ARB_shader_clock:require
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=vec4(clock2x32ARB(),0,0);
})"},
    {Stage::fragment, "shadowlod", R"(layout(binding=0) uniform sampler2DShadow t;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=vec4(textureLod(t,v.xyz,1.0),textureProj(t,v),textureGrad(t,v.xyz,v.xy,v.zw),textureOffset(t,v.xyz,ivec2(1)));
})"},
    {Stage::compute, "shared", R"(layout(local_size_x=8) in;
shared float s[64]; layout(binding=0) buffer B{float d[];};
void main(){
s[gl_LocalInvocationIndex]=d[gl_GlobalInvocationID.x]; barrier(); memoryBarrierShared(); d[gl_GlobalInvocationID.x]=s[7-gl_LocalInvocationIndex]; groupMemoryBarrier();
})"},
    {Stage::fragment, "shared_ubo2",
     R"(layout(set=1,binding=0) uniform A{vec4 a;}; layout(set=2,binding=0) uniform B{vec4 b;}; layout(set=3,binding=4) uniform sampler2D t;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=a+b+texture(t,v.xy);
})"},
    {Stage::fragment, "specconst",
     R"(layout(constant_id=3) const int N=4; layout(constant_id=4) const float F=1.5; layout(constant_id=5) const bool Q=true;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
float a[N]; for(int i=0;i<N;i++) a[i]=v.x*F+float(i); o=vec4(a[iv.x&3]); if(Q) o*=2.;
})"},
    {Stage::fragment, "ssbo",
     R"(layout(std430,binding=0) buffer B{float a[]; };layout(std430,binding=1) readonly buffer C{vec3 c[]; };
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=vec4(a.length(),c[iv.x]); a[0]=1.;
})"},
    {Stage::fragment, "ssboarr", R"(layout(std430,binding=0) buffer B{float a[]; } b[3];
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
b[1].a[2]=v.x; o=vec4(b[2].a[0]);
})"},
    {Stage::fragment, "structs", R"(struct S{vec3 a; float b[2]; mat3 m;}; S f(S s){ s.a*=2.; s.b[1]=s.m[0].x; return s;}
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
S s; s.a=v.xyz; s.b[0]=v.x; s.b[1]=v.y; s.m=mat3(v.x); S t[2]; t[0]=f(s); t[1]=f(t[0]); o=vec4(t[iv.x&1].a,t[1].b[1]);
})"},
    {Stage::fragment, "subborrow", R"(layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
uint c; uint s=usubBorrow(uv.x,uv.y,c); o=vec4(s,c,0,0);
})"},
    {Stage::fragment, "subgroup", R"(#extension GL_KHR_shader_subgroup_arithmetic:require
#extension GL_KHR_shader_subgroup_ballot:require
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=subgroupAdd(v)+vec4(subgroupBallot(v.x>0.));
})"},
    {Stage::fragment, "subpass", R"(layout(input_attachment_index=0,binding=0) uniform subpassInput s;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=subpassLoad(s);
})"},
    {Stage::fragment, "switch", R"(layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
switch(iv.x){case 0: o=v; break; case 1: o=v*2.; case 2: o=v*3.; break; default: o=vec4(0);} int i=0; do{ o+=v; if(o.x>10.) break; i++; }while(i<iv.y);
})"},
    {Stage::tess_control, "t",
     R"(layout(vertices=3) out; layout(location=0) in vec4 a[]; layout(location=0) out vec4 b[]; layout(location=1) patch out vec4 p; void main(){ b[gl_InvocationID]=a[gl_InvocationID]; gl_out[gl_InvocationID].gl_Position=gl_in[gl_InvocationID].gl_Position; gl_TessLevelOuter[0]=1.;gl_TessLevelOuter[1]=1.;gl_TessLevelOuter[2]=1.;gl_TessLevelInner[0]=1.; p=vec4(1); })"},
    {Stage::tess_evaluation, "t",
     R"(layout(triangles) in; layout(location=0) in vec4 a[]; layout(location=1) patch in vec4 p; layout(location=0) out vec4 b; void main(){ b=a[0]*gl_TessCoord.x+p; gl_Position=gl_in[0].gl_Position; })"},
    {Stage::fragment, "tex1d", R"(layout(binding=0) uniform sampler1D t;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=texture(t,v.x);
})"},
    {Stage::fragment, "tex1darr", R"(layout(binding=0) uniform sampler1DArray t;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=texture(t,v.xy);
})"},
    {Stage::fragment, "tex2darr", R"(layout(binding=0) uniform sampler2DArray t;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=texture(t,v.xyz);
})"},
    {Stage::fragment, "tex3d", R"(layout(binding=0) uniform sampler3D t;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=texture(t,v.xyz)+textureOffset(t,v.xyz,ivec3(1));
})"},
    {Stage::fragment, "texarr", R"(layout(binding=0) uniform sampler2D t[4];
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=texture(t[1],v.xy)+texture(t[3],v.xy);
})"},
    {Stage::fragment, "texarrdyn", R"(layout(binding=0) uniform sampler2D t[4]; layout(push_constant) uniform P{int i;};
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=texture(t[i],v.xy);
})"},
    {Stage::fragment, "texbuf", R"(layout(binding=0) uniform samplerBuffer b;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=texelFetch(b,iv.x);
})"},
    {Stage::fragment, "texms", R"(layout(binding=0) uniform sampler2DMS t;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=texelFetch(t,iv.xy,2)+vec4(textureSamples(t));
})"},
    {Stage::fragment, "texmsarr", R"(layout(binding=0) uniform sampler2DMSArray t;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=texelFetch(t,iv.xyz,2);
})"},
    {Stage::fragment, "texproj", R"(layout(binding=0) uniform sampler2D t;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=textureProj(t,v)+textureProjLod(t,v,1.)+textureGrad(t,v.xy,v.xy,v.zw);
})"},
    {Stage::fragment, "texsize", R"(layout(binding=0) uniform sampler2D t;layout(binding=1) uniform sampler2DArray u;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=vec4(textureSize(t,1),textureSize(u,0).z,0);
})"},
    {Stage::fragment, "uboarr", R"(layout(binding=0) uniform B{vec4 a; } b[3];
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=b[1].a+b[2].a;
})"},
    {Stage::fragment, "ubobool", R"(layout(binding=0) uniform A{bool b; bvec2 c; int i; uint u; ivec3 k;};
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=vec4(b?1.:0.,c.x?1.:0.,i,u)+vec4(k,1);
})"},
    {Stage::fragment, "ubolayout",
     R"(layout(std140,binding=0) uniform B{float a[3]; vec2 b[2]; mat3 m; mat2x3 n; layout(row_major) mat4x3 q; vec3 c; float d; bool e;} ;
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=vec4(a[1]+b[1].x+m[1].x+n[1].y+q[2].y+c.x+d+float(e));
})"},
    {Stage::fragment, "uboodd", R"(#extension GL_EXT_scalar_block_layout:require
layout(scalar,binding=0) uniform B{vec3 a; vec3 b; float c[4]; vec2 d;};
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=vec4(a*b,c[2])+d.xyxy;
})"},
    {Stage::fragment, "ubooffset", R"(layout(std140,binding=0) uniform B{layout(offset=32) vec4 a; layout(offset=64) float b;};
layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
o=a*b;
})"},
    {Stage::fragment, "umulx", R"(layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
layout(location=1) flat in ivec4 iv;
layout(location=2) flat in uvec4 uv;
void main(){
uint a,b; umulExtended(uv.x,uv.y,a,b); o=vec4(a,b,0,0);
})"},
    {Stage::vertex, "vbasic",
     R"(layout(location=0) in vec4 p; layout(location=1) in mat3 m; layout(location=4) in ivec2 k; layout(location=5) in uint u; layout(location=0) out vec4 o; layout(location=1) flat out ivec2 ok; layout(location=2) out uint ou;
void main(){
gl_Position=p; o=vec4(m[1],gl_VertexIndex+gl_InstanceIndex); ok=k; ou=u; gl_PointSize=2.;
})"},
    {Stage::vertex, "vclip", R"(out gl_PerVertex{vec4 gl_Position; float gl_ClipDistance[2]; float gl_CullDistance[1];};
void main(){
gl_Position=vec4(0); gl_ClipDistance[0]=1.; gl_ClipDistance[1]=1.; gl_CullDistance[0]=1.;
})"},
    {Stage::vertex, "vdraw", R"(#extension GL_ARB_shader_draw_parameters:require
void main(){
gl_Position=vec4(gl_BaseVertexARB,gl_BaseInstanceARB,gl_DrawIDARB,1);
})"},
    {Stage::vertex, "vinv", R"(layout(location=0) in vec4 p; invariant gl_Position;
void main(){
gl_Position=p*p+p;
})"},
    {Stage::vertex, "vlayer", R"(#extension GL_ARB_shader_viewport_layer_array:require
void main(){
gl_Position=vec4(1); gl_Layer=1; gl_ViewportIndex=1;
})"},
    {Stage::vertex, "vout",
     R"(layout(location=0) out VS{vec3 n; flat int k; mat2 m;} vs; layout(location=6) out vec4 a[2]; struct S{vec3 n; vec2 k;}; layout(location=8) out S s; layout(location=10) out vec2 c0; layout(location=10,component=2) out vec2 c1; layout(location=11) out double d;
void main(){
vs.n=vec3(1);vs.k=1;vs.m=mat2(1);a[0]=vec4(1);a[1]=vec4(2);s.n=vec3(1);s.k=vec2(1);c0=vec2(1);c1=vec2(2);gl_Position=vec4(1); d=1.0lf;
})"},
    {Stage::vertex, "vssbo", R"(layout(std430,binding=0) readonly buffer B{vec4 p[];}; layout(binding=1) uniform sampler2D h;
void main(){
gl_Position=p[gl_VertexIndex]+textureLod(h,vec2(0),0.);
})"},
    {Stage::vertex, "vviewidx", R"(#extension GL_EXT_multiview:require
void main(){
gl_Position=vec4(gl_ViewIndex);
})"},
    {Stage::fragment, "earlydepth", R"(layout(early_fragment_tests) in; layout(location=0) out vec4 o;
layout(location=0) in vec4 v;
void main(){
gl_FragDepth=v.x; o=v;
})"},
    {Stage::fragment, "outindex",
     R"(layout(location=0) out vec4 o[4]; layout(location=0) in vec4 v; layout(location=1) flat in int n;
void main(){
o[0]=o[1]=o[2]=o[3]=v; o[n]=v*2.0;
})"},
    {Stage::fragment, "interlock", R"(#extension GL_ARB_fragment_shader_interlock:require
layout(pixel_interlock_ordered) in; layout(binding=0) buffer B{uint n;}; layout(location=0) out vec4 o;
void main(){
beginInvocationInterlockARB(); n+=1u; endInvocationInterlockARB(); o=vec4(1);
})"},
    {Stage::fragment, "fragsize", R"(#extension GL_EXT_fragment_invocation_density:require
layout(location=0) out vec4 o;
void main(){
o=vec4(gl_FragSizeEXT,gl_FragInvocationCountEXT,1);
})"},
    {Stage::vertex, "vbarrier", R"(layout(location=0) in vec4 p;
void main(){
gl_Position=p; memoryBarrier(); gl_Position.x=1.0;
})"},
    {Stage::vertex, "vxfb",
     R"(layout(location=0) in vec4 p; layout(xfb_buffer=0,xfb_offset=0,xfb_stride=16,location=0) out vec4 q;
layout(xfb_buffer=1,xfb_offset=0,xfb_stride=16,location=1) out vec4 r;
void main(){
gl_Position=p; q=p; r=p;
})"},
    {Stage::vertex, "vstruct",
     R"(layout(location=0) in vec4 p; struct S { ivec2 a; vec2 b; };
layout(location=1) flat out S s; layout(location=4) noperspective out vec2 c;
void main(){
gl_Position=p; s.a=ivec2(p.xy); s.b=p.zw; c=p.xy;
})"},
    {Stage::fragment, "fstruct",
     R"(struct S { ivec2 a; vec2 b; };
layout(location=1) flat in S s; layout(location=0) out vec4 o;
void main(){
o=vec4(s.a,s.b);
})"},
    {Stage::fragment, "fstructs",
     R"(struct S { vec2 b; };
layout(location=1) flat in S s; layout(location=2) in S t; layout(location=0) out vec4 o;
void main(){
o=vec4(s.b,t.b);
})"},
};

}  // namespace kiln
