"""What generate.py writes of the table of materials."""

import itertools

import materials

HEADER = "// Written by shaders/tables/generate.py from materials.py: edit that.\n"
JOB_TYPES = {"color": "Color", "word": "std::string"}
SCENE_TYPES = {"color": "glm::vec3", "texture": "TextureRef"}
VISITS = {"float": "number", "color": "triple", "bool": "flag", "word": "word"}


def header(*includes):
    return "#pragma once\n" + HEADER + "\n" + "".join(f"#include {name}\n" for name in includes) + "\nnamespace tilefarm {\n\n"


FOOTER = "\n}  // namespace tilefarm\n"


def job_name(row):
    return row.job if isinstance(row.job, str) else row.name


def job_struct():
    """What a job says of materials beyond their file."""
    text = header("<optional>", "<string>", '"shared/job/color.h"', '"shared/job/facets.h"')
    text += "struct MaterialOverride {\n    std::string material;  // name of the materials; \"*\" is any run of characters\n"
    for row in materials.of_jobs():
        text += f"    std::optional<{JOB_TYPES.get(row.type, row.type)}> {job_name(row)};  // {row.meaning}\n"
    text += "    friend bool operator==(const MaterialOverride&, const MaterialOverride&) = default;\n};\n"
    return text + FOOTER


def range_text(row):
    if isinstance(row.range, tuple):
        return f", NumberRange{{{row.range[0]}, {row.range[1]}}}"
    return f", {row.range}" if row.range else ""


def job_fields():
    """Included by shared/job/appearance_fields.h behind the ranges and choices that it names."""
    text = header()
    text += "template <typename Visitor>\nvoid describeAppearance(Visitor& v, auto& m) {\n"
    for row in materials.of_jobs():
        name = job_name(row)
        text += f'    v.{VISITS.get(row.type, "choice")}({{"{name}", "{row.meaning}"}}, m.{name}{range_text(row)});\n'
    return text + "}\n" + FOOTER


def literal(row):
    if row.type == "texture":
        return ""
    if row.type == "bool":
        return str(row.default).lower()
    if row.type not in ("float", "color"):
        return f"{row.type}::{row.default}"
    if row.default == "infinity":
        return "std::numeric_limits<float>::infinity()"
    return f"{row.default}f" if isinstance(row.default, float) else str(row.default)


def scene_struct():
    text = header("<glm/glm.hpp>", "<limits>", '"shared/job/facets.h"', '"worker/scene/texture_ref.h"')
    text += "/// The parameters of a Material, each as glTF has it where it is not given.\nstruct MaterialParameters {\n"
    for row in materials.of_material():
        comment = ". ".join(filter(None, (row.meaning, row.note)))
        text += f"    {SCENE_TYPES.get(row.type, row.type)} {row.name}{{{literal(row)}}};  // {comment}\n"
    return text + "};\n" + FOOTER


def scene_override():
    text = header('"shared/job/appearance.h"', '"worker/scene/scene.h"')
    text += "/// Calls `set` with each parameter and what the job says of it, if anything.\n"
    text += "void setParameters(Material& m, const MaterialOverride& o, auto set) {\n"
    for row in materials.of_jobs():
        for member in row.job if isinstance(row.job, tuple) else (row.name,):
            text += f"    set(m.{member}, o.{job_name(row)});\n"
    return text + "}\n" + FOOTER


def differs(row):
    """Whether the parameter is more than what it is without effect."""
    return {"bool": f"m.{row.name}", "color": f"m.{row.name} != glm::vec3({row.default})"}.get(
        row.type, f"m.{row.name} > {row.default}")


def host():
    text = header('"shaders/gpu_types.h"', '"worker/render/material_needs.h"')
    text += "/// The FEATURE_* that a lit material needs for its parameters alone.\n"
    text += "inline uint64_t parameterFeatures(const Material& m) {\n    uint64_t features = 0;\n"
    for row in materials.of_material():
        if row.needed:
            condition = differs(row) + ("" if row.needed == materials.ALWAYS else f" && {row.needed}")
            text += f"    if ({condition}) features |= gpu::bit(gpu::FEATURE_{row.feature});\n"
    text += "    return features;\n}\n\n/// Parameters as they are; no texture yet.\n"
    text += "inline void packParameters(const Material& m, gpu::MaterialRecord& record) {\n"
    for row in materials.in_record():
        value = "gpu::NO_INDEX" if row.type == "texture" else f"m.{row.name}"
        text += f"    record.{row.name} = {value};\n"
    return text + "}\n" + FOOTER


def point_macro(name, lines):
    return f"#define {name} \\\n" + " \\\n".join(f"    {line}" for line in lines) + "\n"


def reads(rows):
    """A branch for each feature with all that it reads."""
    for feature, group in itertools.groupby(rows, key=lambda row: row.feature):
        values = [f"m.{row.name} = material{row.name[0].upper()}{row.name[1:]}(index);" for row in group]
        yield f"if (has(FEATURE_{feature})) {{ {' '.join(values)} }}"


def material_point():
    """The members of MaterialPoint that are as the record has them. Macros, for GLSL has no base classes."""
    rows = [row for row in materials.of_material() if row.point]
    types = {"float": "float", "color": "vec3"}
    text = HEADER + "// Members of MaterialPoint that are parameters as the record has them, read from that of the `index`.\n"
    text += point_macro("MATERIAL_POINT_PARAMETERS", [f"{types[row.type]} {row.name};" for row in rows])
    text += point_macro("MATERIAL_POINT_DEFAULTS(m)", [f"m.{row.name} = {types[row.type]}({row.default});" for row in rows])
    for side in ("base", "outside"):
        text += point_macro(f"READ_MATERIAL_{side.upper()}(m, index)", list(reads(row for row in rows if row.point == side)))
    return text


FILES = {"job_material.h": job_struct, "job_material_fields.h": job_fields, "scene_material.h": scene_struct,
         "scene_material_override.h": scene_override, "gpu_material_host.h": host, "gpu_material_point.glsl": material_point}
