"""Tileable procedural textures as rows of 8-bit (r, g, b)."""
import math
import random


def to_srgb(linear):
    c = min(max(linear, 0.0), 1.0)
    return round(255 * (12.92 * c if c <= 0.0031308 else 1.055 * c ** (1 / 2.4) - 0.055))


def byte(value):
    return min(255, max(0, round(255 * value)))


class Noise:
    """Value noise with period 1 in both directions."""

    def __init__(self, seed):
        self.rng, self.lattices = random.Random(seed), {}

    def _octave(self, u, v, nu, nv):
        if (nu, nv) not in self.lattices:
            self.lattices[nu, nv] = [self.rng.random() for _ in range(nu * nv)]
        lattice = self.lattices[nu, nv]
        x, y = u % 1.0 * nu, v % 1.0 * nv
        i, j = int(x), int(y)
        fx, fy = x - i, y - j
        fx, fy = fx * fx * (3 - 2 * fx), fy * fy * (3 - 2 * fy)
        i0, i1, j0, j1 = i % nu, (i + 1) % nu, j % nv, (j + 1) % nv
        a = lattice[j0 * nu + i0] * (1 - fx) + lattice[j0 * nu + i1] * fx
        b = lattice[j1 * nu + i0] * (1 - fx) + lattice[j1 * nu + i1] * fx
        return a * (1 - fy) + b * fy

    def __call__(self, u, v, nu, nv, octaves):
        """In [0, 1], finest detail nu * 2^(octaves - 1) cells across."""
        total = weight = 0.0
        for k in range(octaves):
            total += self._octave(u, v, nu << k, nv << k) * 0.5**k
            weight += 0.5**k
        return total / weight


def normal_map(size, height, strength):
    """From a tileable height field height[y][x]; `strength` in texels of height."""
    width = len(height[0])
    rows = []
    for y in range(size):
        row = []
        for x in range(width):
            dx = (height[y][(x + 1) % width] - height[y][x - 1]) / 2 * strength
            # Rows run down the image while v of the tangent frame runs up it.
            dy = (height[(y + 1) % size][x] - height[y - 1][x]) / 2 * strength
            n = 1 / math.sqrt(dx * dx + dy * dy + 1)
            row.append((byte(0.5 - 0.5 * dx * n), byte(0.5 + 0.5 * dy * n), byte(0.5 + 0.5 * n)))
        rows.append(row)
    return rows


def terrazzo(size, seed, binder, chips, strip):
    """Stone chips in a binder, one slab to a tile with metal strips along its edges.

    Returns base colour, occlusion-roughness-metallic and height. `chips` lists (colour, share).
    """
    rng, noise = random.Random(seed), Noise(seed + 1)
    placed, stones = [], []
    for radius, count in ((0.052, 30), (0.034, 80), (0.021, 240), (0.012, 480), (0.007, 700)):
        for _ in range(count * 12):
            if count == 0: break
            x, y, r = rng.random(), rng.random(), radius * rng.uniform(0.72, 1.15)
            close = any((d := abs(x - px)) is not None and
                        min(d, 1 - d) ** 2 + min(abs(y - py), 1 - abs(y - py)) ** 2 < (0.93 * (r + pr)) ** 2
                        for px, py, pr in placed)
            if close: continue
            count -= 1
            placed.append((x, y, r))
            sides = rng.randint(5, 8)
            turn = rng.random() * 2 * math.pi
            edges = []
            for k in range(sides):  # half planes: direction and distance of each cut
                a = turn + 2 * math.pi * (k + rng.uniform(-0.28, 0.28)) / sides
                edges.append((math.cos(a), math.sin(a), r * rng.uniform(0.62, 0.98)))
            color = rng.choices([c for c, _ in chips], [share for _, share in chips])[0]
            shade = rng.uniform(0.82, 1.12)
            stones.append((x, y, r, edges, tuple(c * shade for c in color), rng.uniform(-0.05, 0.05)))

    color = [[binder] * size for _ in range(size)]
    rough = [[0.44] * size for _ in range(size)]
    height = [[0.0] * size for _ in range(size)]
    for x, y, r, edges, stone, gloss in stones:
        reach = int(r * 1.4 * size) + 2
        cx, cy = x * size, y * size
        for py in range(int(cy) - reach, int(cy) + reach + 1):
            for px in range(int(cx) - reach, int(cx) + reach + 1):
                dx, dy = px + 0.5 - cx, py + 0.5 - cy
                inside = min(d * size - (ex * dx + ey * dy) for ex, ey, d in edges)
                if inside <= -0.5: continue
                cover, i, j = min(1.0, inside + 0.5), px % size, py % size
                color[j][i] = tuple(a + (b - a) * cover for a, b in zip(color[j][i], stone))
                rough[j][i] += (0.30 + gloss - rough[j][i]) * cover
                height[j][i] = max(height[j][i], cover)
    metal = [[0.0] * size for _ in range(size)]
    for j in range(size):
        for i in range(size):
            edge = min(i + 0.5, j + 0.5, size - i - 0.5, size - j - 0.5)
            cover = min(1.0, max(0.0, strip - edge + 0.5))
            if cover > 0:
                color[j][i] = tuple(a + (b - a) * cover for a, b in zip(color[j][i], (0.86, 0.62, 0.30)))
                rough[j][i] += (0.32 - rough[j][i]) * cover
                metal[j][i], height[j][i] = cover, height[j][i] * (1 - cover) + 0.6 * cover
            wear = noise(i / size, j / size, 5, 5, 3)
            rough[j][i] += 0.22 * (wear - 0.5) * (1 - metal[j][i])
    base = [[tuple(to_srgb(c) for c in pixel) for pixel in row] for row in color]
    # Coarse steps of roughness keep the file small and cannot be told from fine ones.
    orm = [[(255, byte(round(max(r, 0.04) * 40) / 40), byte(m)) for r, m in zip(a, b)] for a, b in zip(rough, metal)]
    return base, orm, height


def wood(size, seed, light, dark):
    """Plain-sawn boards: base colour and height. Grain runs along v."""
    noise = Noise(seed)
    color, height = [], []
    for y in range(size):
        v, row, line = y / size, [], []
        for x in range(size):
            u = x / size
            warp = noise(u, v, 3, 1, 3)
            rings = 0.5 + 0.5 * math.sin(2 * math.pi * (7 * u + 2.6 * warp + 0.6 * math.sin(2 * math.pi * v)))
            fibre = noise(u, v, 64, 4, 2)
            t = min(1.0, max(0.0, 0.62 * rings**1.8 + 0.5 * fibre - 0.1))
            row.append(tuple(to_srgb(round((a + (b - a) * t) * 96) / 96) for a, b in zip(light, dark)))
            line.append(1 - t)
        color.append(row)
        height.append(line)
    return color, height


def plaster_height(size, seed):
    noise = Noise(seed)
    return [[noise(x / size, y / size, 6, 6, 5) for x in range(size)] for y in range(size)]


def brushed(width, height, seed):
    """Roughness and height of metal brushed along u."""
    noise = Noise(seed)
    lines = [[noise(x / width, y / height, 2, height // 2, 1) for x in range(width)] for y in range(height)]
    orm = [[(255, byte(round((0.26 + 0.26 * t) * 40) / 40), 255) for t in row] for row in lines]
    return orm, lines
