#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "scene_material.h"
#include "worker/scene/scene_warning.h"
#include "worker/scene/shapes.h"
#include "worker/scene/texture_ref.h"

/// A scene as plain values, free of glTF and of Vulkan. World space is metres, y up, right handed.
namespace tilefarm {

/// Pixels of one texture image, top row first. Exactly one of the two is filled.
struct Image {
    std::string name;
    uint32_t width = 0, height = 0;
    std::vector<uint8_t> rgba8;    // 4 per pixel, as stored in the file
    std::vector<float> rgbaFloat;  // 4 per pixel, linear (16-bit and HDR sources)
};

enum class AlphaMode : uint32_t { opaque, mask, blend };

/// glTF metallic-roughness material with the extensions that the renderer knows. Its parameters:
/// shaders/tables/materials.py.
struct Material : MaterialParameters {
    std::string name;
    AlphaMode alphaMode = AlphaMode::opaque;
    bool doubleSided = false;
    bool unlit = false;
};

/// Whether light is refracted into what lies behind its surface, or scattered there, and absorbed within.
inline bool isSolid(const Material& m) {
    return m.thickness > 0 && (m.transmission > 0 || m.diffuseTransmission > 0) && !m.unlit;
}

/// Triangles of one primitive with one material in object space. Attribute arrays are empty or as
/// long as `positions`.
struct Mesh {
    std::string name;
    bool open = false;  // it encloses nothing: its material is thin-walled here
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;   // empty: flat
    std::vector<glm::vec4> tangents;  // MikkTSpace; w is the handedness; for normal maps and anisotropy
    std::vector<glm::vec2> uv0, uv1;
    std::vector<glm::vec4> colors;  // linear, multiply the base colour and alpha
    std::vector<glm::uvec3> triangles;
    uint32_t material = 0;
};

struct Instance {
    uint32_t mesh = 0;
    glm::dmat4 toWorld{1};  // composed in double
    std::string node;
    uint32_t nodeIndex = kNone;  // in the file; instances of one node are one light where they emit
};

enum class PunctualType : uint32_t { point, spot, directional };

/// KHR_lights_punctual.
struct PunctualLight {
    PunctualType type = PunctualType::point;
    glm::vec3 color{1};  // linear, times intensity: W/sr (point, spot) or W/m² (directional) up to 683 lm/W
    glm::dvec3 position{0};
    glm::vec3 direction{0, 0, -1};  // away from the light, unit length
    float range = std::numeric_limits<float>::infinity();
    float innerCone = 0, outerCone = 0.785398163f;  // half angles, rad
    float angularRadius = 0;  // rad, directional: 0 is a delta; then `color` is still W/m²
    std::string name;
};

enum class AreaShape : uint32_t { quad, sphere };

/// A light with a surface of its own that rays meet.
struct AreaLight {
    AreaShape shape = AreaShape::quad;
    glm::dvec3 position{0};                 // of the centre
    glm::dvec3 u{0.5, 0, 0}, v{0, 0.5, 0};  // quad: half edges; it emits towards u × v
    double radius = 0.5;                    // sphere, m
    glm::vec3 radiance{1};                  // W/(sr m²)
    bool twoSided = false;                  // quad
    std::string name;
};

/// Equirectangular radiance, top row towards +y; column 0 starts at the seam (see
/// shaders/lights/environment.glsl).
struct Environment {
    Image image;          // rgbaFloat
    double rotation = 0;  // rad around +y, counter-clockwise seen from above
    bool visible = true;  // to camera rays
    std::string name;
};

/// A homogeneous medium outside of solids, within a box. Of no extinction: there is none.
struct Fog {
    glm::dvec3 extinction{0};  // 1/m
    glm::dvec3 albedo{1};      // share of it that scatters
    double anisotropy = 0;     // g of Henyey and Greenstein
    struct Box {
        glm::dvec3 lower{0}, upper{0};
    };
    std::optional<Box> box;  // none: around all surfaces and the camera
    explicit operator bool() const { return extinction != glm::dvec3(0); }
};

struct Camera {
    std::string name;
    std::string node;  // name of the node that places it
    bool orthographic = false;
    glm::dmat4 toWorld{1};  // looks along -z, y up; a rotation and a translation, no scale
    float yfov = 0.8f;      // rad, perspective; full angle
    float aspect = 0;       // width / height, 0: the image's own
    float ymag = 1;         // half height in metres, orthographic
    float xmag = 1;
    float znear = 0;  // m along the view direction, as the file has it
    float zfar = std::numeric_limits<float>::infinity();
    bool clips = false;        // what lies before znear or beyond zfar is not seen
    bool panorama = false;     // every direction, equirectangular
    float apertureRadius = 0;  // m, of a perspective camera's lens; 0: a pinhole
    float focusDistance = 1;   // m, to the plane in focus, along the view direction
    uint32_t blades = 0;       // sides of the aperture, 0: a circle
    float bladeRotation = 0;   // rad
};

/// A camera while the shutter is open: poses at even steps of time from its opening to its closing. One: it
/// stands still. Between them it turns at an even rate, around `pivot` if there is one, else around itself.
struct CameraPath {
    std::vector<Camera> keys;
    std::optional<glm::dvec3> pivot;
};

struct Scene {
    std::vector<Image> images;
    std::vector<Material> materials;  // at least one
    std::vector<Mesh> meshes;
    std::vector<Instance> instances;
    std::vector<Shape> shapes;
    std::vector<PunctualLight> lights;
    std::vector<AreaLight> areaLights;
    std::vector<Camera> cameras;
    Environment environment;  // no pixels: none
    Fog fog;
    std::vector<SceneWarning> warnings;
    uint64_t degenerateTriangles = 0;  // left out by the loader: repeated indices, zero area, not finite

    uint64_t sanitisedTexels = 0;  // of the environment, that were no radiance and are changed

    // Of what an animation does: a moment without light is then no fault of the file.
    bool lightChanges = false;  // to what a lamp or a surface emits
    bool sizesChange = false;   // to nodes

    bool hasEnvironment() const { return environment.image.width != 0; }
};

}  // namespace tilefarm
