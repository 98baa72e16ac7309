// The scene's buffers, and the effects that this kernel holds.
#ifndef SCENE_GLSL
#define SCENE_GLSL

#include "gpu_types.h"
#include "load.glsl"

layout(constant_id = SPEC_FEATURES) const uint FEATURES = 0xffffffffu;
layout(constant_id = SPEC_FEATURES_HIGH) const uint FEATURES_HIGH = 0xffffffffu;
layout(constant_id = SPEC_VERTEX_TEXELS) const uint VERTEX_TEXELS = 4u;

layout(constant_id = SPEC_STACK_SIZE) const uint kBvhStackSize = 64u;
const bool kBvhNonOpaque = (FEATURES >> FEATURE_CUTOUT & 1u) != 0u;
const bool kBvhCulls = (FEATURES_HIGH >> (FEATURE_CULLING - 32u) & 1u) != 0u;
const bool kBvhShapes = (FEATURES_HIGH >> (FEATURE_SHAPES - 32u) & 1u) != 0u;
const bool kBvhFields = (FEATURES_HIGH >> (FEATURE_FIELDS - 32u) & 1u) != 0u;
const bool kBvhCoincident = (FEATURES_HIGH >> (FEATURE_COINCIDENT_FACES - 32u) & 1u) != 0u;

// Macros, so that their values are specialization constants and a compiler drops what hangs on them before it looks
// inside. (Chains of three has() with || are beyond glslang 12: it takes the outer one for a constant. Use featureBit.)
#define featureBit(feature) (((feature) < 32u ? FEATURES : FEATURES_HIGH) >> ((feature) & 31u) & 1u)
#define has(feature) (featureBit(feature) != 0u)

layout(binding = BINDING_NODES) uniform usamplerBuffer bvhNodes;
layout(binding = BINDING_TRIANGLES) uniform usamplerBuffer bvhTriangles;
layout(binding = BINDING_PRIMITIVES) uniform usamplerBuffer primitiveTexels;
layout(binding = BINDING_VERTICES) uniform usamplerBuffer vertexTexels;
layout(binding = BINDING_MATERIALS) uniform usamplerBuffer materialTexels;
layout(binding = BINDING_TEXTURES) uniform usamplerBuffer textureTexels;
layout(binding = BINDING_TEXELS8) uniform samplerBuffer texels8;
layout(binding = BINDING_TEXELS32) uniform samplerBuffer texels32;
layout(binding = BINDING_LIGHTS) uniform usamplerBuffer lightTexels;
layout(binding = BINDING_LIGHT_ALIAS) uniform usamplerBuffer lightAliasTexels;
layout(binding = BINDING_PRIMITIVE_LIGHTS) uniform usamplerBuffer primitiveLightTexels;
layout(binding = BINDING_ENVIRONMENT) uniform samplerBuffer environmentTexels;
layout(binding = BINDING_ENVIRONMENT_ALIAS) uniform usamplerBuffer environmentAliasTexels;
layout(binding = BINDING_ALBEDO_TABLES) uniform samplerBuffer albedoTexels;

layout(binding = BINDING_LIGHT_TREE) uniform usamplerBuffer lightTreeTexels;
layout(binding = BINDING_SHAPES) uniform usamplerBuffer shapeTexels;

#include "gpu_readers.glsl"

layout(std430, binding = BINDING_PARAMETERS) readonly buffer Parameters { FrameParameters parameters; };

#endif
