#version 460
// Scenes of triangles alone.
#extension GL_GOOGLE_include_directive : require

#include "scene.glsl"
#include "rng.glsl"
#include "sampling.glsl"
layout(push_constant) uniform PassBlock { PassConstants pass; };

bool acceptHit(uint primitive, vec2 barycentrics, uint key);
#include "intersect.glsl"
#include "texture.glsl"
#include "surface.glsl"
#include "material.glsl"
#include "camera.glsl"
#include "pixel_filter.glsl"
#include "integrators/raster_sample.glsl"
#include "integrators/raster_fragment.glsl"
