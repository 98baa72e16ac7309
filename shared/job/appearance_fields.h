#pragma once

// Part of the table in fields.h: the material parameters of a job and of TILEFARM_materials.

#include <numbers>

#include "shared/job/appearance.h"
#include "shared/job/conductor_names.h"
#include "shared/job/json_reader.h"

namespace tilefarm {

inline constexpr NumberRange kShare{0, 1};
inline constexpr NumberRange kLightAmount{0, 1e18};  // its squares and sums still fit a float
inline constexpr NumberRange kIorRange{1, 1000};

inline constexpr std::array kMicrofacetChoices{
    Choice<Microfacets>{"ggx", Microfacets::ggx},
    Choice<Microfacets>{"beckmann", Microfacets::beckmann},
    Choice<Microfacets>{"phong", Microfacets::phong},
};
inline constexpr std::array kFresnelChoices{
    Choice<Fresnel>{"exact", Fresnel::exact},
    Choice<Fresnel>{"schlick", Fresnel::schlick},
};

}  // namespace tilefarm

// describeAppearance: the members of a MaterialOverride except the name of its materials.
#include "job_material_fields.h"

namespace tilefarm {

template <typename Visitor>
void describe(Visitor& v, Is<MaterialOverride> auto& m) {
    v.text({"material", "name of the materials to change; * matches any characters", kRequired}, m.material,
           {1, 1024});
    describeAppearance(v, m);
}

}  // namespace tilefarm
