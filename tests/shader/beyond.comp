#version 460
// values[i] = table[i], far beyond the table's end: what GPU-assisted validation is there to see.
layout(local_size_x = 64) in;
layout(set = 0, binding = 0) uniform samplerBuffer table;
layout(set = 0, binding = 1) buffer Values { float values[]; };

void main() {
    uint i = gl_GlobalInvocationID.x;
    values[i] = texelFetch(table, int(i) * 1000).x;
}
