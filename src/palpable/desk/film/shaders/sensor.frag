#version 450 core
// Lens and sensor: computes the raw picture from the ideal one (painted without a lens), with
// vignetting, gain and noise.
//
// Compiled with nothing defined for a picture of one instant, or with
//
//   ROWS     rows are read one after the other
//   EXPOSED  the mean of several instants (exposure.h)
//   LAYERS   EXPOSED, with pictures of movers in front of the still things
//   TURNS    EXPOSED, and the eye turns between the instants
//
// A "place" is a position in the ideal picture, 0..1 across it.
uniform sampler2D lens_map;  // for each raw pixel the place from which its light comes
// Pictures hold the square root of light.
#ifdef EXPOSED
uniform sampler2DArray stills;
uniform int references;  // pictures in `stills`
uniform int layers;      // pictures of movers for each of these
uniform float weight;    // 1 / number of samples
#else
uniform sampler2D ideal;
#endif
#ifdef ROWS
uniform float moment_row;  // the raw row that is read at the instant of the ideal picture
// Change of a homogeneous place from one row to the next, due to the camera's rotation.
uniform mat3 turn_per_row;
#endif
#ifdef LAYERS
uniform sampler2DArray movers;  // alpha: 1 where there is a mover
#endif
#ifdef TURNS
uniform int looks;  // instants per layer
// Homographies of places to the reference, from the instant of a look and from that of a layer.
uniform mat3 still_from_moment[30];
uniform mat3 still_from_layer[20];
#endif
uniform vec2 optical_centre; // raw px
uniform float corner_radius; // px, from the centre to the far corner
uniform float vignetting;    // share of the light lost there
uniform float gain;          // linear
uniform float noise;         // standard deviation of the luma, grey levels
uniform int noise_key;       // seed, eye and frame together

out vec4 raw;

// PCG3D (Jarzynski and Olano 2020): three random 32-bit numbers that depend on three integers.
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

// A nearly normal random number, of mean 0 and variance 1: the sum of four random bytes, scaled.
float normal_of(uint bits) {
  uint sum = (bits & 255u) + ((bits >> 8u) & 255u) + ((bits >> 16u) & 255u) + (bits >> 24u);
  return (float(sum) - 510.0) / 147.8;  // 2 sqrt((256^2 - 1) / 12)
}

vec2 place_of(ivec2 pixel) { return texelFetch(lens_map, pixel, 0).xy; }
vec2 flat_of(vec3 place) { return place.xy / place.z; }

#ifdef EXPOSED
// Loops count down. Loops that count up would be unrolled by Mesa to the sizes of the arrays, and its
// software renderer would execute all iterations.
vec3 encoded_light(ivec2 pixel) {
  vec2 here = place_of(pixel);
  vec3 sum = vec3(0.0);
  for (int reference = references - 1; reference >= 0; --reference) {
#ifndef TURNS
    vec3 still = textureLod(stills, vec3(here, reference), 0.0).rgb;
#endif
    for (int left = layers; left > 0; --left) {
      int layer = reference * layers + left - 1;
#ifdef TURNS
#ifdef LAYERS
      vec2 on_layer = flat_of(still_from_layer[layer] * vec3(here, 1.0));
      vec4 mover = textureLod(movers, vec3(on_layer, layer), 0.0);
#endif
      for (int look = looks - 1; look >= 0; --look) {
        vec2 at = flat_of(still_from_moment[layer * looks + look] * vec3(here, 1.0));
        vec3 still = textureLod(stills, vec3(at, reference), 0.0).rgb;
#else
#ifdef LAYERS
      vec4 mover = textureLod(movers, vec3(here, layer), 0.0);
#endif
      {
#endif
#ifdef LAYERS
        vec3 encoded = mover.rgb + (1.0 - mover.a) * still;
        sum += encoded * encoded;
#else
        sum += still * still;
#endif
      }
    }
  }
  return sqrt(weight * sum);
}
#else
vec3 encoded_light(ivec2 pixel) {
  vec2 at = place_of(pixel);
#ifdef ROWS
  vec3 here = vec3(at, 1.0);
  at = flat_of(here + (float(pixel.y) - moment_row) * (turn_per_row * here));
#endif
  return textureLod(ideal, at, 0.0).rgb;
}
#endif

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec3 encoded = encoded_light(pixel);
  vec2 off = (vec2(pixel) - optical_centre) / corner_radius;
  float falloff = gain * (1.0 - vignetting * dot(off, off));
  uvec3 bits = scatter(uvec3(uint(pixel.x), uint(pixel.y), uint(noise_key)));
  // After demosaicing, most of a camera's noise is common to the channels.
  float luma = 0.94 * normal_of(bits.x);
  vec3 color = 0.5 * vec3(normal_of(bits.y), normal_of(bits.z), normal_of(bits.y ^ (bits.z * 2654435769u)));
  raw = vec4(encoded * sqrt(falloff) + noise / 255.0 * (luma + color), 1.0);
}
