"""What generate.py writes of the table of lights."""

import lights

HEADER = "// Written by shaders/tables/generate.py from lights.py: edit that.\n"


def kinds():
    return [kind for row in lights.LIGHTS for kind in row.kinds]


def constants():
    return HEADER + "".join(f"GPU_CONSTANT LIGHT_{kind} = {i};\n" for i, kind in enumerate(kinds()))


def when(row):
    types = " || ".join(f"light.type == LIGHT_{kind}" for kind in row.kinds)
    return f"if (has(FEATURE_{row.feature}) && {types if len(row.kinds) == 1 else f'({types})'}) "


def cases(name, statements):
    """A macro, for a call would make kernels larger."""
    return f"#define {name} \\\n" + " \\\n".join(f"    {line}" for line in statements) + "\n"


def features(rows):
    return "(" + " | ".join(f"featureBit(FEATURE_{row.feature})" for row in rows) + ")"


def glsl():
    met = [row for row in lights.LIGHTS if row.pdf]
    text = HEADER + "".join(f'#include "lights/{row.file}"\n' for row in sorted(lights.LIGHTS, key=lambda row: row.file))
    text += f"\n#define LIGHT_FEATURES {features(lights.LIGHTS)}\n#define EMITTER_FEATURES {features(met)}\n"
    # The last needs no question for its type: nothing else is left.
    *rows, last = lights.LIGHTS
    text += cases("SAMPLE_LIGHT", [f"{when(row)}return {row.sample};" for row in rows] +
                  [f"if (has(FEATURE_{last.feature})) return {last.sample};"])
    first, *others = met
    text += cases("LIGHT_PDF", [f"{when(row)}return {row.pdf};" for row in others] + [f"return {first.pdf};"])
    # What it leaves is for the statement behind it.
    text += cases("CENTRE_OF_LIGHT(found)", [f"{when(row)}found = {row.centre}; else" for row in lights.LIGHTS if row.centre])
    return text


def packers():
    names = [row.packer for row in lights.LIGHTS if row.packer]
    text = "#pragma once\n" + HEADER + '\n#include "worker/render/lights/light_list.h"\n\nnamespace tilefarm {\n\n'
    text += "".join(f"bool {name}(const EmissiveShape& shape, LightList& lights, PackedLights& packed);\n" for name in names)
    text += "\n/// In the order in which a shape is offered to them. Each says whether it takes it.\n"
    return text + f"constexpr decltype(&{names[0]}) kShapeLights[]{{{', '.join(names)}}};\n\n}}  // namespace tilefarm\n"


FILES = {"gpu_light_kinds.h": constants, "gpu_lights.glsl": glsl, "gpu_light_packers.h": packers}
