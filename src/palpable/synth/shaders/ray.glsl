// Where a raw pixel looks. Eyes look along Z with Y down.
uniform sampler2D lens_map;  // per raw pixel: place in the ideal picture, px (pixel centre = 0)
uniform vec2 ideal_size;     // px
uniform vec2 ideal_centre;   // px, of the ideal camera
uniform float ideal_focal;   // px
uniform float row_offset;    // raw px by which the picture lies lower than the map says

// Where the ideal picture shows a ray, 0..1.
vec2 place(vec3 ray) {
  return (ray.xy / ray.z * ideal_focal + ideal_centre + 0.5) / ideal_size;
}

vec3 ray_of(ivec2 pixel) {
  vec2 source = texelFetch(lens_map, pixel, 0).xy;
  int above = max(pixel.y - 1, 0);
  int below = min(pixel.y + 1, textureSize(lens_map, 0).y - 1);
  vec2 down = (texelFetch(lens_map, ivec2(pixel.x, below), 0).xy -
               texelFetch(lens_map, ivec2(pixel.x, above), 0).xy) / float(below - above);
  source -= row_offset * down;
  return vec3((source - ideal_centre) / ideal_focal, 1.0);
}
