#version 460
// values[i] = scale * values[i] + table[i % texels].x + offset, scale by specialization, offset by push constant.
layout(local_size_x = 64) in;
layout(constant_id = 0) const uint kUnused = 7u;
layout(constant_id = 1) const uint kScale = 1u;
layout(set = 0, binding = 0) uniform samplerBuffer table;
layout(set = 0, binding = 1) buffer Values { float values[]; };
layout(set = 0, binding = 2) uniform Parameters { uint count; };
layout(push_constant) uniform Push { float offset; };

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= count) return;
    values[i] = float(kScale) * values[i] + texelFetch(table, int(i) % textureSize(table)).x + offset + 0.0 * float(kUnused);
}
