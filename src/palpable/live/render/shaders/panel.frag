#version 450 core
in vec2 uv;
in vec4 tint;
layout(binding = 0) uniform sampler2D ink;  // the letters' coverage
layout(location = 0) out vec4 color;

void main() {
  color = vec4(tint.rgb, tint.a * texture(ink, uv).r);
}
