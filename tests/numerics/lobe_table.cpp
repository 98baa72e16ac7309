#include "tests/numerics/lobe_table.h"

#include <cmath>

#include "shaders/gpu_types.h"

namespace tilefarm {
namespace {

// A mask is a kernel to compile, which takes seconds the first time: these are the ones of
// tests/shader/bsdf_*.
constexpr uint64_t bits(std::initializer_list<uint32_t> features) {
    uint64_t mask = 0;
    for (const uint32_t feature : features) mask |= gpu::bit(feature);
    return mask;
}
constexpr uint64_t kFacets = bits({gpu::FEATURE_SPECULAR, gpu::FEATURE_MIRROR, gpu::FEATURE_TRANSMISSION});
constexpr uint64_t kTinted = kFacets | bits({gpu::FEATURE_SPECULAR_COLOR});
constexpr uint64_t kSchlick = kFacets | bits({gpu::FEATURE_SCHLICK});
constexpr uint64_t kConductor = kFacets | bits({gpu::FEATURE_CONDUCTOR});
constexpr uint64_t kFilm = kFacets | bits({gpu::FEATURE_IRIDESCENCE});
constexpr uint64_t kDistributions = kFacets | bits({gpu::FEATURE_BECKMANN, gpu::FEATURE_PHONG});
constexpr uint64_t kAnisotropic = bits({gpu::FEATURE_ANISOTROPY, gpu::FEATURE_BECKMANN});
constexpr uint64_t kCompensated = kFacets | bits({gpu::FEATURE_ENERGY_COMPENSATION});
constexpr uint64_t kLayers =
    kFacets | bits({gpu::FEATURE_CLEARCOAT, gpu::FEATURE_GTR1, gpu::FEATURE_SHEEN, gpu::FEATURE_DISNEY_SHEEN,
                    gpu::FEATURE_DISNEY_DIFFUSE, gpu::FEATURE_OREN_NAYAR, gpu::FEATURE_DIFFUSE_TRANSMISSION});

constexpr glm::vec3 kBlack{0}, kCopper{.9f, .6f, .3f};
constexpr auto kThin = static_cast<float>(gpu::MATERIAL_THIN);

float flag(uint32_t flags) {
    return static_cast<float>(flags);
}

/// `material` as seen from outside and from inside.
void addSolid(std::vector<LobeRow>& rows, const std::string& name, ProbeMaterial material,
              uint64_t features) {
    material.transmission = material.transmission == 0 ? 1 : material.transmission;
    rows.push_back({name, material, features});
    material.frontFace = 0;
    rows.push_back({name + " from inside", material, features});
}

void addPlain(std::vector<LobeRow>& rows, uint64_t features, const std::string& prefix = "") {
    rows.push_back({prefix + "metal", {.baseColor = kCopper, .metallic = 1}, features});
    rows.push_back({prefix + "plastic", {.baseColor = {.8f, .5f, .2f}}, features});
    addSolid(rows, prefix + "glass", {.baseColor = {1, .9f, .8f}}, features);
    rows.push_back({prefix + "pane", {.baseColor = kCopper, .transmission = 1, .flags = kThin}, features});
}

void addMixtures(std::vector<LobeRow>& rows) {
    rows.push_back({"dielectric", {.baseColor = kBlack}, kFacets});
    rows.push_back({"half metal", {.baseColor = kCopper, .metallic = 0.5f}, kFacets});
    rows.push_back({"half pane", {.transmission = 0.4f, .flags = kThin}, kFacets});
    addSolid(rows, "half glass", {.transmission = 0.5f}, kFacets);
}

void addVariants(std::vector<LobeRow>& rows) {
    addSolid(rows, "tinted glass", {.specular = 0.8f, .specularColor = {1, .5f, .2f}}, kTinted);
    rows.push_back({"tinted dielectric",
                    {.baseColor = kBlack, .specular = 0.5f, .specularColor = {.1f, .3f, 1}},
                    kTinted});
    const float schlick = flag(gpu::MATERIAL_SCHLICK);
    addSolid(rows, "Schlick glass", {.flags = schlick}, kSchlick);
    rows.push_back({"gold",
                    {.metallic = 1,
                     .flags = flag(gpu::MATERIAL_CONDUCTOR),
                     .conductorEta = {.18f, .42f, 1.37f},
                     .conductorK = {3.4f, 2.35f, 1.77f}},
                    kConductor});
    for (const uint32_t kind : {gpu::MATERIAL_BECKMANN, gpu::MATERIAL_PHONG}) {
        const std::string name = kind == gpu::MATERIAL_PHONG ? "Phong " : "Beckmann ";
        rows.push_back(
            {name + "metal", {.baseColor = kCopper, .metallic = 1, .flags = flag(kind)}, kDistributions});
        addSolid(rows, name + "glass", {.flags = flag(kind)}, kDistributions);
    }
}

void addFilms(std::vector<LobeRow>& rows) {
    const ProbeMaterial film{.iridescence = 1, .iridescenceThickness = 350};
    ProbeMaterial covered = film;
    addSolid(rows, "film on glass", film, kFilm);
    covered.baseColor = kBlack;
    rows.push_back({"film on dielectric", covered, kFilm});
    covered.baseColor = kCopper;
    covered.metallic = 1;
    rows.push_back({"film on metal", covered, kFilm});
}

/// A coat over nothing.
LobeRow coat(const char* name, float alpha, uint32_t flags) {
    return {name,
            {.baseColor = kBlack,
             .alpha = alpha,
             .ior = 1,
             .flags = flag(flags | gpu::MATERIAL_THIN),
             .clearcoat = 1,
             .clearcoatAlpha = alpha},
            kLayers};
}

void setAlpha(std::vector<LobeRow>& rows, float alpha, float stretch) {
    for (LobeRow& row : rows) {
        row.material.alpha = alpha / stretch;
        if (stretch == 1) continue;
        // Of α = 0: a mirror across the grooves alone.
        row.material.alphaT = alpha > 0 ? alpha : stretch * static_cast<float>(ALPHA_DELTA);
        row.features |= kAnisotropic;
    }
}

}  // namespace

std::vector<LobeRow> plainLobes(float alpha, float stretch) {
    std::vector<LobeRow> rows;
    addPlain(rows, kFacets);
    addMixtures(rows);
    setAlpha(rows, alpha, stretch);
    return rows;
}

std::vector<LobeRow> basicLobes(float alpha) {
    std::vector<LobeRow> rows = plainLobes(alpha);
    addFilms(rows);
    addPlain(rows, kCompensated, "compensated ");
    setAlpha(rows, alpha, 1);
    rows.push_back(coat("coat", alpha, 0));
    return rows;
}

std::vector<LobeRow> facetLobes(float alpha, float stretch) {
    std::vector<LobeRow> rows = stretch == 1 ? basicLobes(alpha) : plainLobes(alpha, stretch), more;
    if (stretch > 1) addFilms(more);
    addVariants(more);
    setAlpha(more, alpha, stretch);
    rows.insert(rows.end(), more.begin(), more.end());
    return rows;
}

std::vector<LobeRow> hazeLobes(float alpha) {
    return {coat("GTR1 coat", alpha, gpu::MATERIAL_GTR1),
            {"sheen",
             {.baseColor = kBlack,
              .ior = 1,
              .flags = kThin,
              .sheenRoughness = std::sqrt(alpha),
              .sheenColor = {1, .7f, .3f}},
             kLayers}};
}

std::vector<LobeRow> diffuseLobes() {
    std::vector<LobeRow> rows{
        {"Lambert", {.baseColor = {.8f, .5f, .2f}, .alpha = 1, .ior = 1, .flags = kThin}, kLayers},
        {"Oren-Nayar",
         {.baseColor = {.8f, .5f, .2f}, .ior = 1, .flags = kThin, .orenNayarSigma = 0.6f},
         kLayers},
        {"Disney sheen", {.baseColor = kBlack, .ior = 1, .flags = kThin, .disneySheen = 1}, kLayers},
        {"diffuse transmission",
         {.ior = 1, .flags = kThin, .diffuseTransmissionColor = {.9f, .8f, .2f}, .diffuseTransmission = 0.4f},
         kLayers}};
    for (const float subsurface : {0.f, 1.f})
        rows.push_back({subsurface > 0 ? "Disney subsurface" : "Disney diffuse",
                        {.ior = 1,
                         .flags = flag(gpu::MATERIAL_DISNEY_DIFFUSE | gpu::MATERIAL_THIN),
                         .subsurface = subsurface},
                        kLayers});
    return rows;
}

std::vector<LobeRow> layeredLobes(float alpha) {
    return {{"coated plastic", {.alpha = 0.4f, .clearcoat = 1, .clearcoatAlpha = alpha}, kLayers},
            {"cloth over plastic",
             {.alpha = alpha, .sheenRoughness = 0.3f, .sheenColor = glm::vec3(0.8f)},
             kLayers},
            {"leaf under gloss", {.alpha = alpha, .diffuseTransmission = 0.5f}, kLayers}};
}

}  // namespace tilefarm
