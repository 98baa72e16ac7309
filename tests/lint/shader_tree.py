"""GLSL as a tree: glslang's own, read from what `glslangValidator -i` prints.

It is the tree that SPIR-V is written from, after glslang has spread `precise` over everything that a precise value is
computed from in the same function; what came out precise has `noContraction` in its type.
"""
import re
import subprocess
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

STAGES = {".comp": "comp", ".vert": "vert", ".frag": "frag"}
_LINE = re.compile(r"^\d+:(\d+|\? )((?:  )*)(\S.*)$")
_MARKER = re.compile(r'^#line (\d+)(?: "(.*)")?$')


@dataclass
class Node:
    text: str  # without its type
    type: str  # as glslang prints it, without parentheses
    line: int  # of the preprocessed source; 0: none
    children: list = field(default_factory=list)

    @property
    def precise(self):
        return "noContraction" in self.type

    @property
    def is_float(self):
        return re.search(r"\b(float|double)\b", self.type) is not None

    def walk(self):
        yield self
        for child in self.children:
            yield from child.walk()

    def same_as(self, other):
        """Reads the same: the same operations on the same names and numbers."""
        return (self.text == other.text and len(self.children) == len(other.children)
                and all(a.same_as(b) for a, b in zip(self.children, other.children)))


@dataclass
class Shader:
    functions: dict  # name with signature -> Node
    places: list  # of line i of the preprocessed source, from 0: (file, line there)
    source: list  # lines of the preprocessed source


def _run(*command):
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:  # what else it prints is the tree
        errors = [line for line in (done.stdout + done.stderr).splitlines() if "ERROR" in line]
        raise RuntimeError("\n".join([" ".join(map(str, command)), *errors]))
    return done.stdout


def _flat(preprocessed):
    """Without #line, and where each line comes from: the tree names no files."""
    lines, places, file, number = [], [], "", 1
    for line in preprocessed.splitlines():
        marker = _MARKER.match(line)
        if marker:
            number, file = int(marker[1]) - 1, marker[2] or file
            line = ""
        lines.append(line)
        places.append((file, number))
        number += 1
    return lines, places


def _split(text):
    """'add ( temp float)' -> 'add', 'temp float'."""
    at = text.find(" (")
    return (text, "") if at < 0 else (text[:at], text[at + 2:].rstrip(")").strip())


def _tree(dump):
    root = Node("root", "", 0)
    open_nodes = [(-1, root)]
    for text in dump.splitlines():
        match = _LINE.match(text)
        if not match:
            continue
        depth = len(match[2]) // 2
        node = Node(*_split(match[3]), int(match[1]) if match[1].isdigit() else 0)
        while open_nodes[-1][0] >= depth:
            open_nodes.pop()
        open_nodes[-1][1].children.append(node)
        open_nodes.append((depth, node))
    return root


def read_shader(path, include=()):
    """Throws RuntimeError with glslang's words where the file does not compile."""
    path, folders = Path(path), [f"-I{folder}" for folder in include]
    lines, places = _flat(_run("glslangValidator", "-E", *folders, path))
    places = [(file or str(path), number) for file, number in places]
    with tempfile.TemporaryDirectory() as folder:
        flat = Path(folder) / ("flat" + path.suffix)
        flat.write_text("\n".join(lines) + "\n")
        dump = _run("glslangValidator", "-i", "-V", "--target-env", "vulkan1.2", "-S", STAGES[path.suffix], flat, "-o",
                    Path(folder) / "spirv")
    # The tree comes twice, the second time for the linked program.
    root = _tree(dump[:dump.find("\nLinked ")])
    functions = {node.text.removeprefix("Function Definition: "): node
                 for node in root.walk() if node.text.startswith("Function Definition: ")}
    return Shader(functions, places, lines)
