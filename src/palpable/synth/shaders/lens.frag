#version 450 core
// What one moment adds to an exposure: light through the lens, linear.
uniform sampler2D ideal;     // encoded as the square root of light
uniform sampler2D lens_map;  // per raw pixel: place in the ideal picture, px (pixel centre = 0)
uniform vec2 ideal_size;     // px
uniform vec2 ideal_centre;   // px, of the ideal camera
uniform float ideal_focal;   // px
uniform float weight;        // of this moment
uniform float row_offset;    // raw px by which the picture lies lower than the map says
uniform float moment_row;    // raw row that is read at the moment of the ideal picture
uniform vec3 turn_per_row;   // rad by which the camera turns from one row to the next
uniform mat3 ideal_from_moment;  // turns rays of this moment into the ideal picture's

out vec4 light;

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
  ray = ideal_from_moment * ray;
  source = ray.xy / ray.z * ideal_focal + ideal_centre;
  vec3 encoded = textureLod(ideal, (source + 0.5) / ideal_size, 0.0).rgb;
  light = vec4(weight * encoded * encoded, 1.0);
}
