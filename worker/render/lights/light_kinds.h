#pragma once

#include "worker/render/lights/light_list.h"

/// Lights that are no shapes, one packer each; those of shapes are in gpu_light_packers.h.
namespace tilefarm {

void addTriangle(const Scene& scene, const WorldGeometry& world, const EmissiveTriangle& triangle,
                 LightList& lights, PackedLights& packed);

/// Whether it is a light: it sends out something.
bool addQuad(const QuadLight& quad, LightList& lights, PackedLights& packed);

void addPunctual(const PunctualLight& light, double sceneRadius, LightList& lights, PackedLights& packed);

/// A directional light with an angular size that fp32 directions can tell.
bool isSun(const PunctualLight& light);
void addSun(const PunctualLight& light, double sceneRadius, LightList& lights, PackedLights& packed);

/// `flux`: ∫ luminance dω.
void addEnvironment(double flux, double sceneRadius, LightList& lights, PackedLights& packed);

}  // namespace tilefarm
