// What host and shaders agree on: bindings, feature bits, record layouts. Included by both, so a
// change on one side cannot miss the other.
#ifndef TILEFARM_GPU_TYPES_H
#define TILEFARM_GPU_TYPES_H

#ifdef __cplusplus
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

// Effects, as numbers of bits. Each bit compiles its code in; a scene that does not call for it pays nothing.
GPU_CONSTANT FEATURE_TEXTURES = 0;           // any texture but normal maps
GPU_CONSTANT FEATURE_NORMAL_MAPS = 1;
GPU_CONSTANT FEATURE_VERTEX_COLORS = 2;
GPU_CONSTANT FEATURE_CUTOUT = 3;             // alpha mask or blend
GPU_CONSTANT FEATURE_SPECULAR = 4;           // rough reflection: metals, dielectrics with ior ≠ 1
GPU_CONSTANT FEATURE_MIRROR = 5;             // α below ALPHA_DELTA: reflection and refraction as delta lobes
GPU_CONSTANT FEATURE_TRANSMISSION = 6;
GPU_CONSTANT FEATURE_ATTENUATION = 7;        // Beer–Lambert inside transmissive solids
GPU_CONSTANT FEATURE_EMISSIVE_TRIANGLES = 8;
GPU_CONSTANT FEATURE_PUNCTUAL_LIGHTS = 9;
GPU_CONSTANT FEATURE_ENVIRONMENT = 10;
GPU_CONSTANT FEATURE_UNLIT = 11;
GPU_CONSTANT FEATURE_ORTHOGRAPHIC = 12;
GPU_CONSTANT FEATURE_FLOAT_TEXTURES = 13;    // 16-bit and HDR textures
GPU_CONSTANT FEATURE_TEXTURE_TRANSFORMS = 14;
GPU_CONSTANT FEATURE_SECOND_UV_SET = 15;
GPU_CONSTANT FEATURE_NEAREST_FILTER = 16;
GPU_CONSTANT FEATURE_SPECULAR_COLOR = 17;       // strength, colour and tint of dielectric reflection
GPU_CONSTANT FEATURE_CLEARCOAT = 18;
GPU_CONSTANT FEATURE_SHEEN = 19;
GPU_CONSTANT FEATURE_ANISOTROPY = 20;
GPU_CONSTANT FEATURE_IRIDESCENCE = 21;
GPU_CONSTANT FEATURE_DISPERSION = 22;
GPU_CONSTANT FEATURE_DIFFUSE_TRANSMISSION = 23;
GPU_CONSTANT FEATURE_CONDUCTOR = 24;            // Fresnel from measured n and k
GPU_CONSTANT FEATURE_ENERGY_COMPENSATION = 25;  // scattering more than once between microfacets
GPU_CONSTANT FEATURE_OREN_NAYAR = 26;
GPU_CONSTANT FEATURE_DISNEY_DIFFUSE = 27;       // retro-reflection and flat subsurface approximation
GPU_CONSTANT FEATURE_DISNEY_SHEEN = 28;
GPU_CONSTANT FEATURE_GTR1 = 29;                 // Disney's distribution of the clearcoat
GPU_CONSTANT FEATURE_BECKMANN = 30;
GPU_CONSTANT FEATURE_PHONG = 31;
GPU_CONSTANT FEATURE_SCHLICK = 32;              // Schlick's curve for dielectrics
GPU_CONSTANT FEATURE_SPHERE_LIGHTS = 33;
GPU_CONSTANT FEATURE_QUAD_LIGHTS = 34;
GPU_CONSTANT FEATURE_SUN_LIGHTS = 35;           // directional with an angular size
GPU_CONSTANT FEATURE_LIGHT_TREE = 36;
GPU_CONSTANT FEATURE_ALL_LIGHTS = 37;           // every light at every surface point
GPU_CONSTANT FEATURE_SINGLE_SAMPLING = 38;      // no multiple importance sampling: lights alone, or the BSDF
GPU_CONSTANT FEATURE_GLASS_SHADOWS = 39;        // shadow rays look at the smooth glass that they meet
GPU_CONSTANT FEATURE_ENVIRONMENT_ROTATION = 40;
GPU_CONSTANT FEATURE_HIDDEN_ENVIRONMENT = 41;   // camera rays do not see it
GPU_CONSTANT FEATURE_SHAPES = 42;               // surfaces other than triangles
GPU_CONSTANT FEATURE_FIELDS = 43;               // shapes by signed distance
GPU_CONSTANT FEATURE_THIN_LENS = 44;            // depth of field
GPU_CONSTANT FEATURE_PANORAMA = 45;
GPU_CONSTANT FEATURE_CAMERA_MOTION = 46;        // the camera moves while the shutter is open
GPU_CONSTANT FEATURE_PIXEL_FILTER = 47;         // any but the box of one pixel
GPU_CONSTANT FEATURE_SOBOL_SAMPLER = 48;        // Owen-scrambled Sobol points
GPU_CONSTANT FEATURE_STRATIFIED_SAMPLER = 49;   // jittered grids
GPU_CONSTANT FEATURE_FOG = 50;                  // a medium outside of solids that absorbs and scatters
GPU_CONSTANT FEATURE_LIGHT_PATHS = 51;          // channels that a job asks for: light by its first scattering,
GPU_CONSTANT FEATURE_UV_CHANNEL = 52;           // texture coordinates,
GPU_CONSTANT FEATURE_CRYPTOMATTE = 53;          // ids of objects and materials
GPU_CONSTANT FEATURE_NESTED_MEDIA = 54;         // transmissive solids within others, or around the camera
GPU_CONSTANT FEATURE_CLAMP = 55;                // a bound on what a sample gathers at once
GPU_CONSTANT FEATURE_REGULARISATION = 56;       // a least α behind rough surfaces
GPU_CONSTANT FEATURE_DIRECTION_SAMPLING = 57;   // other than by the BSDF
GPU_CONSTANT FEATURE_SHADOW_DEPTH = 58;
GPU_CONSTANT FEATURE_ROULETTE_RULE = 59;        // other than by throughput
GPU_CONSTANT FEATURE_CULLING = 60;              // back faces or parts beyond clipping planes that rays pass
GPU_CONSTANT FEATURE_COINCIDENT_FACES = 61;     // faces that share a part of their plane
GPU_CONSTANT FEATURE_COUNT = 62;

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
GPU_CONSTANT MATERIAL_TEXELS = 18;
GPU_CONSTANT TEXTURE_TEXELS = 3;
GPU_CONSTANT LIGHT_TEXELS = 4;
GPU_CONSTANT LIGHT_TREE_NODE_TEXELS = 6;  // LightTreeChild of the first child, then of the second
GPU_CONSTANT LIGHT_TREE_CHILD_TEXELS = 3;
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
GPU_CONSTANT SHAPE_TEXELS = 8;
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

GPU_CONSTANT LIGHT_TRIANGLE = 0;
GPU_CONSTANT LIGHT_POINT = 1;
GPU_CONSTANT LIGHT_SPOT = 2;
GPU_CONSTANT LIGHT_DIRECTIONAL = 3;
GPU_CONSTANT LIGHT_ENVIRONMENT = 4;
GPU_CONSTANT LIGHT_QUAD = 5;
GPU_CONSTANT LIGHT_SPHERE = 6;
GPU_CONSTANT LIGHT_SUN = 7;

// References of the light tree: the first texel of an inner node, or this with the index of a light.
GPU_CONSTANT LIGHT_TREE_LEAF = 0x80000000u;
GPU_CONSTANT LIGHT_TREE_DEPTH = 32;            // inner nodes above any light, at most: bits of a trail
GPU_CONSTANT LIGHT_TREE_TWO_SIDED = 1u << 0;   // flags of a child
GPU_CONSTANT LIGHT_TREE_INFINITE = 1u << 1;    // lights of no place: environment, directional, sun
GPU_CONSTANT LIGHT_TREE_BALANCED = 1u << 2;    // of both children: neither gets less than LIGHT_TREE_LEAST
#define LIGHT_TREE_LEAST 0.2

// FrameParameters::culling.x
GPU_CONSTANT CULLING_NONE = 0;
GPU_CONSTANT CULLING_CAMERA = 1;
GPU_CONSTANT CULLING_ALL = 2;

// FrameParameters::integrator.y
GPU_CONSTANT VIEW_ALBEDO = 0;
GPU_CONSTANT VIEW_NORMAL = 1;            // shading normal on the camera's side; -1 … 1 as 0 … 1
GPU_CONSTANT VIEW_GEOMETRIC_NORMAL = 2;  // likewise
GPU_CONSTANT VIEW_DEPTH = 3;             // m along the camera ray
GPU_CONSTANT VIEW_UV = 4;                // of the first set, fractions
GPU_CONSTANT VIEW_MATERIAL = 5;          // a colour for each
GPU_CONSTANT VIEW_OBJECT = 6;            // likewise, by the ids of BINDING_MATTES

// FrameParameters::filtering.x
GPU_CONSTANT FILTER_PIXEL = 0;  // the box of one pixel
GPU_CONSTANT FILTER_BOX = 1;
GPU_CONSTANT FILTER_POINT = 2;  // the pixel's centre
GPU_CONSTANT FILTER_TENT = 3;
GPU_CONSTANT FILTER_GAUSSIAN = 4;
GPU_CONSTANT FILTER_BLACKMAN_HARRIS = 5;

// FrameParameters::sampling.x
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

// FrameParameters::rules.x, .y
GPU_CONSTANT ROULETTE_THROUGHPUT = 0;
GPU_CONSTANT ROULETTE_CONSTANT = 1;
GPU_CONSTANT ROULETTE_NONE = 2;
GPU_CONSTANT DIRECTION_BSDF = 0;
GPU_CONSTANT DIRECTION_COSINE = 1;
GPU_CONSTANT DIRECTION_UNIFORM = 2;

// FrameParameters::lights.x: how lights are chosen, and weighed against the BSDF. By data beside the bits of FEATURE_*:
// a kernel may hold the code of several ways.
GPU_CONSTANT LIGHTS_BY_TREE = 1u << 0;
GPU_CONSTANT LIGHTS_ALL = 1u << 1;
GPU_CONSTANT LIGHTS_ALONE = 1u << 2;
GPU_CONSTANT LIGHTS_BY_BSDF = 1u << 3;

GPU_CONSTANT CAMERA_KEYS = 33;       // at most
GPU_CONSTANT CAMERA_KEY_VECTORS = 3;

// FrameParameters::cameraForward.w
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

// For debugging: bits beyond FEATURE_COUNT, which nothing calls for and no report names.
GPU_CONSTANT FEATURE_TRACE = 62;           // writes what a path meets behind the films: TRACE_TEXELS a bounce
GPU_CONSTANT FEATURE_FAULT_INJECTION = 63; // makes one sample of 1e5 NaN
GPU_CONSTANT TRACE_TEXELS = 3;  // position, t | throughput on arrival, pdf | radiance so far, primitive; the last: t < 0
GPU_CONSTANT INJECTION_THRESHOLD = 42950;  // of 2^32

// Constant for all passes of a frame. World space is the re-centred one of worker/scene/world.h.
struct FrameParameters {
    vec4 cameraOrigin;    // xyz
    vec4 cameraForward;   // perspective: unit view direction
    vec4 cameraRight;     // half width of the image plane at distance 1 (perspective) or in metres
    vec4 cameraUp;        // half height, likewise
    uvec4 image;          // width, height, seed, frame
    uvec4 path;           // max bounces, roulette start, light count, environment light or NO_INDEX
    uvec4 environment;    // width, height, first LIGHT_SUN, number of LIGHT_SUN
    vec4 environmentPdf;  // x: 1 / sum of texel weights, y: w·h / (2π²), z: rotation in turns, w: 1 if hidden
    vec4 lens;            // x: radius m, 0 for a pinhole; y: 1 / focus distance; z: blades; w: their rotation, rad
    vec4 filtering;       // x: FILTER_*, y: radius in pixels
    uvec4 sampling;       // x: SAMPLER_*, y: strata per side, z: camera keys, 0 for a still one
    vec4 shutter;         // part of the shutter's time that this scene stands for: x: begin, y: length, of 1
    uvec4 rules;          // x: ROULETTE_*, y: DIRECTION_*, z: scatterings with shadows
    vec4 bounds;          // clamp of light that scattered x: once, y: more often; z: least α behind rough surfaces;
                          // w: survival of ROULETTE_CONSTANT
    vec4 cameraKeys[CAMERA_KEYS * CAMERA_KEY_VECTORS];  // camera.glsl
    vec4 irradiance[9];   // of the environment, integrators/ambient.glsl
    vec4 integrator;      // x: reach of ambient occlusion, m; y: VIEW_*; raster: z: near plane, w: far plane
    vec4 fogLower;        // xyz: of the box that it fills; w: anisotropy g
    vec4 fogUpper;        // xyz: likewise; w: 1 if there is fog
    vec4 fogScattering;   // rgb, 1/m
    vec4 fogAbsorption;   // rgb, 1/m
    uvec4 cameraMedia;    // solids around the camera, path/media_stack.glsl
    uvec4 culling;        // x: CULLING_*, y: 1 if the camera clips
    vec4 clipping;        // where it does: x: from, y: to, m along the view direction
    uvec4 nesting;        // x: 1 if a ray may be in several solids, or starts in one
    uvec4 lights;         // x: LIGHTS_*; y: groups that LIGHTS_ALL asks
    vec4 extent;          // x: m that holds every coordinate and distance of the scene
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
static_assert(sizeof(FrameParameters) == 544 + 16 * CAMERA_KEYS * CAMERA_KEY_VECTORS);
static_assert(sizeof(PassConstants) == 28);

// One per material; texel k holds bytes 16k … 16k + 15. What the members mean stands at Material
// (worker/scene/scene.h); texels from 7 on are read only where a feature asks for them.
struct MaterialRecord {
    vec3 baseColor; float alpha;                                                                  // 0
    vec3 emission; float alphaCutoff;                                                             // 1
    float metallic, roughness, normalScale, ior;                                                  // 2
    float transmission; uint flags; uint albedoTable; float dispersion;                           // 3
    vec3 absorption; float orenNayarSigma;                                                        // 4, σ_a 1/m, σ rad
    uint baseColorTexture, metallicRoughnessTexture, normalTexture, emissionTexture;              // 5
    uint transmissionTexture, specularTexture, specularColorTexture, clearcoatTexture;            // 6
    vec3 specularColor; float specular;                                                           // 7
    float clearcoat, clearcoatRoughness, clearcoatNormalScale, specularTint;                      // 8
    uint clearcoatRoughnessTexture, clearcoatNormalTexture, sheenColorTexture, sheenRoughnessTexture;  // 9
    vec3 sheenColor; float sheenRoughness;                                                        // 10
    float anisotropy, anisotropyCos, anisotropySin, subsurface;                                   // 11
    float iridescence, iridescenceIor, iridescenceThicknessMinimum, iridescenceThicknessMaximum;  // 12, nm
    uint anisotropyTexture, iridescenceTexture, iridescenceThicknessTexture, diffuseTransmissionTexture;  // 13
    vec3 diffuseTransmissionColor; float diffuseTransmission;                                     // 14
    vec3 conductorEta; float disneySheen;                                                         // 15
    vec3 conductorK; float disneySheenTint;                                                       // 16
    uint diffuseTransmissionColorTexture, coatTable, sheenTable; uint unused;                     // 17
};
static_assert(sizeof(MaterialRecord) == 16 * MATERIAL_TEXELS);

struct TextureRecord {
    uint firstTexel, width, height, flags;
    vec2 du, dv;  // uv' = du * u + dv * v + offset
    vec2 offset; uint unused[2];
};
static_assert(sizeof(TextureRecord) == 16 * TEXTURE_TEXELS);

// LIGHT_TRIANGLE: corner p, edges a and b, radiance. Punctual: position p, direction a, intensity
// (W/sr; W/m² for directional), b = (cos inner, cos outer, range). LIGHT_ENVIRONMENT: the rest unused.
// LIGHT_QUAD: corner p, edges a ⟂ b, radiance; emits towards a × b, `primitive` is 1 if both ways.
// LIGHT_SPHERE: centre p, a.x radius, radiance. LIGHT_SUN: direction a, b.x = 1 − cos θmax, radiance.
// `pmf` is the probability of being chosen where no tree chooses; with LIGHTS_ALL within the light's group.
struct LightRecord {
    uint type; uint primitive; float pmf; float area;
    vec3 p; float red;
    vec3 a; float green;
    vec3 b; float blue;
};
static_assert(sizeof(LightRecord) == 16 * LIGHT_TEXELS);

// A surface that is not made of triangles. World space is `centre` + toWorld · own space; rows of the matrices.
struct ShapeRecord {
    uint kind, material, flags, program;  // program: first texel of a field's instructions in the same buffer
    vec3 toShape0; float centreX;
    vec3 toShape1; float centreY;
    vec3 toShape2; float centreZ;
    vec3 toWorld0; float size0;
    vec3 toWorld1; float size1;
    vec3 toWorld2; float size2;
    vec3 extent; uint instructions;  // of a field: half sides of the box around the origin that holds it
};
static_assert(sizeof(ShapeRecord) == 16 * SHAPE_TEXELS);

// Walker's alias method: keep the index when 32 random bits are below `threshold`, else take `alias`.
// The table of lights also has each light's way down the light tree: bit k is set where it takes the second
// child of the k-th node. With LIGHTS_ALL there is a table for each group, all in one, and the k-th `trail` is the first
// light of the k-th group.
struct AliasRecord {
    uint threshold, alias; float pmf; uint trail;
};

// A subtree of lights: a sphere around them, a cone of half angle θo around `axis` with all their normals, the
// angle θe beyond their normals into which they still emit, and the sum of their greatest intensities
// (luminance, W/sr, in units of the largest of the scene). LIGHT_TREE_INFINITE: the cone holds the directions
// towards the lights and `intensity` is irradiance.
struct LightTreeChild {
    vec3 centre; float radius;
    vec3 axis; float intensity;
    float cosThetaO, cosThetaE; uint flags, reference;
};
static_assert(sizeof(LightTreeChild) == 16 * LIGHT_TREE_CHILD_TEXELS);

/// The mask of one FEATURE_*.
constexpr uint64_t bit(uint32_t feature) {
    return uint64_t{1} << feature;
}
}  // namespace tilefarm::gpu
#endif
#undef GPU_CONSTANT
#endif
