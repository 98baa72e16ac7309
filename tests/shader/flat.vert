#version 460
// Triangles from a buffer of (x, y, depth, number) per vertex, already in clip space.
layout(binding = 0) uniform samplerBuffer vertices;
layout(location = 0) flat out uint number;

void main() {
    vec4 v = texelFetch(vertices, gl_VertexIndex);
    gl_Position = vec4(v.xyz, 1);
    number = uint(v.w);
}
