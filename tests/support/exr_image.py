"""Reads scanline OpenEXR files (uncompressed, ZIPS or ZIP; float and half) with Python's standard library alone: what
tilefarm and Blender write. Layout: openexr.com, "OpenEXR File Layout"."""
import array
import itertools
import pathlib
import struct
import sys
import zlib

_ROWS_OF = {0: 1, 2: 1, 3: 16}  # compression -> scanlines per block: none, ZIPS, ZIP
_TYPES = {1: ("e", 2), 2: ("f", 4)}


class Exr:
    """Planes of one picture: `planes[name]` is an array of width * height floats, top row first. `attributes[name]` are
    the bytes of a header entry."""

    def __init__(self, path):
        self.path, data = pathlib.Path(path), pathlib.Path(path).read_bytes()
        if data[:4] != b"\x76\x2f\x31\x01" or data[5] & 0x1A:
            raise ValueError(f"{path}: not an EXR of one scanline part")
        attributes, at = self._header(data)
        self.attributes = attributes
        compression = attributes["compression"][0]
        if compression not in _ROWS_OF:
            raise ValueError(f"{path}: compression {compression} is not read here")
        x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"])
        self.width, self.height = x1 - x0 + 1, y1 - y0 + 1
        channels = self._channels(attributes["channels"])
        self.planes = {name: array.array("f") for name, _ in channels}
        row_bytes = sum(_TYPES[kind][1] for _, kind in channels) * self.width
        rows = _ROWS_OF[compression]
        blocks = (self.height + rows - 1) // rows
        found = []
        for offset in struct.unpack_from(f"<{blocks}Q", data, at):
            y, size = struct.unpack_from("<ii", data, offset)
            wanted = min(rows, y1 + 1 - y) * row_bytes
            found.append((y, _unpacked(data[offset + 8:offset + 8 + size], wanted, compression)))
        for _, raw in sorted(found, key=lambda block: block[0]):
            self._append(raw, channels, row_bytes)

    @staticmethod
    def _header(data):
        attributes, at = {}, 8
        while data[at]:
            name_end = data.index(0, at)
            type_end = data.index(0, name_end + 1)
            size, = struct.unpack_from("<i", data, type_end + 1)
            attributes[data[at:name_end].decode()] = data[type_end + 5:type_end + 5 + size]
            at = type_end + 5 + size
        return attributes, at + 1

    @staticmethod
    def _channels(text):
        channels, at = [], 0
        while text[at]:
            end = text.index(0, at)
            kind, = struct.unpack_from("<i", text, end + 1)
            channels.append((text[at:end].decode(), kind))
            at = end + 17
        return channels

    def _append(self, raw, channels, row_bytes):
        for start in range(0, len(raw), row_bytes):
            for name, kind in channels:
                code, size = _TYPES[kind]
                self.planes[name].extend(struct.unpack_from(f"<{self.width}{code}", raw, start))
                start += size * self.width

    def mean(self, name, x0=0, y0=0, x1=None, y1=None):
        """Mean of a plane over the pixels [x0, x1) x [y0, y1)."""
        x1, y1 = self.width if x1 is None else x1, self.height if y1 is None else y1
        plane = self.planes[name]
        total = sum(sum(plane[y * self.width + x0:y * self.width + x1]) for y in range(y0, y1))
        return total / ((x1 - x0) * (y1 - y0))


def _unpacked(block, wanted, compression):
    if compression == 0 or len(block) == wanted:  # blocks that would grow are stored as they are
        return block
    data = bytearray(zlib.decompress(block))
    # Differences of neighbours, offset by 128, with the even bytes in the first half and the odd in the second.
    data = bytes(b & 255 for b in itertools.accumulate(data, lambda a, b: a + b - 128))
    out, half = bytearray(wanted), (wanted + 1) // 2
    out[0::2], out[1::2] = data[:half], data[half:]
    return bytes(out)


if __name__ == "__main__":
    for name in sys.argv[1:]:
        picture = Exr(name)
        print(name, picture.width, picture.height, {c: round(picture.mean(c), 6) for c in picture.planes})
