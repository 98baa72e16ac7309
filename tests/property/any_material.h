#pragma once

#include <glm/glm.hpp>
#include <iosfwd>

#include "tests/shader/bsdf_probe_runner.h"

namespace rc {
template <typename T>
class Gen;
}

namespace tilefarm {

/// A material seen from a direction; wo.z > 0.
struct SeenMaterial {
    ProbeMaterial material;
    glm::vec3 wo{0, 0, 1};
};

/// How many indices of refraction and models of microfacets materials have: every one takes a tenth of a
/// second for its tables.
enum class Variety { few, many };

/// Any material that the loader and a job can make (worker/scene/material_extensions.cpp has the ranges),
/// each number at its neutral value, at an end of its range or within, seen at cosines from 1e-7 to 1.
/// Shrinks towards a plain white Lambert surface from above.
rc::Gen<SeenMaterial> anyMaterial(Variety variety);

/// The i-th of a fixed row of them.
SeenMaterial materialNumber(uint64_t i, Variety variety);

/// Whether it keeps its energy to 0.5 %. At an index of 1000, the loader's limit, reflection dips where cosθ
/// is 1e-3, which the albedo tables do not show: 6 of 5,000 such views return up to 1.14 (measured at that
/// cosine).
inline bool keepsEnergyTo1005(const ProbeMaterial& material) {
    return material.ior <= 100;
}

/// FEATURE_* that any material may call for, all of them; without compensation of energy, whose absence a job
/// may ask for.
uint64_t everyLobe();

/// As C++ that makes it again: members that are not as in ProbeMaterial's defaults.
std::ostream& operator<<(std::ostream& out, const SeenMaterial& seen);

/// Index of the far side over that of wo's side, of what refracts.
double etaOf(const ProbeMaterial& material);

}  // namespace tilefarm
