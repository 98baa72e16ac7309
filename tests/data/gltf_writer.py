"""Writes glTF 2.0, PNG and Radiance HDR with the standard library alone, and checks what it writes."""
import base64
import json
import math
import struct
import zlib

FLOAT, USHORT, UINT = 5126, 5123, 5125
ARRAY, ELEMENT = 34962, 34963


class Mesh:
    """Triangles with one normal and one texture coordinate per vertex; counter-clockwise seen from outside."""

    def __init__(self):
        self.positions, self.normals, self.uvs, self.triangles = [], [], [], []

    def vertex(self, position, normal, uv=(0.0, 0.0)):
        length = math.sqrt(sum(c * c for c in normal))
        self.positions.append(tuple(position))
        self.normals.append(tuple(c / length for c in normal))
        self.uvs.append(tuple(uv))
        return len(self.positions) - 1

    def triangle(self, a, b, c):
        """Leaves out triangles without area, as where a lathe meets its axis."""
        if length(cross(sub(self.positions[b], self.positions[a]), sub(self.positions[c], self.positions[a]))) > 1e-10:
            self.triangles.append((a, b, c))

    def quad(self, a, b, c, d):
        self.triangle(a, b, c)
        self.triangle(a, c, d)

    def append(self, other, offset=(0.0, 0.0, 0.0)):
        base = len(self.positions)
        self.positions += [add(p, offset) for p in other.positions]
        self.normals += other.normals
        self.uvs += other.uvs
        self.triangles += [(a + base, b + base, c + base) for a, b, c in other.triangles]
        return self


def add(a, b): return tuple(x + y for x, y in zip(a, b))
def sub(a, b): return tuple(x - y for x, y in zip(a, b))
def scale(a, s): return tuple(x * s for x in a)
def dot(a, b): return sum(x * y for x, y in zip(a, b))
def length(a): return math.sqrt(dot(a, a))
def normalize(a): return scale(a, 1 / length(a))
def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def quaternion(axis, degrees):
    half = math.radians(degrees) / 2
    return [round(c * math.sin(half), 7) for c in normalize(axis)] + [round(math.cos(half), 7)]


def look_at(eye, target):
    """Node matrix (column major) of a camera at `eye` that sees `target`, y up."""
    back = normalize(sub(eye, target))
    right = normalize(cross((0, 1, 0), back))
    up = cross(back, right)
    return [round(c, 7) for c in (*right, 0, *up, 0, *back, 0, *eye, 1)]


def check_mesh(mesh, name, solid=False):
    """Raises AssertionError where a mesh is not what a renderer may expect; `solid` also asks that it is closed."""
    assert mesh.triangles, f"{name}: empty"
    for normal in mesh.normals:
        assert abs(length(normal) - 1) < 1e-5, f"{name}: normal of length {length(normal)}"
    edges, volume = {}, 0.0
    welded = [tuple(round(c, 5) + 0.0 for c in p) for p in mesh.positions]
    for triangle in mesh.triangles:
        a, b, c = (mesh.positions[i] for i in triangle)
        face = cross(sub(b, a), sub(c, a))
        for i in triangle:
            assert dot(face, mesh.normals[i]) > -1e-9, f"{name}: triangle {triangle} is wound against its normals"
        volume += dot(a, cross(b, c)) / 6
        for i, j in zip(triangle, triangle[1:] + triangle[:1]):
            edges[welded[i], welded[j]] = edges.get((welded[i], welded[j]), 0) + 1
    if solid:
        open_edges = [e for e, count in edges.items() if count != edges.get((e[1], e[0]), 0)]
        assert not open_edges, f"{name}: {len(open_edges)} open edges, as {open_edges[0]}"
        assert volume > 0, f"{name}: inside out, volume {volume}"


class Gltf:
    """A glTF asset under construction: everything goes into one buffer."""

    def __init__(self, generator):
        self.buffer = bytearray()
        self.json = {
            "asset": {"version": "2.0", "generator": generator}, "scene": 0, "scenes": [{"nodes": []}],
            "nodes": [], "meshes": [], "accessors": [], "bufferViews": [], "materials": [],
        }
        self.triangle_count = 0

    def _push(self, key, value):
        self.json.setdefault(key, []).append(value)
        return len(self.json[key]) - 1

    def _view(self, data, **more):
        while len(self.buffer) % 4:
            self.buffer.append(0)
        view = {"buffer": 0, "byteOffset": len(self.buffer), "byteLength": len(data), **more}
        self.buffer += data
        return self._push("bufferViews", view)

    def _accessor(self, rows, kind, component, target, bounds=False):
        flat = [c for row in rows for c in row] if kind != "SCALAR" else rows
        code = {FLOAT: "f", USHORT: "H", UINT: "I"}[component]
        data = struct.pack(f"<{len(flat)}{code}", *flat)
        accessor = {"bufferView": self._view(data, target=target), "componentType": component,
                    "count": len(rows), "type": kind}
        if bounds:  # exactly those of the stored 32-bit values
            stored = [struct.unpack("<3f", struct.pack("<3f", *row)) for row in rows]
            accessor["min"] = [min(row[i] for row in stored) for i in range(3)]
            accessor["max"] = [max(row[i] for row in stored) for i in range(3)]
        return self._push("accessors", accessor)

    def image(self, name, png):
        return self._push("images", {"name": name, "mimeType": "image/png", "bufferView": self._view(png)})

    def texture(self, image):
        if "samplers" not in self.json:
            self._push("samplers", {"magFilter": 9729, "minFilter": 9987, "wrapS": 10497, "wrapT": 10497})
        return self._push("textures", {"sampler": 0, "source": image})

    def material(self, name, color=(1, 1, 1, 1), metallic=0.0, roughness=1.0, extensions=None, **more):
        material = {"name": name, "pbrMetallicRoughness": {
            "baseColorFactor": list(color) + [1.0] * (4 - len(color)),
            "metallicFactor": metallic, "roughnessFactor": roughness}}
        material["pbrMetallicRoughness"].update(
            {key: more.pop(key) for key in ("baseColorTexture", "metallicRoughnessTexture") if key in more})
        material.update(more)
        if extensions:
            material["extensions"] = extensions
            used = set(self.json.get("extensionsUsed", [])) | set(extensions)
            self.json["extensionsUsed"] = sorted(used)
        return self._push("materials", material)

    def geometry(self, mesh, name, uvs=True, solid=False):
        """Attributes and indices of `mesh`, for any number of primitives."""
        check_mesh(mesh, name, solid)
        component = USHORT if len(mesh.positions) < 65536 else UINT
        attributes = {"POSITION": self._accessor(mesh.positions, "VEC3", FLOAT, ARRAY, bounds=True),
                      "NORMAL": self._accessor(mesh.normals, "VEC3", FLOAT, ARRAY)}
        if uvs:
            attributes["TEXCOORD_0"] = self._accessor(mesh.uvs, "VEC2", FLOAT, ARRAY)
        indices = self._accessor([i for t in mesh.triangles for i in t], "SCALAR", component, ELEMENT)
        return {"attributes": attributes, "indices": indices}, len(mesh.triangles)

    def mesh(self, name, geometry, material):
        primitive, triangles = geometry
        index = self._push("meshes", {"name": name, "primitives": [{**primitive, "material": material}]})
        self.json["meshes"][index].setdefault("extras", {"triangles": triangles})
        return index

    def node(self, name, **more):
        if "mesh" in more:
            self.triangle_count += self.json["meshes"][more["mesh"]]["extras"]["triangles"]
        self.json["scenes"][0]["nodes"].append(self._push("nodes", {"name": name, **more}))

    def camera(self, name, eye, target, yfov_degrees, aspect=None):
        perspective = {"yfov": round(math.radians(yfov_degrees), 7), "znear": 0.01}
        if aspect:
            perspective["aspectRatio"] = aspect
        camera = self._push("cameras", {"name": name, "type": "perspective", "perspective": perspective})
        self.node(name, camera=camera, matrix=look_at(eye, target))

    def _finished(self):
        result = dict(self.json)
        result["meshes"] = [{k: v for k, v in m.items() if k != "extras"} for m in self.json["meshes"]]
        return {key: value for key, value in result.items() if value != []}

    def write_glb(self, path):
        document = self._finished()
        document["buffers"] = [{"byteLength": len(self.buffer)}]
        text = json.dumps(document, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        binary = bytes(self.buffer) + bytes(-len(self.buffer) % 4)
        with open(path, "wb") as file:
            file.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(binary)))
            file.write(struct.pack("<I4s", len(text), b"JSON") + text)
            file.write(struct.pack("<I4s", len(binary), b"BIN\0") + binary)

    def write_gltf(self, path):
        document = self._finished()
        data = base64.b64encode(bytes(self.buffer)).decode()
        document["buffers"] = [{"byteLength": len(self.buffer), "uri": "data:application/octet-stream;base64," + data}]
        with open(path, "w", encoding="utf-8") as file:
            json.dump(document, file, indent=1)
            file.write("\n")


def png(width, height, rows):
    """8-bit PNG; `rows` holds `height` lists of `width` (r, g, b) or (r, g, b, a)."""
    channels = len(rows[0][0])
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    raw, previous = bytearray(), bytes(width * channels)
    for row in rows:
        line = bytes(c for pixel in row for c in pixel)
        # Of the five filters the one with the smallest sum of absolute differences, as libpng's heuristic has it.
        left = bytes(channels) + line[:-channels]
        sub_line = bytes((a - b) & 255 for a, b in zip(line, left))
        up_line = bytes((a - b) & 255 for a, b in zip(line, previous))
        cost = lambda data: sum(min(b, 256 - b) for b in data)
        kind, data = min(((0, line), (1, sub_line), (2, up_line)), key=lambda choice: cost(choice[1]))
        raw += bytes([kind]) + data
        previous = line
    header = struct.pack(">IIBBBBB", width, height, 8, 6 if channels == 4 else 2, 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(bytes(raw), 9)) +
            chunk(b"IEND", b""))


def _rgbe(color):
    peak = max(color)
    if peak < 1e-32:
        return (0, 0, 0, 0)
    mantissa, exponent = math.frexp(peak)
    factor = mantissa * 256 / peak
    return tuple(min(255, int(c * factor)) for c in color) + (exponent + 128,)


def _run_lengths(values):
    out, i = bytearray(), 0
    while i < len(values):
        run = 1
        while run < 127 and i + run < len(values) and values[i + run] == values[i]:
            run += 1
        if run >= 4:
            out += bytes([128 + run, values[i]])
            i += run
            continue
        start = i
        while i < len(values) and i - start < 128 and not (i + 3 < len(values) and len(set(values[i:i + 4])) == 1):
            i += 1
        out += bytes([i - start]) + bytes(values[start:i])
    return bytes(out)


def write_hdr(path, width, height, radiance):
    """Radiance RGBE; `radiance(x, y)` gives linear (r, g, b) of a pixel, top row first."""
    with open(path, "wb") as file:
        file.write(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n" + f"-Y {height} +X {width}\n".encode())
        for y in range(height):
            pixels = [_rgbe(radiance(x, y)) for x in range(width)]
            file.write(bytes([2, 2, width >> 8, width & 255]))
            for channel in range(4):
                file.write(_run_lengths([p[channel] for p in pixels]))
