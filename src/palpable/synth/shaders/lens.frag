#version 450 core
// What some moments add to an exposure: light through the lens, linear. With LAYER defined a
// layer of movers lies over the picture.
uniform sampler2D ideal;     // encoded as the square root of light
#ifdef LAYER
uniform sampler2D layer;     // the same, and whether there is a mover
uniform mat3 ideal_from_layer;  // turns rays of the layer's moment into the ideal picture's
#endif
uniform sampler2D lens_map;  // per raw pixel: place in the ideal picture, px (pixel centre = 0)
uniform vec2 ideal_size;     // px
uniform vec2 ideal_centre;   // px, of the ideal camera
uniform float ideal_focal;   // px
uniform float weight;        // of each moment
uniform float row_offset;    // raw px by which the picture lies lower than the map says
uniform float moment_row;    // raw row that is read at the moment of the ideal picture
uniform vec3 turn_per_row;   // rad by which the camera turns from one row to the next
uniform int looks;               // moments
uniform mat3 ideal_from_moment[20];  // turn rays of the moments into the ideal picture's

out vec4 light;

// Where the ideal picture shows a ray, 0..1.
vec2 place(vec3 ray) {
  return (ray.xy / ray.z * ideal_focal + ideal_centre + 0.5) / ideal_size;
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  ivec2 last = textureSize(lens_map, 0) - 1;
  vec2 source = texelFetch(lens_map, pixel, 0).xy;
  int above = max(pixel.y - 1, 0);
  int below = min(pixel.y + 1, last.y);
  vec2 down = (texelFetch(lens_map, ivec2(pixel.x, below), 0).xy -
               texelFetch(lens_map, ivec2(pixel.x, above), 0).xy) / float(below - above);
  source -= row_offset * down;
  vec3 ray = vec3((source - ideal_centre) / ideal_focal, 1.0);
  ray -= cross((float(pixel.y) - moment_row) * turn_per_row, ray);
#ifdef LAYER
  vec4 mover = textureLod(layer, place(ideal_from_layer * ray), 0.0);
#endif
  vec3 sum = vec3(0.0);
  // Counted down, or Mesa unrolls the loop to the array's size and llvmpipe runs through all of it.
  for (int left = looks; left > 0; --left) {
    vec3 encoded = textureLod(ideal, place(ideal_from_moment[left - 1] * ray), 0.0).rgb;
#ifdef LAYER
    encoded = mover.rgb + (1.0 - mover.a) * encoded;
#endif
    sum += encoded * encoded;
  }
  light = vec4(weight * sum, 1.0);
}
