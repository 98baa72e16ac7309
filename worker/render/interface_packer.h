#pragma once

#include "shaders/gpu_types.h"
#include "shared/job/render_settings.h"
#include "worker/render/albedo_table.h"
#include "worker/render/texture_packer.h"
#include "worker/scene/scene.h"

namespace tilefarm {

/// What a material's interface between air and base (shaders/bsdf/interface.glsl) calls for beyond
/// parameterFeatures (gpu_material_host.h): reflection and all that varies it. Zero for a matte surface.
uint64_t interfaceFeatures(const Material& material, const RenderSettings& settings);

/// Whether it may be smooth solid glass, through which no path finds a light without extent.
bool hidesLights(const Material& material, const RenderSettings& settings);

/// Which albedo tables it reads.
InterfaceKind interfaceKind(const Material& material, const RenderSettings& settings);

/// Writes what its part of the record has beside the parameters; the textures only of `features`.
void packInterface(gpu::MaterialRecord& record, const Material& material, const RenderSettings& settings);
void bindInterfaceTextures(gpu::MaterialRecord& record, const Material& material, uint64_t features,
                           TexturePacker& textures);

}  // namespace tilefarm
