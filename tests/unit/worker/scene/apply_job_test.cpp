#include "worker/scene/apply_job.h"
#include "shared/job/job.h"

#include <gmock/gmock.h>

#include <limits>
#include <numbers>

#include "shared/job/conductor_names.h"
#include "tests/support/expect_error.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_scenes.h"
#include "worker/scene/conductors.h"
#include "worker/scene/load.h"
#include "worker/scene/material_override.h"

namespace tilefarm {
namespace {

using testing::HasSubstr;

constexpr double kPi = std::numbers::pi;

double distance(const glm::dvec3& a, const glm::dvec3& b) {
    return glm::length(a - b);
}

LightSettings light(LightKind kind) {
    LightSettings settings;
    settings.name = "added";
    settings.kind = kind;
    settings.intensity = 4;
    settings.color = {1, 0.5f, 0};
    return settings;
}

Scene applied(const JobSpec& job) {
    Scene scene;
    addMesh(scene, cubeMesh(false), matte(glm::vec3(0.5f)));
    addJobLights(scene, job);
    setJobEnvironment(scene, job, {});
    return scene;
}

TEST(JobLights, PunctualOnesTakeTheirUnitsAndAngles) {
    JobSpec job;
    LightSettings spot = light(LightKind::spot);
    spot.position = {1, 2, 3}, spot.direction = {0, 0, -5}, spot.innerCone = 10, spot.outerCone = 60;
    LightSettings sun = light(LightKind::directional);
    sun.angularDiameter = 0.5;
    job.lights = {spot, sun, light(LightKind::point)};
    const Scene scene = applied(job);
    ASSERT_EQ(scene.lights.size(), 3u);
    EXPECT_EQ(scene.lights[0].type, PunctualType::spot);
    EXPECT_EQ(scene.lights[0].color, glm::vec3(4, 2, 0));
    EXPECT_EQ(scene.lights[0].position, glm::dvec3(1, 2, 3));
    EXPECT_EQ(scene.lights[0].direction, glm::vec3(0, 0, -1));
    EXPECT_FLOAT_EQ(scene.lights[0].innerCone, static_cast<float>(kPi / 18));
    EXPECT_FLOAT_EQ(scene.lights[0].outerCone, static_cast<float>(kPi / 3));
    EXPECT_EQ(scene.lights[1].type, PunctualType::directional);
    EXPECT_EQ(scene.lights[1].direction, glm::vec3(0, -1, 0)) << "down where nothing else is said";
    EXPECT_FLOAT_EQ(scene.lights[1].angularRadius, static_cast<float>(0.25 / 180 * kPi));
    EXPECT_EQ(scene.lights[2].type, PunctualType::point);
    EXPECT_FALSE(scene.hasEnvironment()) << "there is light";
}

TEST(JobLights, QuadsShineAlongTheirDirection) {
    for (const std::array<double, 3>& direction :
         {std::array<double, 3>{0, 0, -1}, {0, -1, 0}, {0, 1, 0}, {3, -4, 12}, {1e-12, -1, 0}}) {
        JobSpec job;
        LightSettings quad = light(LightKind::quad);
        quad.position = {0, 5, 0}, quad.direction = direction, quad.width = 3, quad.height = 2;
        quad.twoSided = true;
        job.lights = {quad};
        quad.roll = 30;
        job.lights.push_back(quad);
        const Scene scene = applied(job);
        ASSERT_EQ(scene.areaLights.size(), 2u);
        for (const AreaLight& area : scene.areaLights) {
            EXPECT_EQ(area.shape, AreaShape::quad);
            EXPECT_TRUE(area.twoSided);
            EXPECT_EQ(area.radiance, glm::vec3(4, 2, 0));
            EXPECT_NEAR(glm::length(area.u), 1.5, 1e-12);
            EXPECT_NEAR(glm::length(area.v), 1, 1e-12);
            const glm::dvec3 normal = glm::normalize(glm::cross(area.u, area.v));
            EXPECT_NEAR(
                distance(normal, glm::normalize(glm::dvec3(direction[0], direction[1], direction[2]))), 0,
                1e-9);
        }
        const AreaLight &straight = scene.areaLights[0], &turned = scene.areaLights[1];
        EXPECT_NEAR(straight.u.y, 0, 1e-9) << "its width lies level";
        EXPECT_NEAR(glm::dot(glm::normalize(straight.u), glm::normalize(turned.u)), std::cos(kPi / 6), 1e-12);
        EXPECT_GT(glm::dot(turned.u, straight.v), 0) << "counter-clockwise around the normal";
    }
}

TEST(JobLights, SpheresHaveTheirRadius) {
    JobSpec job;
    LightSettings sphere = light(LightKind::sphere);
    sphere.position = {-1, 0, 2}, sphere.radius = 0.25;
    job.lights = {sphere};
    const Scene scene = applied(job);
    ASSERT_EQ(scene.areaLights.size(), 1u);
    EXPECT_EQ(scene.areaLights[0].shape, AreaShape::sphere);
    EXPECT_EQ(scene.areaLights[0].radius, 0.25);
    EXPECT_EQ(scene.areaLights[0].position, glm::dvec3(-1, 0, 2));
    EXPECT_FALSE(scene.hasEnvironment()) << "there is light";
}

TEST(JobEnvironment, ScalesTurnsAndHidesTheScenesOwn) {
    JobSpec job;
    job.environment.intensity = 3;
    job.environment.rotation = 90;
    job.environment.visible = false;
    Scene scene;
    scene.environment = uniformEnvironment({1, 2, std::numeric_limits<float>::max()});
    setJobEnvironment(scene, job, {});
    EXPECT_EQ(scene.environment.image.rgbaFloat[0], 3);
    EXPECT_EQ(scene.environment.image.rgbaFloat[1], 6);
    EXPECT_EQ(scene.environment.image.rgbaFloat[2], std::numeric_limits<float>::max()) << "stays finite";
    EXPECT_EQ(scene.environment.image.rgbaFloat[3], 1) << "alpha is none of it";
    EXPECT_NEAR(scene.environment.rotation, kPi / 2, 1e-15);
    EXPECT_FALSE(scene.environment.visible);
}

TEST(JobEnvironment, MayBeConstantOrNone) {
    JobSpec job;
    job.environment.kind = EnvironmentKind::constant;
    job.environment.color = {0.25f, 0.5f, 1};
    job.environment.intensity = 2;
    const Scene constant = applied(job);
    ASSERT_TRUE(constant.hasEnvironment());
    EXPECT_EQ(constant.environment.image.rgbaFloat[4], 0.5f);
    EXPECT_EQ(constant.environment.image.rgbaFloat[6], 2);
    EXPECT_TRUE(constant.warnings.empty());

    JobSpec none;
    none.environment.kind = EnvironmentKind::none;
    const Scene dark = applied(none);
    EXPECT_FALSE(dark.hasEnvironment()) << "dark because the job says so";
    EXPECT_TRUE(dark.warnings.empty());
    const JobSpec usual;
    EXPECT_TRUE(applied(usual).hasEnvironment());
}

struct JobSceneTest : testing::Test {
    TemporaryFolder folder;
    GltfBuilder builder = GltfBuilder::square();
    JobSpec job;
    Scene load(const std::filesystem::path& environment = {}) {
        return loadJobScene(builder.writeGltf(folder.path()), environment, job);
    }
};

TEST_F(JobSceneTest, ReadsTheEnvironmentFileOnlyWhereItIsWanted) {
    job.environment.kind = EnvironmentKind::constant;
    EXPECT_NO_THROW(load("no-such.hdr"));
    job.environment.kind = EnvironmentKind::file;
    EXPECT_THAT(errorOf([&] { load("no-such.hdr"); }).what(), HasSubstr("no-such.hdr"));
}

TEST_F(JobSceneTest, GivesMaterialsTheJobsDistributionAndFresnel) {
    builder.set("/materials/0/extensions/TILEFARM_materials", R"({"microfacets": "ggx"})");
    builder.set("/materials/1", R"({"name": "Other"})");
    job.settings.microfacets = Microfacets::beckmann;
    job.settings.fresnel = Fresnel::schlick;
    const Scene scene = load();
    ASSERT_EQ(scene.materials.size(), 3u);
    EXPECT_EQ(scene.materials[0].microfacets, Microfacets::ggx) << "says its own";
    EXPECT_EQ(scene.materials[1].microfacets, Microfacets::beckmann);
    EXPECT_EQ(scene.materials[2].microfacets, Microfacets::beckmann) << "glTF's default material";
    for (const Material& m : scene.materials) EXPECT_EQ(m.fresnel, Fresnel::schlick);
}

TEST_F(JobSceneTest, LaysOverridesOverMaterialsByNameInOrder) {
    builder.set("/materials/0", R"({"name": "Metal.001", "pbrMetallicRoughness": {"metallicFactor": 0.5}})");
    builder.set("/materials/1", R"({"name": "Wood"})");
    MaterialOverride metals, all, lost;
    metals.material = "Metal*", metals.conductor = "gold", metals.roughness = 0.25f;
    all.material = "*", all.roughness = 0.75f, all.microfacets = Microfacets::phong;
    lost.material = "Glass", lost.transmission = 1;
    job.materials = {metals, all, lost};
    const Scene scene = load();
    EXPECT_TRUE(scene.materials[0].conductor);
    EXPECT_EQ(scene.materials[0].conductorEta, conductorNamed("gold")->eta);
    EXPECT_EQ(scene.materials[0].metallic, 0.5f) << "not given";
    EXPECT_EQ(scene.materials[0].roughness, 0.75f) << "the later one wins";
    EXPECT_FALSE(scene.materials[1].conductor);
    EXPECT_EQ(scene.materials[1].microfacets, Microfacets::phong);
    ASSERT_EQ(scene.warnings.size(), 2u) << "no material; no light";
    EXPECT_EQ(scene.warnings[0].feature, "material override");
    EXPECT_THAT(scene.warnings[0].where, HasSubstr("/materials/2"));
    EXPECT_THAT(scene.warnings[0].instead, HasSubstr("'Glass'; there are 'Metal.001', 'Wood', 'default'"));
}

TEST(MaterialOverrides, SetEveryMember) {
    MaterialOverride o;
    o.baseColor = Color{0.1f, 0.2f, 0.3f}, o.emission = Color{1, 2, 3};
    o.metallic = 0.1f, o.roughness = 0.2f, o.ior = 2, o.transmission = 0.3f, o.thickness = 4;
    o.attenuationColor = Color{0.4f, 0.5f, 0.6f}, o.attenuationDistance = 5;
    o.specular = 0.6f, o.specularColor = Color{7, 8, 9}, o.specularTint = 0.7f;
    o.clearcoat = 0.8f, o.clearcoatRoughness = 0.9f;
    o.sheenColor = Color{0.7f, 0.8f, 0.9f}, o.sheenRoughness = 0.11f, o.sheen = 0.12f, o.sheenTint = 0.13f;
    o.anisotropy = 0.14f, o.anisotropyRotation = 3;
    o.iridescence = 0.15f, o.iridescenceIor = 1.7f, o.iridescenceThickness = 250;
    o.dispersion = 0.16f, o.diffuseTransmission = 0.17f, o.diffuseTransmissionColor = Color{0.9f, 0.8f, 0.7f};
    o.subsurface = 0.18f, o.disneyDiffuse = true, o.orenNayarSigma = 0.19f;
    o.conductor = "silver", o.microfacets = Microfacets::phong, o.fresnel = Fresnel::schlick;
    Material m;
    applyOverride(m, o);
    EXPECT_EQ(m.baseColor, glm::vec3(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(m.emission, glm::vec3(1, 2, 3));
    EXPECT_EQ(m.metallic, 0.1f);
    EXPECT_EQ(m.roughness, 0.2f);
    EXPECT_EQ(m.ior, 2);
    EXPECT_EQ(m.transmission, 0.3f);
    EXPECT_EQ(m.thickness, 4);
    EXPECT_EQ(m.attenuationColor, glm::vec3(0.4f, 0.5f, 0.6f));
    EXPECT_EQ(m.attenuationDistance, 5);
    EXPECT_EQ(m.specular, 0.6f);
    EXPECT_EQ(m.specularColor, glm::vec3(7, 8, 9));
    EXPECT_EQ(m.specularTint, 0.7f);
    EXPECT_EQ(m.clearcoat, 0.8f);
    EXPECT_EQ(m.clearcoatRoughness, 0.9f);
    EXPECT_FALSE(m.clearcoatGtr1);
    EXPECT_EQ(m.sheenColor, glm::vec3(0.7f, 0.8f, 0.9f));
    EXPECT_EQ(m.sheenRoughness, 0.11f);
    EXPECT_EQ(m.disneySheen, 0.12f);
    EXPECT_EQ(m.disneySheenTint, 0.13f);
    EXPECT_EQ(m.anisotropy, 0.14f);
    EXPECT_EQ(m.anisotropyRotation, 3);
    EXPECT_EQ(m.iridescence, 0.15f);
    EXPECT_EQ(m.iridescenceIor, 1.7f);
    EXPECT_EQ(m.iridescenceThicknessMinimum, 250);
    EXPECT_EQ(m.iridescenceThicknessMaximum, 250);
    EXPECT_EQ(m.dispersion, 0.16f);
    EXPECT_EQ(m.diffuseTransmission, 0.17f);
    EXPECT_EQ(m.diffuseTransmissionColor, glm::vec3(0.9f, 0.8f, 0.7f));
    EXPECT_EQ(m.subsurface, 0.18f);
    EXPECT_TRUE(m.disneyDiffuse);
    EXPECT_EQ(m.orenNayarSigma, 0.19f);
    EXPECT_TRUE(m.conductor);
    EXPECT_EQ(m.conductorK, conductorNamed("silver")->k);
    EXPECT_EQ(m.microfacets, Microfacets::phong);
    EXPECT_EQ(m.fresnel, Fresnel::schlick);

    MaterialOverride gloss;
    gloss.clearcoatGloss = 1;
    applyOverride(m, gloss);
    EXPECT_TRUE(m.clearcoatGtr1);
    EXPECT_NEAR(m.clearcoatRoughness * m.clearcoatRoughness, 0.001, 1e-8);
    gloss.clearcoatGloss = 0;
    applyOverride(m, gloss);
    EXPECT_NEAR(m.clearcoatRoughness * m.clearcoatRoughness, 0.1, 1e-7);
    EXPECT_EQ(m.roughness, 0.2f) << "what is not given stays";
}

TEST(MatchesName, KnowsStars) {
    EXPECT_TRUE(matchesName("Gold", "Gold"));
    EXPECT_FALSE(matchesName("Gold", "Golden"));
    EXPECT_FALSE(matchesName("Golden", "Gold"));
    EXPECT_TRUE(matchesName("*", ""));
    EXPECT_TRUE(matchesName("*", "anything"));
    EXPECT_FALSE(matchesName("", "x"));
    EXPECT_TRUE(matchesName("", ""));
    EXPECT_TRUE(matchesName("G*d", "Gold"));
    EXPECT_TRUE(matchesName("*o*", "Gold"));
    EXPECT_TRUE(matchesName("*ab", "aab"));
    EXPECT_TRUE(matchesName("a*b*c", "a-b-bc"));
    EXPECT_FALSE(matchesName("a*b*c", "a-b-cb"));
    EXPECT_TRUE(matchesName("**", "x"));
    EXPECT_FALSE(matchesName("?old", "Gold"));
}

TEST(ConductorNames, OfJobsAreThoseOfTheWorker) {
    for (const std::string_view name : kConductorNames) EXPECT_TRUE(conductorNamed(name)) << name;
    for (const std::string_view name : conductorNames())
        EXPECT_NE(std::find(kConductorNames.begin(), kConductorNames.end(), name), kConductorNames.end())
            << name;
}

}  // namespace
}  // namespace tilefarm
