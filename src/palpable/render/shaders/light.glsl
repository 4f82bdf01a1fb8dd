// Light on the body: an ambient that is brighter from above, one key light, a little gloss.

/// Linear light of an sRGB colour, by x^2.2.
vec3 linear_of_srgb(vec3 c) { return pow(c, vec3(2.2)); }
vec3 srgb_of_linear(vec3 c) { return pow(c, vec3(1.0 / 2.2)); }

/// sRGB colour of a surface point.
///   albedo  sRGB of the material          n     unit normal, towards the viewer's side
///   key     unit vector to the key light  up    unit vector away from the desk
///   view    unit vector to the eye        brightness  of all light, 1 = a well lit room
vec3 lit(vec3 albedo, vec3 n, vec3 key, vec3 up, vec3 view, float brightness) {
  float sky = 0.5 + 0.5 * dot(n, up);
  // Wrapped by 0.25: light that enters soft material leaves it beyond the terminator.
  float diffuse = max((dot(n, key) + 0.25) / 1.25, 0.0);
  float gloss = pow(max(dot(n, normalize(key + view)), 0.0), 48.0);
  float rim = pow(1.0 - max(dot(n, view), 0.0), 4.0) * sky;
  vec3 light = vec3(0.30, 0.28, 0.27) + sky * vec3(0.26, 0.29, 0.33) +
               diffuse * vec3(0.82, 0.79, 0.74);
  vec3 color = linear_of_srgb(albedo) * light + vec3(0.13 * gloss + 0.10 * rim);
  return srgb_of_linear(min(color * brightness, vec3(1.0)));
}
