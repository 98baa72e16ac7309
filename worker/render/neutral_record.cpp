#include "worker/render/neutral_record.h"

#include "gpu_tables_host.h"

namespace tilefarm {
namespace {

struct FlagOfFeature {
    uint32_t feature, flag;
};
constexpr FlagOfFeature kFlags[]{
    {gpu::FEATURE_GLASS_SHADOWS, gpu::MATERIAL_PANE},
    {gpu::FEATURE_CONDUCTOR, gpu::MATERIAL_CONDUCTOR},
    {gpu::FEATURE_SCHLICK, gpu::MATERIAL_SCHLICK},
    {gpu::FEATURE_BECKMANN, gpu::MATERIAL_BECKMANN},
    {gpu::FEATURE_PHONG, gpu::MATERIAL_PHONG},
    {gpu::FEATURE_GTR1, gpu::MATERIAL_GTR1},
    {gpu::FEATURE_DISNEY_DIFFUSE, gpu::MATERIAL_DISNEY_DIFFUSE},
};

}  // namespace

void neutralise(gpu::MaterialRecord& record, uint64_t called) {
    const auto lacks = [called](uint32_t feature) { return (called & gpu::bit(feature)) == 0; };
    gpu::neutraliseMembers(record, lacks);
    for (const auto& [feature, flag] : kFlags)
        if (lacks(feature)) record.flags &= ~flag;
    // The index stays without an interface: light in solids that only scatter diffusely goes by it. But the 0
    // of metals is read by one feature alone.
    if (!lacks(gpu::FEATURE_SPECULAR)) record.flags |= gpu::MATERIAL_INTERFACE;
    if (lacks(gpu::FEATURE_SPECULAR_COLOR) && record.ior == 0) record.ior = 1.5f;
}

}  // namespace tilefarm
