#version 460
layout(constant_id = 0) const uint kAdded = 0u;
layout(push_constant) uniform Block { uint pushed; };
layout(location = 0) flat in uint number;
layout(location = 0) out uvec4 pixel;

void main() { pixel = uvec4(number, number + kAdded, pushed, floatBitsToUint(gl_FragCoord.z)); }
