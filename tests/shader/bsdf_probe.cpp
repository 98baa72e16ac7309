#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>

#include "bsdf_probe.comp.h"
#include "shaders/gpu_types.h"
#include "tests/shader/bsdf_probe_runner.h"
#include "worker/render/albedo_table.h"
#include "worker/render/layer_tables.h"
#include "worker/render/table_cache.h"
#include "worker/vk/commands.h"

namespace tilefarm {
namespace {

// Beside the indices of refraction.
constexpr float kSheenTable = -1, kGtr1Table = -2;

BsdfQuery query(const ProbeMaterial& material, const glm::vec3& wo, const glm::vec3& other, float mode) {
    BsdfQuery result{{wo, 0}, {other, mode}, {}};
    std::memcpy(result.material, &material, sizeof material);
    return result;
}

constexpr size_t kTableTexels = gpu::ALBEDO_TABLE_SIZE * (gpu::ALBEDO_TABLE_SIZE + 1);

InterfaceKind kindOf(const ProbeMaterial& m) {
    const auto flags = static_cast<uint32_t>(m.flags);
    InterfaceKind kind{.ior = m.ior};
    if ((flags & gpu::MATERIAL_BECKMANN) != 0) kind.microfacets = Microfacets::beckmann;
    if ((flags & gpu::MATERIAL_PHONG) != 0) kind.microfacets = Microfacets::phong;
    if ((flags & gpu::MATERIAL_SCHLICK) != 0) kind.fresnel = Fresnel::schlick;
    kind.solid = m.transmission > 0 && (flags & gpu::MATERIAL_THIN) == 0;
    return kind;
}

/// Kept, since every mask of features has a probe of its own.
const std::vector<glm::vec4>& tablesOf(const InterfaceKind& kind, float dispersion) {
    static std::map<std::pair<InterfaceKind, float>, std::vector<glm::vec4>> kept;
    const auto [at, isNew] = kept.try_emplace({kind, dispersion});
    if (isNew) at->second = dispersion > 0 ? dispersedTables(kind, dispersion) : interfaceTables(kind);
    return at->second;
}

std::vector<gpu::TexelBuffer> makeTexels(const gpu::Device& device, const std::vector<glm::vec4>& tables) {
    std::vector<gpu::TexelBuffer> texels;
    for (uint32_t binding = 0; binding < gpu::BINDING_PARAMETERS; ++binding) {
        const bool floats = binding == gpu::BINDING_TEXELS8 || binding == gpu::BINDING_TEXELS32 ||
                            binding == gpu::BINDING_ENVIRONMENT || binding == gpu::BINDING_ALBEDO_TABLES;
        const std::vector<glm::vec4> none;
        texels.emplace_back(device, floats ? gpu::TexelFormat::rgba32f : gpu::TexelFormat::rgba32ui,
                            gpu::bytesOf(binding == gpu::BINDING_ALBEDO_TABLES ? tables : none), "probe");
    }
    return texels;
}

}  // namespace

BsdfQuery drawQuery(const ProbeMaterial& material, const glm::vec3& wo, const glm::vec3& u) {
    return query(material, wo, u, PROBE_DRAW);
}

BsdfQuery evalQuery(const ProbeMaterial& material, const glm::vec3& wo, const glm::vec3& wi) {
    return query(material, wo, wi, PROBE_EVAL);
}

BsdfQuery partsQuery(const ProbeMaterial& material, const glm::vec3& wo, const glm::vec3& wi) {
    return query(material, wo, wi, PROBE_PARTS);
}

BsdfQuery furnaceQuery(const ProbeMaterial& material, const glm::vec3& wo, uint32_t samples, uint32_t start) {
    return query(material, wo, {samples, start & 0xffffffu, 0}, PROBE_FURNACE);
}

BsdfProbe::BsdfProbe(const gpu::Device& device, uint64_t features)
    : device_(device), pipeline_(makePipeline(device, features)), texels_(makeTexels(device, {})) {}

gpu::ComputePipeline BsdfProbe::makePipeline(const gpu::Device& device, uint64_t features) {
    gpu::PipelineSpec spec;
    spec.spirv = bsdf_probe_comp;
    spec.bindings.assign(gpu::BINDING_COUNTERS + 1, gpu::BindingKind::storage);
    std::fill_n(spec.bindings.begin(), gpu::BINDING_PARAMETERS, gpu::BindingKind::texels);
    spec.constants = {static_cast<uint32_t>(features), 1, 64, static_cast<uint32_t>(features >> 32)};
    spec.pushConstantBytes = 2 * sizeof(uint32_t);
    spec.name = "bsdf_probe";
    return {device, spec};
}

float BsdfProbe::tableFor(float key, const std::function<std::vector<glm::vec4>()>& build) {
    const auto [at, isNew] = tableOf_.try_emplace(key, static_cast<float>(tables_.size() / kTableTexels));
    if (isNew) {
        const auto table = build();
        tables_.insert(tables_.end(), table.begin(), table.end());
    }
    return at->second;
}

// As MaterialPacker: a table for every material that reflects.
void BsdfProbe::setTables(std::vector<BsdfQuery>& queries) {
    const size_t before = tables_.size();
    for (BsdfQuery& q : queries) {
        ProbeMaterial material;
        std::memcpy(static_cast<void*>(&material), q.material, sizeof material);
        if (material.ior != 1 || material.metallic != 0 || material.transmission != 0 ||
            material.iridescence != 0) {
            const InterfaceKind kind = kindOf(material);
            const float dispersion = kind.solid ? material.dispersion : 0;
            const auto [at, isNew] = tableOfInterface_.try_emplace({kind, dispersion}, 0.0f);
            if (isNew) {
                const auto& tables = tablesOf(kind, dispersion);
                at->second = static_cast<float>(tables_.size() / kTableTexels +
                                                (dispersion > 0 ? kDispersedTablesBeforeNamed : 0));
                tables_.insert(tables_.end(), tables.begin(), tables.end());
            }
            material.albedoTable = at->second;
        }
        const bool gtr1 = (static_cast<uint32_t>(material.flags) & gpu::MATERIAL_GTR1) != 0;
        if (material.clearcoat > 0)
            material.coatTable =
                gtr1 ? tableFor(kGtr1Table, [] { return tableOnce("gtr1", buildGtr1Table); })
                     : tableFor(1.5f, [] { return tableOnce("coat", [] { return buildAlbedoTable(1.5); }); });
        if (material.sheenColor != glm::vec3(0))
            material.sheenTable = tableFor(kSheenTable, [] { return tableOnce("sheen", buildSheenTable); });
        std::memcpy(q.material, &material, sizeof material);
    }
    if (tables_.size() != before) texels_ = makeTexels(device_, tables_);
}

std::vector<BsdfAnswer> BsdfProbe::ask(std::vector<BsdfQuery> queries, uint32_t batches) {
    if (queries.empty()) return {};
    setTables(queries);
    const auto count = static_cast<uint32_t>(queries.size());
    const uint32_t answerCount = count * batches, groups = (answerCount + 63) / 64;
    gpu::StorageBuffer unused(device_, 16, "unused"), in(device_, sizeof(BsdfQuery) * count, "queries"),
        out(device_, sizeof(BsdfAnswer) * answerCount, "answers");
    in.upload(gpu::bytesOf(queries));
    std::vector<gpu::Binding> bindings(texels_.begin(), texels_.end());
    bindings.insert(bindings.end(), {unused, in, out, unused});
    const uint32_t push[]{count, batches};
    const uint32_t wide = std::min(groups, 32768u);
    gpu::CommandRun run(device_);
    run.dispatch(pipeline_, bindings, std::as_bytes(std::span(push)), wide, (groups + wide - 1) / wide);
    const size_t index = run.read(out);
    gpu::Submission submission = run.submit();
    std::vector<BsdfAnswer> answers(answerCount);
    std::memcpy(answers.data(), submission.bytes(index).data(), sizeof(BsdfAnswer) * answerCount);
    return answers;
}

}  // namespace tilefarm
