#include "worker/render/interface_packer.h"

#include <algorithm>
#include <cmath>

#include "worker/render/material_needs.h"

namespace tilefarm {
namespace {

// A material that does not say otherwise takes what the job asks for.
Microfacets microfacetsOf(const Material& m, const RenderSettings& settings) {
    return m.microfacets != Microfacets::ggx ? m.microfacets : settings.microfacets;
}

Fresnel fresnelOf(const Material& m, const RenderSettings& settings) {
    return m.fresnel != Fresnel::exact ? m.fresnel : settings.fresnel;
}

bool isSmooth(const Material& m) {
    return m.roughness * m.roughness < static_cast<float>(ALPHA_DELTA);
}

// A texture can only lower roughness and metallic.
bool mayBeSmooth(const Material& m) {
    return isSmooth(m) || m.metallicRoughnessTexture;
}

/// What shadow rays have to know of glass.
uint32_t glassFlags(const Material& m, const RenderSettings& settings) {
    const bool metal = m.metallic == 1 && !m.metallicRoughnessTexture;
    const bool whitted = settings.integrator == Integrator::whitted;  // which knows no rough glass
    if (m.unlit || metal || m.transmission == 0 || !(mayBeSmooth(m) || whitted)) return 0;
    if (m.thickness == 0) return gpu::MATERIAL_PANE;
    // Paths that are regularised meet it as rough glass, where they find every light.
    return settings.regularisation > 0 && !whitted ? 0 : gpu::MATERIAL_SOLID_GLASS;
}

bool tintsSpecular(const Material& m) {
    return m.ior == 0 || m.specular != 1 || m.specularTexture || m.specularColor != glm::vec3(1) ||
           m.specularColorTexture || m.specularTint > 0;
}

// A strong dispersion brings red's index, or blue's, down to that of air, which deflects nothing, like a
// mirror. The kernel may round to it where the host does not.
bool dispersesToAir(const Material& m) {
    constexpr float kAir = 1 + 1e-5f;
    return m.dispersion > 0 && isSolid(m) &&
           std::min(dispersedIor(m.ior, m.dispersion, 0), dispersedIor(m.ior, m.dispersion, 2)) <= kAir;
}

uint64_t dielectricFeatures(const Material& m, const RenderSettings& settings) {
    uint64_t features = 0;
    if (!hasDielectric(m)) return features;
    if (tintsSpecular(m)) features |= gpu::bit(gpu::FEATURE_SPECULAR_COLOR);
    if (fresnelOf(m, settings) == Fresnel::schlick) features |= gpu::bit(gpu::FEATURE_SCHLICK);
    return features;
}

uint64_t facetFeatures(const Material& m, const RenderSettings& settings) {
    uint64_t features = 0;
    const Microfacets kind = microfacetsOf(m, settings);
    if (kind == Microfacets::beckmann) features |= gpu::bit(gpu::FEATURE_BECKMANN);
    if (kind == Microfacets::phong) features |= gpu::bit(gpu::FEATURE_PHONG);
    if (mayBeSmooth(m) || (m.transmission > 0 && m.ior == 1) || dispersesToAir(m))
        features |= gpu::bit(gpu::FEATURE_MIRROR);
    if (settings.energyCompensation && (!isSmooth(m) || m.anisotropy > 0 || settings.regularisation > 0))
        features |= gpu::bit(gpu::FEATURE_ENERGY_COMPENSATION);
    return features;
}

}  // namespace

uint64_t interfaceFeatures(const Material& m, const RenderSettings& settings) {
    if (!hasInterface(m)) return 0;
    uint64_t features =
        gpu::bit(gpu::FEATURE_SPECULAR) | facetFeatures(m, settings) | dielectricFeatures(m, settings);
    if (m.conductor && m.metallic > 0) features |= gpu::bit(gpu::FEATURE_CONDUCTOR);
    if ((glassFlags(m, settings) & gpu::MATERIAL_PANE) != 0) features |= gpu::bit(gpu::FEATURE_GLASS_SHADOWS);
    return features;
}

bool hidesLights(const Material& m, const RenderSettings& settings) {
    return (glassFlags(m, settings) & gpu::MATERIAL_SOLID_GLASS) != 0;
}

InterfaceKind interfaceKind(const Material& m, const RenderSettings& settings) {
    return {m.ior, microfacetsOf(m, settings), fresnelOf(m, settings), refracts(m)};
}

void packInterface(gpu::MaterialRecord& record, const Material& m, const RenderSettings& settings) {
    const Microfacets kind = microfacetsOf(m, settings);
    if (kind == Microfacets::beckmann) record.flags |= gpu::MATERIAL_BECKMANN;
    if (kind == Microfacets::phong) record.flags |= gpu::MATERIAL_PHONG;
    if (fresnelOf(m, settings) == Fresnel::schlick) record.flags |= gpu::MATERIAL_SCHLICK;
    record.flags |= glassFlags(m, settings);
    if (m.conductor) record.flags |= gpu::MATERIAL_CONDUCTOR;
    if (!refracts(m)) record.dispersion = 0;
    record.anisotropyCos = std::cos(m.anisotropyRotation);
    record.anisotropySin = std::sin(m.anisotropyRotation);
}

void bindInterfaceTextures(gpu::MaterialRecord& record, const Material& m, uint64_t features,
                           TexturePacker& textures) {
    const auto bind = [&](uint32_t feature, uint32_t& slot, const TextureRef& texture) {
        if ((features & gpu::bit(feature)) != 0) slot = textures.add(texture);
    };
    bind(gpu::FEATURE_TRANSMISSION, record.transmissionTexture, m.transmissionTexture);
    bind(gpu::FEATURE_SPECULAR_COLOR, record.specularTexture, m.specularTexture);
    bind(gpu::FEATURE_SPECULAR_COLOR, record.specularColorTexture, m.specularColorTexture);
    bind(gpu::FEATURE_ANISOTROPY, record.anisotropyTexture, m.anisotropyTexture);
    bind(gpu::FEATURE_IRIDESCENCE, record.iridescenceTexture, m.iridescenceTexture);
    bind(gpu::FEATURE_IRIDESCENCE, record.iridescenceThicknessTexture, m.iridescenceThicknessTexture);
}

}  // namespace tilefarm
