// Light on a body: that of the room, which is brighter from above, one lamp, and a little gloss.

/// Linear light of an sRGB colour, by x^2.2.
vec3 linear_of_srgb(vec3 c) { return pow(c, vec3(2.2)); }
vec3 srgb_of_linear(vec3 c) { return pow(c, vec3(1.0 / 2.2)); }

/// sRGB colour of a surface point.
///   albedo  sRGB of the material          n     unit normal, towards the viewer's side
///   key     unit vector to the lamp       up    unit vector away from the desk
///   view    unit vector to the eye        lamp  how much of the lamp arrives; 1: a window beside a desk
///   color   linear, of all light; 1: a well lit room
vec3 lit(vec3 albedo, vec3 n, vec3 key, vec3 up, vec3 view, float lamp, vec3 color) {
  float sky = 0.5 + 0.5 * dot(n, up);
  // The diffuse term extends slightly beyond the terminator, because light scatters within soft
  // material. Only slightly, since dents are visible mainly by grazing light.
  float diffuse = lamp * max((dot(n, key) + 0.1) / 1.1, 0.0);
  float gloss = lamp * pow(max(dot(n, normalize(key + view)), 0.0), 40.0);
  float rim = pow(1.0 - max(dot(n, view), 0.0), 4.0) * sky;
  vec3 light = mix(vec3(0.25, 0.22, 0.20), vec3(0.44, 0.47, 0.52), sky) +
               diffuse * vec3(0.80, 0.76, 0.70);
  vec3 c = linear_of_srgb(albedo) * light + vec3(0.09 * gloss + 0.06 * rim);
  return srgb_of_linear(min(c * color, vec3(1.0)));
}
