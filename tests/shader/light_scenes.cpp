#include "tests/shader/light_scenes.h"

#include "tests/support/test_scenes.h"

namespace tilefarm {

AreaLight quadLight(const glm::dvec3& centre, const glm::dvec3& u, const glm::dvec3& v, float radiance) {
    AreaLight light;
    light.position = centre;
    light.u = u;
    light.v = v;
    light.radiance = glm::vec3(radiance);
    return light;
}

AreaLight sphereLight(const glm::dvec3& centre, double radius, float radiance) {
    AreaLight light;
    light.shape = AreaShape::sphere;
    light.position = centre;
    light.radius = radius;
    light.radiance = glm::vec3(radiance);
    return light;
}

PunctualLight sunLight(const glm::vec3& direction, float angularRadius, float irradiance) {
    PunctualLight light;
    light.type = PunctualType::directional;
    light.direction = glm::normalize(direction);
    light.angularRadius = angularRadius;
    light.color = glm::vec3(irradiance);
    return light;
}

Environment oneTexelSun(uint32_t width, uint32_t height, uint32_t x, uint32_t y, float radiance) {
    Environment e = uniformEnvironment(glm::vec3(0), width, height);
    for (size_t c = 0; c < 3; ++c) e.image.rgbaFloat[4 * (size_t{y} * width + x) + c] = radiance;
    return e;
}

std::vector<LightScene> lightsWithExtent() {
    std::vector<LightScene> all;
    const auto add = [&](const char* name, const glm::dvec3& towards, double cosCone) -> Scene& {
        LightScene s;
        s.name = name;
        s.towards = glm::normalize(towards);
        s.cosCone = cosCone;
        s.scene.materials.push_back(matte(glm::vec3(0.5f)));
        all.push_back(s);
        return all.back().scene;
    };
    addMesh(
        add("triangle", {0.4, 1, 0.1}, 0.5),
        [] {
            Mesh mesh;
            mesh.positions = {{0, 1, -0.4f}, {0.9f, 1.2f, 0}, {0.2f, 1, 0.7f}};
            mesh.triangles = {{0, 1, 2}};
            return mesh;
        }(),
        matte(glm::vec3(0), glm::vec3(3)));
    {
        Scene& scene = add("texturedTriangles", {0, 1, 0}, 0.3);
        Material lamp = matte(glm::vec3(0), glm::vec3(4));
        scene.images.push_back({"bright corner",
                                2,
                                2,
                                {255, 255, 255, 255, 30, 30, 30, 255, 90, 90, 90, 255, 0, 0, 0, 255},
                                {}});
        lamp.emissionTexture.image = 0;
        addMesh(scene, quadMesh({-0.5f, 1, -0.5f}, {1, 0, 0}, {0, 0, 1}), lamp);
    }
    add("quad", {0.2, 1, 0}, -0.2).areaLights = {quadLight({0.3, 0.5, 0.1}, {0.6, 0.1, 0}, {0, 0, 0.5}, 2)};
    add("farQuad", {3, 8, 1}, 0.99).areaLights = {quadLight({3, 8, 1}, {0.2, 0, 0}, {0, 0.02, 0.3}, 100)};
    add("twoSidedQuad", {0, 1, 0.5}, -0.2).areaLights = {
        quadLight({0, 0.8, 0.5}, {0.4, 0, 0}, {0, 0.3, 0.4}, 2)};
    all.back().scene.areaLights[0].twoSided = true;
    add("sphere", {0.3, 1, 0.1}, 0.3).areaLights = {sphereLight({0.3, 1, 0.1}, 0.6, 2)};
    add("farSphere", {3, 8, 1}, 0.999).areaLights = {sphereLight({3, 8, 1}, 0.2, 300)};
    add("sun", {1, 2, 0.5}, 0.97).lights = {sunLight({-1, -2, -0.5}, 0.2f, 3)};
    add("tinySun", {1, 2, 0.5}, 0.99995).lights = {sunLight({-1, -2, -0.5}, 0.00465f, 3)};
    add("constantEnvironment", {0, 1, 0}, -1).environment = uniformEnvironment(glm::vec3(0.7f));
    add("sunInEnvironment", {0.754, 0.634, -0.166}, 0.95).environment = oneTexelSun(32, 16, 20, 4, 50);
    all.back().scene.environment.rotation = 1.1;
    return all;
}

std::string nameOfLight(const testing::TestParamInfo<size_t>& info) {
    return lightsWithExtent()[info.param].name;
}

}  // namespace tilefarm
