#version 450 core
// The colour and metric depth of a body.
in vec3 x_in_camera;
in vec3 n_in_camera;
in float share;
in float marked;
in float shaded;

#include "color_map.glsl"
#include "light.glsl"

uniform vec3 key;          // camera frame, unit, towards the light
uniform vec3 up;           // camera frame, unit
uniform vec3 light_color;  // linear, 1 = a well lit room
uniform float lamp;        // strength, 1: a window beside a desk
uniform vec3 material;     // sRGB
uniform int scale;         // of colours, for fields with one sign (color_map.glsl)
uniform float opaque;      // share of the scale from which its colours cover the material
uniform vec3 mark_color;   // sRGB
uniform float opacity;     // 1: nothing is visible through it

layout(location = 0) out vec4 color;  // sRGB, premultiplied
layout(location = 1) out float z;     // m

void main() {
#ifdef TWO_SIDED
  vec3 albedo = two_sided_painted(material, share, opaque);
#else
  vec3 albedo = painted(material, share, opaque, scale);
#endif
  float soft = max(fwidth(marked), 1e-4);
  albedo = mix(albedo, mark_color, smoothstep(0.5 - soft, 0.5 + soft, marked));
  color = vec4(lit(albedo, normalize(n_in_camera), key, up, normalize(-x_in_camera),
                   lamp * (1.0 - shaded), light_color),
               1.0) * opacity;
  z = x_in_camera.z;
}
