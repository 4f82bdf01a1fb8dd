#version 450 core
// Lens and sensor: where each raw pixel's light comes from, vignetting, gain, noise. With EXPOSED
// defined the light was gathered before (lens.frag).
#ifdef EXPOSED
uniform sampler2D exposed;  // linear light, per raw pixel
#else
uniform sampler2D ideal;     // encoded as the square root of light
uniform sampler2D lens_map;  // per raw pixel: place in the ideal picture, px (pixel centre = 0)
uniform vec2 ideal_size;     // px
#endif
uniform vec2 optical_centre; // raw px
uniform float corner_radius; // px, from the centre to the far corner
uniform float vignetting;    // share of the light lost there
uniform float gain;          // linear
uniform float noise;         // standard deviation of the luma, grey levels
uniform int noise_key;       // seed, eye and frame together

out vec4 raw;

// PCG3D (Jarzynski and Olano 2020): three good 32-bit numbers for three integers.
uvec3 scatter(uvec3 v) {
  v = v * 1664525u + 1013904223u;
  v.x += v.y * v.z;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  v ^= v >> 16u;
  v.x += v.y * v.z;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  return v;
}

// The sum of four bytes is nearly normal; scaled to mean 0 and variance 1.
float normal_of(uint bits) {
  uint sum = (bits & 255u) + ((bits >> 8u) & 255u) + ((bits >> 16u) & 255u) + (bits >> 24u);
  return (float(sum) - 510.0) / 147.8;  // 2 sqrt((256^2 - 1) / 12)
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
#ifdef EXPOSED
  vec3 encoded = sqrt(texelFetch(exposed, pixel, 0).rgb);
#else
  vec2 source = texelFetch(lens_map, pixel, 0).xy;
  vec3 encoded = textureLod(ideal, (source + 0.5) / ideal_size, 0.0).rgb;
#endif
  vec2 off = (vec2(pixel) - optical_centre) / corner_radius;
  float falloff = gain * (1.0 - vignetting * dot(off, off));
  uvec3 bits = scatter(uvec3(uint(pixel.x), uint(pixel.y), uint(noise_key)));
  // Most of a camera's noise is common to the channels after demosaicing.
  float luma = 0.94 * normal_of(bits.x);
  vec3 color = 0.5 * vec3(normal_of(bits.y), normal_of(bits.z), normal_of(bits.y ^ (bits.z * 2654435769u)));
  raw = vec4(encoded * sqrt(falloff) + noise / 255.0 * (luma + color), 1.0);
}
