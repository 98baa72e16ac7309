#!/usr/bin/env python3
"""Shows which functions make a scene's kernel large.

Drivers copy a function to each of its calls, so that a kernel is as large as its functions times their calls, and so is the
time to compile it. For the features that a render has used this lists how many SPIR-V instructions each function comes to in
all its copies:

    build/release/bin/tilefarm-worker render SCENE -o picture.exr --report report.json
    python3 tests/bench/kernel_size.py report.json

It needs spirv-opt and spirv-dis (Debian: spirv-tools). Instructions are counted before inlining: what only the driver finds
to be dead behind a call is counted too.
"""
import argparse
import collections
import json
import pathlib
import re
import struct
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
# --set-spec-const-default-value takes SpecIds; see SPEC_FEATURES and SPEC_FEATURES_HIGH in shaders/gpu_types.h.
LOW_BITS, HIGH_BITS = 0, 3
PASSES = ["--freeze-spec-const", "--fold-spec-const-op-composite", "--unify-const", "--eliminate-dead-branches", "--ccp",
          "--eliminate-dead-branches", "--eliminate-dead-functions", "--eliminate-dead-code-aggressive",
          "--eliminate-dead-functions"]


def feature_bits(report, shaders):
    """The bits of the features that a report names."""
    table = (shaders / "tables" / "gpu_tables_host.h").read_text()
    names = re.findall(r'"([^"]+)"', table.split("kFeatureNames", 1)[1].split("};", 1)[0])
    return sum(1 << names.index(name) for name in report["features"]["used"])


def disassembly(kernel, bits, shaders):
    """The kernel, specialised, as text."""
    words = [int(word, 16) for word in re.findall(r"0x[0-9a-fA-F]{8}", (shaders / "spirv" / f"{kernel}.h").read_text())]
    with tempfile.TemporaryDirectory() as folder:
        whole, special = pathlib.Path(folder, "whole.spv"), pathlib.Path(folder, "special.spv")
        whole.write_bytes(struct.pack(f"<{len(words)}I", *words))
        constants = f"{LOW_BITS}:{bits & 0xFFFFFFFF} {HIGH_BITS}:{bits >> 32}"
        subprocess.run(["spirv-opt", "--set-spec-const-default-value", constants, *PASSES, whole, "-o", special], check=True)
        return subprocess.run(["spirv-dis", special], check=True, stdout=subprocess.PIPE, text=True).stdout


class Module:
    """Functions of a module: their own instructions, their calls, and both multiplied out."""

    def __init__(self, text):
        self.own, self.calls = collections.Counter(), collections.defaultdict(collections.Counter)
        self.entry, function = None, None
        for line in map(str.strip, text.splitlines()):
            if match := re.match(r"OpEntryPoint \w+ (%\w+)", line):
                self.entry = match[1]
            elif match := re.match(r"(%\w+) = OpFunction ", line):
                function = match[1]
            elif line == "OpFunctionEnd":
                function = None
            elif function:
                self.own[function] += 1
                if match := re.search(r"OpFunctionCall %\w+ (%\w+)", line):
                    self.calls[function][match[1]] += 1
        self.order = []  # callees before callers
        self._visit(self.entry, set())
        self.size = {}
        for name in self.order:
            self.size[name] = self.own[name] + sum(count * self.size[callee] for callee, count in self.calls[name].items())
        self.copies = collections.Counter({self.entry: 1})
        for name in reversed(self.order):
            for callee, count in self.calls[name].items():
                self.copies[callee] += self.copies[name] * count

    def _visit(self, name, seen):
        if name in seen:
            return
        seen.add(name)
        for callee in self.calls[name]:
            self._visit(callee, seen)
        self.order.append(name)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("report", type=pathlib.Path, help="JSON report of tilefarm-worker render")
    parser.add_argument("--kernel", default="path_trace.comp", help="file of shaders/ (default: path_trace.comp)")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build" / "release", help="build folder")
    parser.add_argument("--rows", type=int, default=30, help="functions to list (default: 30)")
    options = parser.parse_args()

    shaders = options.build / "shaders"
    bits = feature_bits(json.loads(options.report.read_text()), shaders)
    module = Module(disassembly(options.kernel, bits, shaders))
    own = sum(module.own[name] for name in module.order)
    print(f"{module.size[module.entry]} instructions with every copy, {own} without")
    print(f"{'in copies':>10} {'copies':>7} {'each':>7}  function")
    largest = sorted(module.order, key=lambda name: -(module.copies[name] - 1) * module.size[name])
    for name in largest[:options.rows]:
        readable = name[1:].split("_", 1)[0]
        print(f"{module.copies[name] * module.size[name]:10} {module.copies[name]:7} {module.size[name]:7}  {readable}")


if __name__ == "__main__":
    main()
