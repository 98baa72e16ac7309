#pragma once

#include <functional>
#include <map>
#include <vector>

#include "tests/shader/bsdf_probe.h"
#include "worker/render/albedo_table.h"
#include "worker/vk/buffer.h"
#include "worker/vk/pipeline.h"

namespace tilefarm {

/// MaterialPoint of shaders/material_point.glsl, all members floats, and the side that is seen.
struct ProbeMaterial {
    glm::vec3 baseColor{1};
    float metallic = 0;
    float alpha = 0.25f;
    float alphaT = -1;  // negative: as alpha
    float ior = 1.5f, transmission = 0;
    float flags = 0;         // MATERIAL_* as a number
    float albedoTable = -1;  // BsdfProbe::ask fills it in where the material reflects
    float specular = 1, frontFace = 1;
    glm::vec3 specularColor{1};
    float dispersion = 0;
    glm::vec3 conductorEta{1};
    float iridescence = 0;
    glm::vec3 conductorK{0};
    float iridescenceIor = 1.3f;
    float iridescenceThickness = 0, clearcoat = 0, clearcoatAlpha = 0, sheenRoughness = 0;
    glm::vec3 clearcoatNormal{0, 0, 1};
    float disneySheen = 0;
    glm::vec3 sheenColor{0};
    float disneySheenTint = 0;
    glm::vec3 diffuseTransmissionColor{1};
    float diffuseTransmission = 0;
    float subsurface = 0, orenNayarSigma = 0;
    float coatTable = -1, sheenTable = -1;  // likewise
};
static_assert(sizeof(ProbeMaterial) == 16 * PROBE_MATERIAL_TEXELS);

/// A query that draws wi with the numbers u.
BsdfQuery drawQuery(const ProbeMaterial& material, const glm::vec3& wo, const glm::vec3& u);
/// A query that evaluates towards wi.
BsdfQuery evalQuery(const ProbeMaterial& material, const glm::vec3& wo, const glm::vec3& wi);
/// The same; the answer's wi.xyz is what of the BSDF passes or leaves the diffuse base.
BsdfQuery partsQuery(const ProbeMaterial& material, const glm::vec3& wo, const glm::vec3& wi);
/// A query that draws that many wi from a point of a random lattice that `start` and the batch choose: mean
/// energy that comes out for a unit of it that comes in, by channel (PROBE_FURNACE).
BsdfQuery furnaceQuery(const ProbeMaterial& material, const glm::vec3& wo, uint32_t samples, uint32_t start);

/// Runs the BSDF code of the shaders, compiled for the given FEATURE_* mask, on lists of queries.
class BsdfProbe {
public:
    BsdfProbe(const gpu::Device& device, uint64_t features);
    /// Answers of a query's batches, which differ in the random start of a furnace, follow each other.
    std::vector<BsdfAnswer> ask(std::vector<BsdfQuery> queries, uint32_t batches = 1);

private:
    static gpu::ComputePipeline makePipeline(const gpu::Device& device, uint64_t features);
    float tableFor(float key, const std::function<std::vector<glm::vec4>()>& build);
    void setTables(std::vector<BsdfQuery>& queries);

    const gpu::Device& device_;
    gpu::ComputePipeline pipeline_;
    std::map<std::pair<InterfaceKind, float>, float> tableOfInterface_;  // by dispersion, too
    std::map<float, float> tableOf_;  // those of layers: by index of refraction
    std::vector<glm::vec4> tables_;
    std::vector<gpu::TexelBuffer> texels_;
};

}  // namespace tilefarm
