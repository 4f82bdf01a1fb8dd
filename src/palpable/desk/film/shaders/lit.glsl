// The share of the sun's light that reaches p, whose coordinates are 0..1 across the map and in depth.
// Four comparisons, each filtered over 2 x 2 texels, give shadows a soft edge of about three texels.
float lit(sampler2DShadow map, vec3 p, float spread) {
  float sum = 0.0;
  sum += texture(map, p + vec3(-spread, -spread * 0.4, 0.0));
  sum += texture(map, p + vec3(spread * 0.4, -spread, 0.0));
  sum += texture(map, p + vec3(spread, spread * 0.4, 0.0));
  sum += texture(map, p + vec3(-spread * 0.4, spread, 0.0));
  return 0.25 * sum;
}
