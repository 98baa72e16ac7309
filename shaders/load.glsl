// The one way to read scene data: uniform texel buffers, 16 bytes at a time. Everything with structure is
// RGBA32UI (usamplerBuffer), floats through uintBitsToFloat, so that integers among the floats never pass a
// conversion that flushes denormals or quiets NaNs. A global-index buffer needs no descriptor indexing.
#ifndef TILEFARM_LOAD_GLSL
#define TILEFARM_LOAD_GLSL

#define LOAD(texels, index) texelFetch(texels, int(index))
#define LOAD_FLOATS(texels, index) uintBitsToFloat(texelFetch(texels, int(index)))

#endif
