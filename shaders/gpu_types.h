// What host and shaders agree on: bindings, feature bits, record layouts. Included by both, so a
// change on one side cannot miss the other.
#ifndef TILEFARM_GPU_TYPES_H
#define TILEFARM_GPU_TYPES_H

#include "knobs.h"

#ifdef __cplusplus
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
namespace tilefarm::gpu {
using uint = uint32_t;
using vec2 = glm::vec2;
using vec3 = glm::vec3;
using vec4 = glm::vec4;
using uvec2 = glm::uvec2;
using uvec4 = glm::uvec4;
#define GPU_CONSTANT inline constexpr uint32_t
#else
#define GPU_CONSTANT const uint
#endif

// Bindings of path_trace.comp, in order. T: uniform texel buffer, S: storage buffer.
GPU_CONSTANT BINDING_NODES = 0;            // T rgba32ui BVH nodes, worker/bvh/bvh.h
GPU_CONSTANT BINDING_TRIANGLES = 1;        // T rgba32ui corners in leaf order
GPU_CONSTANT BINDING_PRIMITIVES = 2;       // T rgba32ui PrimitiveRecord
GPU_CONSTANT BINDING_VERTICES = 3;         // T rgba32ui VERTEX_TEXELS per vertex
GPU_CONSTANT BINDING_MATERIALS = 4;        // T rgba32ui MaterialRecord
GPU_CONSTANT BINDING_TEXTURES = 5;         // T rgba32ui TextureRecord
GPU_CONSTANT BINDING_TEXELS8 = 6;          // T rgba8unorm
GPU_CONSTANT BINDING_TEXELS32 = 7;         // T rgba32f  float textures, then nothing else
GPU_CONSTANT BINDING_LIGHTS = 8;           // T rgba32ui LightRecord
GPU_CONSTANT BINDING_LIGHT_ALIAS = 9;      // T rgba32ui AliasRecord per light
GPU_CONSTANT BINDING_PRIMITIVE_LIGHTS = 10;// T rgba32ui four light indices per texel, by primitive
GPU_CONSTANT BINDING_ENVIRONMENT = 11;     // T rgba32f  radiance, rows from the top
GPU_CONSTANT BINDING_ENVIRONMENT_ALIAS = 12;// T rgba32ui AliasRecord per texel
GPU_CONSTANT BINDING_ALBEDO_TABLES = 13;   // T rgba32f  see bsdf/albedo_table.glsl
GPU_CONSTANT BINDING_LIGHT_TREE = 14;      // T rgba32ui nodes of shaders/lights/light_tree.glsl
GPU_CONSTANT BINDING_SHAPES = 15;          // T rgba32ui ShapeRecord
GPU_CONSTANT BINDING_MATTES = 16;          // T rgba32ui ids of object and material, two primitives per texel
GPU_CONSTANT BINDING_PARAMETERS = 17;      // S FrameParameters; all bindings before it are texels
GPU_CONSTANT BINDING_TILES = 18;           // S uvec4 per tile: x, y, width, height
GPU_CONSTANT BINDING_FILM = 19;            // S per pixel FILM_TEXELS, PassPixel of shared/film/film.h, and further ones
GPU_CONSTANT BINDING_COUNTERS = 20;        // S COUNTER_*
// Of the raster integrator alone:
GPU_CONSTANT BINDING_VISIBILITY = 21;      // S uvec4 per pixel of a block: first texel in BINDING_TRIANGLES
GPU_CONSTANT BINDING_SHAPE_SLOTS = 22;     // S uint: vertices of triangles, then first texel of every shape

// Side of the blocks in which the raster integrator draws an image, pixels.
GPU_CONSTANT RASTER_BLOCK = 2048;

// Features, as numbers of bits: tables/features.py.
#include "gpu_features.h"

// Specialization constants of path_trace.comp.
GPU_CONSTANT SPEC_FEATURES = 0;
GPU_CONSTANT SPEC_VERTEX_TEXELS = 1;
GPU_CONSTANT SPEC_STACK_SIZE = 2;
GPU_CONSTANT SPEC_FEATURES_HIGH = 3;  // bits 32 and up
GPU_CONSTANT SPEC_COUNT = 4;

// Roughness α = perceptual roughness²; below this a lobe is a mirror (relMSE against α → 0 under 1e-3).
#define ALPHA_DELTA 1e-3

GPU_CONSTANT NO_INDEX = 0xffffffffu;

// Vertex texels: 0 normal.xyz, u0 | 1 v0, u1, v1, – | 2 tangent.xyz, handedness | 3 colour rgba.
// A scene stores the shortest prefix that its effects read (SPEC_VERTEX_TEXELS).
GPU_CONSTANT PRIMITIVE_TEXELS = 1;  // corner vertices i0, i1, i2, material
GPU_CONSTANT LIGHT_TREE_NODE_TEXELS = 6;  // LightTreeChild of the first child, then of the second
GPU_CONSTANT ALBEDO_TABLE_SIZE = 32;  // per side; a table has one more row, the averages

GPU_CONSTANT MATERIAL_DOUBLE_SIDED = 1u << 0;
GPU_CONSTANT MATERIAL_UNLIT = 1u << 1;
GPU_CONSTANT MATERIAL_MASK = 1u << 2;
GPU_CONSTANT MATERIAL_BLEND = 1u << 3;
GPU_CONSTANT MATERIAL_THIN = 1u << 4;      // transmission without refraction
GPU_CONSTANT MATERIAL_EMISSIVE = 1u << 5;
GPU_CONSTANT MATERIAL_BECKMANN = 1u << 6;  // neither of the two: GGX
GPU_CONSTANT MATERIAL_PHONG = 1u << 7;
GPU_CONSTANT MATERIAL_SCHLICK = 1u << 8;
GPU_CONSTANT MATERIAL_CONDUCTOR = 1u << 9;
GPU_CONSTANT MATERIAL_GTR1 = 1u << 10;
GPU_CONSTANT MATERIAL_DISNEY_DIFFUSE = 1u << 11;
GPU_CONSTANT MATERIAL_INTERFACE = 1u << 12;  // reflects or transmits by microfacets: calls for FEATURE_SPECULAR
GPU_CONSTANT MATERIAL_PANE = 1u << 13;       // thin-walled glass that may be smooth: light goes straight through
GPU_CONSTANT MATERIAL_SOLID_GLASS = 1u << 14;  // that may be smooth: behind it no path finds a light without extent
GPU_CONSTANT MATERIAL_COINCIDENT = 1u << 15;   // faces of it coincide with others, and light goes through one of them

GPU_CONSTANT TEXTURE_WRAP_S_SHIFT = 0;     // two bits: 0 repeat, 1 mirror, 2 clamp
GPU_CONSTANT TEXTURE_WRAP_T_SHIFT = 2;
GPU_CONSTANT TEXTURE_LINEAR_FILTER = 1u << 4;
GPU_CONSTANT TEXTURE_SRGB = 1u << 5;
GPU_CONSTANT TEXTURE_UV1 = 1u << 6;
GPU_CONSTANT TEXTURE_FLOAT = 1u << 7;
GPU_CONSTANT TEXTURE_TRANSFORM = 1u << 8;

GPU_CONSTANT SHAPE_SPHERE = 0;     // radius `size.x` around `centre`; round in world space
GPU_CONSTANT SHAPE_ELLIPSOID = 1;  // the unit sphere, as all below in the shape's own space
GPU_CONSTANT SHAPE_BOX = 2;        // the cube of side 2
GPU_CONSTANT SHAPE_RECTANGLE = 3;  // the square of side 2 in z = 0, its front towards +z
GPU_CONSTANT SHAPE_DISK = 4;       // the unit disk in z = 0, its front towards +z
GPU_CONSTANT SHAPE_CYLINDER = 5;   // along y, capped: half height, radius at the bottom, at the top
GPU_CONSTANT SHAPE_CAPSULE = 6;    // hull of two spheres on the y axis: half their distance, radii below and above
GPU_CONSTANT SHAPE_FIELD = 7;      // where a signed distance is zero: step scale, size
GPU_CONSTANT SHAPE_MIRRORED = 1u << 0;  // the transform's determinant is negative

// Instructions of a field (shaders/shapes/field.glsl), with their parameters.
GPU_CONSTANT FIELD_SPHERE = 0;      // radius
GPU_CONSTANT FIELD_BOX = 1;         // half sides, radius of the rounding
GPU_CONSTANT FIELD_TORUS = 2;       // around y: radius of the ring, of the tube
GPU_CONSTANT FIELD_CONE = 3;        // along y: half height, radius at the bottom, at the top
GPU_CONSTANT FIELD_MANDELBULB = 4;  // power, iterations
GPU_CONSTANT FIELD_UNION = 5;       // of two; length over which it is smoothed
GPU_CONSTANT FIELD_INTERSECTION = 6;
GPU_CONSTANT FIELD_DIFFERENCE = 7;  // the first without the second
GPU_CONSTANT FIELD_TEXELS = 3;
GPU_CONSTANT FIELD_STACK = 8;       // distances waiting at once, at most

// Kinds of light: tables/lights.py.
#include "gpu_light_kinds.h"

// References of the light tree: the first texel of an inner node, or this with the index of a light.
GPU_CONSTANT LIGHT_TREE_LEAF = 0x80000000u;
GPU_CONSTANT LIGHT_TREE_DEPTH = 32;            // inner nodes above any light, at most: bits of a trail
GPU_CONSTANT LIGHT_TREE_TWO_SIDED = 1u << 0;   // flags of a child
GPU_CONSTANT LIGHT_TREE_INFINITE = 1u << 1;    // lights of no place: environment, directional, sun
GPU_CONSTANT LIGHT_TREE_BALANCED = 1u << 2;    // of both children: neither gets less than LIGHT_TREE_LEAST
#define LIGHT_TREE_LEAST 0.2

// FrameParameters::cullingKind
GPU_CONSTANT CULLING_NONE = 0;
GPU_CONSTANT CULLING_CAMERA = 1;
GPU_CONSTANT CULLING_ALL = 2;

// FrameParameters::view
GPU_CONSTANT VIEW_ALBEDO = 0;
GPU_CONSTANT VIEW_NORMAL = 1;            // shading normal on the camera's side; -1 … 1 as 0 … 1
GPU_CONSTANT VIEW_GEOMETRIC_NORMAL = 2;  // likewise
GPU_CONSTANT VIEW_DEPTH = 3;             // m along the camera ray
GPU_CONSTANT VIEW_UV = 4;                // of the first set, fractions
GPU_CONSTANT VIEW_MATERIAL = 5;          // a colour for each
GPU_CONSTANT VIEW_OBJECT = 6;            // likewise, by the ids of BINDING_MATTES

// FrameParameters::filterKind
GPU_CONSTANT FILTER_PIXEL = 0;  // the box of one pixel
GPU_CONSTANT FILTER_BOX = 1;
GPU_CONSTANT FILTER_POINT = 2;  // the pixel's centre
GPU_CONSTANT FILTER_TENT = 3;
GPU_CONSTANT FILTER_GAUSSIAN = 4;
GPU_CONSTANT FILTER_BLACKMAN_HARRIS = 5;

// FrameParameters::samplerKind
GPU_CONSTANT SAMPLER_RANDOM = 0;
GPU_CONSTANT SAMPLER_STRATIFIED = 1;
GPU_CONSTANT SAMPLER_SOBOL = 2;

GPU_CONSTANT FILM_TEXELS = 4;  // of a pixel, before what a job asks for beside
// Texels of FEATURE_LIGHT_PATHS: direct light, then indirect, by what scattered it first as seen from the camera.
GPU_CONSTANT LIGHT_PATH_EMISSION = 0;  // from lights and environment straight to the camera
GPU_CONSTANT LIGHT_PATH_DIFFUSE = 1;
GPU_CONSTANT LIGHT_PATH_SPECULAR = 3;
GPU_CONSTANT LIGHT_PATH_TRANSMISSION = 5;
GPU_CONSTANT LIGHT_PATH_VOLUME = 7;    // fog
GPU_CONSTANT LIGHT_PATH_COUNT = 9;
// Of FEATURE_CRYPTOMATTE: pairs of id and samples, two in a texel, of objects and then of materials.
GPU_CONSTANT MATTE_RANKS = 6;
GPU_CONSTANT MATTE_TEXELS = MATTE_RANKS / 2;

// Panes in a row that light crosses straight on, at most. The next ends a shadow ray, and for a path it is a bounce.
GPU_CONSTANT MOST_PANES = 64;

// FrameParameters::rouletteRule, directionSampling
GPU_CONSTANT ROULETTE_THROUGHPUT = 0;
GPU_CONSTANT ROULETTE_CONSTANT = 1;
GPU_CONSTANT ROULETTE_NONE = 2;
GPU_CONSTANT DIRECTION_BSDF = 0;
GPU_CONSTANT DIRECTION_COSINE = 1;
GPU_CONSTANT DIRECTION_UNIFORM = 2;

// FrameParameters::lightSelection: how lights are chosen, and weighed against the BSDF. By data beside the bits of FEATURE_*:
// a kernel may hold the code of several ways.
GPU_CONSTANT LIGHTS_BY_TREE = 1u << 0;
GPU_CONSTANT LIGHTS_ALL = 1u << 1;
GPU_CONSTANT LIGHTS_ALONE = 1u << 2;
GPU_CONSTANT LIGHTS_BY_BSDF = 1u << 3;

GPU_CONSTANT CAMERA_KEYS = 33;       // at most
GPU_CONSTANT CAMERA_KEY_VECTORS = 3;

// FrameParameters::cameraKind
#define CAMERA_PERSPECTIVE 0.0
#define CAMERA_ORTHOGRAPHIC 1.0
#define CAMERA_PANORAMA 2.0

// Words of the counter buffer, zeroed before every dispatch.
GPU_CONSTANT COUNTER_DROPPED_SAMPLES = 0;
GPU_CONSTANT COUNTER_RECORDED = 2;      // dropped samples that had a place below, and those that had none
GPU_CONSTANT COUNTER_FIRST_DROPPED = 4; // of the first of them: pixel (x + 65536 y), sample index
GPU_CONSTANT RECORDED_SAMPLES = 8;
GPU_CONSTANT COUNTER_COUNT = COUNTER_FIRST_DROPPED + 2 * RECORDED_SAMPLES;
// Behind them, of each tile of the dispatch:
GPU_CONSTANT TILE_REJECTED = 0;   // paths that ended on a direction without probability or in too many solids
GPU_CONSTANT TILE_TRUNCATED = 1;  // paths that still carried light where the bounce limit ended them
GPU_CONSTANT TILE_CLAMPED = 2;    // samples that FEATURE_CLAMP bounded
GPU_CONSTANT TILE_BEHIND_GLASS = 3;  // samples of lights without extent that ended at smooth solid glass
// Sums in fixed point: SUM_LIMBS words that count 2^-32, 2^-20, 2^-8 … (shaders/counters.glsl).
GPU_CONSTANT SUM_LIMB_BITS = 12;
GPU_CONSTANT SUM_LIMBS = 6;
#define EXACT_SUM_LARGEST 2147483648.0       // of one term: 2^31
GPU_CONSTANT TILE_CLAMPED_RADIANCE = 4;      // luminance that FEATURE_CLAMP took away, summed over samples
GPU_CONSTANT TILE_TRUNCATED_THROUGHPUT = TILE_CLAMPED_RADIANCE + SUM_LIMBS;  // largest channel of what truncated paths carried
GPU_CONSTANT TILE_RAYS = TILE_TRUNCATED_THROUGHPUT + SUM_LIMBS;
GPU_CONSTANT TILE_COUNTERS = TILE_RAYS + SUM_LIMBS;

// Of FEATURE_TRACE and FEATURE_FAULT_INJECTION.
GPU_CONSTANT TRACE_TEXELS = 3;  // position, t | throughput on arrival, pdf | radiance so far, primitive; the last: t < 0
GPU_CONSTANT INJECTION_THRESHOLD = 42950;  // of 2^32

// Records of the texel buffers: tables/records.py.
#include "gpu_records.h"

// Constant for all passes of a frame. World space is the re-centred one of worker/scene/world.h.
#ifdef __cplusplus
struct alignas(16) FrameParameters {  // a whole number of texels, as GLSL counts a block
#else
struct FrameParameters {
#endif
    vec3 cameraOrigin; float unusedOrigin;
    vec3 cameraForward;    // perspective: unit view direction
    float cameraKind;      // CAMERA_*
    vec3 cameraRight;      // half width of the image plane at distance 1 (perspective) or in metres
    float unusedRight;
    vec3 cameraUp;         // half height in the same unit
    float unusedUp;
    uvec2 imageSize;
    uint seed, frame;
    uint maxBounces, rouletteStart, lightCount;
    uint environmentLight;  // index of the environment among the lights, or NO_INDEX
    uvec2 environmentSize;
    uint firstSun, sunCount;  // lights of LIGHT_SUN, one after the other
    float environmentInverseWeight;       // 1 / sum of texel weights
    float environmentTexelsPerSteradian;  // w·h / (2π²): where sin θ is 1
    float environmentTurns;               // its rotation
    float environmentHidden;              // 1: camera rays do not see it
    float lensRadius;                     // m, 0 for a pinhole
    float lensInverseFocus;               // 1/m
    float lensBlades, lensRotation;       // blades of the aperture; rad
    float filterKind, filterRadius;       // FILTER_*; pixels
    float unusedFilter0, unusedFilter1;
    uint samplerKind, strata;             // SAMPLER_*; per side
    uint cameraKeyCount;                  // 0 for a still camera
    uint unusedSampler;
    float shutterBegin, shutterLength;    // part of the shutter's time, of 1, that this scene stands for
    float unusedShutter0, unusedShutter1;
    uint rouletteRule, directionSampling;  // ROULETTE_*, DIRECTION_*
    float clampDirect, clampIndirect;      // of light that scattered once, and more often
    vec4 cameraKeys[CAMERA_KEYS * CAMERA_KEY_VECTORS];  // camera.glsl
    vec4 irradiance[9];                    // of the environment, integrators/ambient.glsl
    float occlusionDistance;               // m
    float view;                            // VIEW_*
    float nearPlane, farPlane;             // m, of the raster integrator
    vec3 fogLower; float fogAnisotropy;    // of the box that fog fills; g
    vec3 fogUpper; float fogPresent;         // 1 if there is fog
    vec3 fogScattering; float unusedScattering;  // 1/m
    vec3 fogAbsorption; float unusedAbsorption;  // 1/m
    uvec4 cameraMedia;                     // solids around the camera, path/media_stack.glsl
    uint cullingKind, cameraClips;         // CULLING_*; 1 if the camera clips
    vec2 clipping;                         // where it does: from, to, m along the view direction
    uint mediaNest;                        // 1 if a ray may be in several solids, or starts in one
    uint lightSelection, lightGroups;      // LIGHTS_*; groups that LIGHTS_ALL asks
    float extent;                          // m that holds every coordinate and distance of the scene
#define GPU_MEMBER(settingType, type, name, value) type name;
    KERNEL_KNOBS(GPU_MEMBER)
#undef GPU_MEMBER
};

// A dispatch renders `sampleCount` samples of every pixel of its tiles: firstSample, firstSample + sampleStride, …
struct PassConstants {
    uint firstSample;
    uint sampleCount;
    uint sampleStride;
    uint continued;  // 0: the film is cleared first
    uint tileSize;   // film pixels are tile after tile, tileSize² each
    uint block;      // of RASTER_BLOCK² pixels, row by row, that the raster integrator draws
    uint firstRow;   // of the tiles
};

#ifdef __cplusplus
static_assert(offsetof(FrameParameters, extent) == 476 + 16 * CAMERA_KEYS * CAMERA_KEY_VECTORS);
static_assert(sizeof(PassConstants) == 28);

/// The mask of one FEATURE_*.
constexpr uint64_t bit(uint32_t feature) {
    return uint64_t{1} << feature;
}
}  // namespace tilefarm::gpu
#endif
#undef GPU_CONSTANT
#endif
