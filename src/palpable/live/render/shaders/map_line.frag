#version 450 core
flat in vec3 paint;
flat in float reach;
flat in float length_px;
noperspective in vec2 along_across;

uniform float opacity;  // 0 .. 1

layout(location = 0) out vec4 color;  // premultiplied

void main() {
  float beyond = along_across.x - clamp(along_across.x, 0.0, length_px);
  float cover = clamp(reach + 0.5 - length(vec2(beyond, along_across.y)), 0.0, 1.0) * opacity;
  if (cover == 0.0) discard;
  color = vec4(paint * cover, cover);
}
