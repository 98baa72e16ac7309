#!/usr/bin/env python3
"""Writes what follows from the tables of this folder.

    generate.py gpu FOLDER     gpu_features.h, gpu_records.h (host and shaders), gpu_readers.glsl, gpu_tables_host.h and
                               what light_text.py and material_text.py make of lights and materials
    generate.py effects        the table of docs/effects.md, to standard output
"""

import os
import pathlib
import sys

sys.dont_write_bytecode = True
import features       # noqa: E402
import light_text     # noqa: E402
import lights         # noqa: E402
import material_text  # noqa: E402
import materials      # noqa: E402
import records        # noqa: E402

WIDTH = {"float": 1, "uint": 1, "vec2": 2, "vec3": 3}
HEADER = "// Written by shaders/tables/generate.py from {}: edit that.\n"


def comment(text, indent=""):
    return "".join(f"{indent}// {line}\n" for line in text.splitlines())


def placed(record):
    """(member, texel, first component); no member may lie across two texels."""
    at = 0
    for member in record.members:
        width = WIDTH[member.type]
        if at % 4 + width > 4:
            sys.exit(f"records.py: {record.name}.{member.name} lies across two texels")
        yield member, at // 4, at % 4
        at += width
    if at % 4:
        sys.exit(f"records.py: {record.name} does not fill its last texel")


def texels_of(record):
    return sum(WIDTH[m.type] for m in record.members) // 4


def feature_constants():
    text = HEADER.format("features.py")
    for bit, f in enumerate(features.FEATURES):
        text += f"GPU_CONSTANT FEATURE_{f.id} = {bit};  // {f.meaning}\n"
    text += f"GPU_CONSTANT FEATURE_COUNT = {len(features.FEATURES)};\n"
    for bit, (name, meaning) in enumerate(features.DEBUGGING, len(features.FEATURES)):
        text += f"GPU_CONSTANT FEATURE_{name} = {bit};  // {meaning}\n"
    if len(features.FEATURES) + len(features.DEBUGGING) > 64:
        sys.exit("features.py: the masks of features hold 64")
    return text


def record_structs():
    text = HEADER.format("records.py")
    for record in records.RECORDS:
        text += f"\nGPU_CONSTANT {record.texels} = {texels_of(record)};\n" + comment(record.meaning)
        text += f"struct {record.name} {{\n"
        for member in record.members:
            meaning = f"  // {member.meaning}" if member.meaning else ""
            text += f"    {member.type} {member.name};{meaning}\n"
        text += "};\n#ifdef __cplusplus\n"
        text += f"static_assert(sizeof({record.name}) == 16 * {record.texels});\n#endif\n"
    return text


def component(member, source, first):
    swizzle = "xyzw"[first:first + WIDTH[member.type]]
    value = f"{source}.{swizzle}" if WIDTH[member.type] < 4 else source
    return value if member.type == "uint" else f"uintBitsToFloat({value})"


def reader_name(record, member):
    return record.prefix + member.name[0].upper() + member.name[1:]


def member_readers(record):
    text = "\n"
    for member, texel, first in placed(record):
        if not member.name.startswith("unused"):
            at = f"LOAD({record.buffer}, index * {record.texels} + {texel}u)"
            text += f"{member.type} {reader_name(record, member)}(uint index) "
            text += f"{{ return {component(member, at, first)}; }}\n"
    return text


def whole_readers(record):
    count = texels_of(record)
    parameters = ", ".join(f"uvec4 t{i}" for i in range(count))
    members = ",\n        ".join(component(m, f"t{t}", c) for m, t, c in placed(record))
    text = f"\n{record.name} unpack{record.name}({parameters}) {{\n    return {record.name}(\n        {members});\n}}\n"
    if record.buffer:
        loads = ",\n        ".join(f"LOAD({record.buffer}, index * {record.texels} + {i}u)" for i in range(count))
        text += f"{record.name} load{record.name}(uint index) {{\n    return unpack{record.name}(\n        {loads});\n}}\n"
    return text


def readers():
    text = HEADER.format("records.py") + "#ifndef GPU_READERS_GLSL\n#define GPU_READERS_GLSL\n"
    for record in records.RECORDS:
        text += member_readers(record) if record.prefix else whole_readers(record)
    return text + "\n#endif\n"


def host_tables():
    text = "#pragma once\n" + HEADER.format("features.py and records.py")
    text += "#include <array>\n#include <string_view>\n\n#include \"shaders/gpu_types.h\"\n\nnamespace tilefarm::gpu {\n\n"
    text += "inline constexpr std::array<std::string_view, FEATURE_COUNT> kFeatureNames{\n"
    text += "".join(f'    "{f.name}",\n' for f in features.FEATURES) + "};\n\n"
    for group in ("camera", "surface", "lighting", "tracing", "path", "estimator"):
        ids = [f.id for f in features.FEATURES if f.shown_by == group]
        if group == "estimator":
            ids += [name for name, _ in features.DEBUGGING]
        bits = " |\n    ".join(f"bit(FEATURE_{i})" for i in ids)
        text += f"inline constexpr uint64_t k{group.capitalize()}Features =\n    {bits};\n"
    text += "\n/// What the code of a feature reads becomes neutral where `lacks(FEATURE_*)`.\n"
    text += "void neutraliseMembers(MaterialRecord& record, auto lacks) {\n"
    for member in records.MATERIAL.members:
        if member.feature:
            text += f"    if (lacks(FEATURE_{member.feature})) record.{member.name} = {member.neutral};\n"
    return text + "}\n\n}  // namespace tilefarm::gpu\n"


def effects_table():
    text = "| effect | what is compiled in | asked for by | shown by |\n|---|---|---|---|\n"
    shown = {"camera": "all integrators", "surface": "all integrators", "lighting": "path, whitted, raster",
             "tracing": "path, whitted", "path": "path", "estimator": "path (an estimator)"}
    for f in features.FEATURES:
        text += f"| {f.name} | {f.meaning} | {f.asked_by} | {shown[f.shown_by]} |\n"
    return text


def check_materials():
    for rows in (materials.of_material(), materials.of_jobs()):
        names = [row.name for row in rows]
        if len(set(names)) < len(names):
            sys.exit("materials.py: a parameter is there twice")
    for row in materials.PARAMETERS:
        if (row.needed or row.point) and not row.feature:
            sys.exit(f"materials.py: {row.name} names no feature")
        if row.point and row not in materials.in_record():
            sys.exit(f"materials.py: {row.name} is not in TEXELS")


def check_lights(known):
    kinds = light_text.kinds()
    if len(set(kinds)) < len(kinds):
        sys.exit("lights.py: a kind is there twice")
    for row in lights.LIGHTS:
        if row.feature not in known:
            sys.exit(f"lights.py: {row.file}: there is no feature {row.feature}")


def check():
    check_materials()
    known = {f.id for f in features.FEATURES}
    if len(known) < len(features.FEATURES) or len({f.name for f in features.FEATURES}) < len(features.FEATURES):
        sys.exit("features.py: an id or a name is there twice")
    check_lights(known)
    for record in records.RECORDS:
        for member in record.members:
            if member.feature and member.feature not in known:
                sys.exit(f"records.py: {record.name}.{member.name}: there is no feature {member.feature}")


def write(folder, name, text):
    """Leaves a file alone that has that text, so that nothing is compiled again for it."""
    path = pathlib.Path(folder, name)
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")


FILES = {"gpu_features.h": feature_constants, "gpu_records.h": record_structs, "gpu_readers.glsl": readers,
         "gpu_tables_host.h": host_tables, **light_text.FILES,
         **material_text.FILES}


def main():
    check()
    if sys.argv[1:] == ["effects"]:
        sys.stdout.write(effects_table())
    elif len(sys.argv) == 3 and sys.argv[1] == "gpu":
        os.makedirs(sys.argv[2], exist_ok=True)
        for name, make in FILES.items():
            write(sys.argv[2], name, make())
    else:
        sys.exit(__doc__.strip())


if __name__ == "__main__":
    main()
