"""Tessellated solids: y up, counter-clockwise seen from outside, smooth normals and texture coordinates."""
import math

from gltf_writer import Mesh, add, cross, dot, length, normalize, scale, sub


def surface(point, columns, rows, wrap_u=False, wrap_v=False):
    """Grid over point(u, v), u and v in [0, 1], with normals from central differences.

    The outside is where d/du x d/dv points. Seams of wrapped directions repeat their vertices for the
    sake of texture coordinates.
    """
    mesh, h = Mesh(), 1e-4

    def difference(u, v, du, dv):
        if du and not wrap_u: lo, hi = max(0.0, u - du), min(1.0, u + du)
        elif du: lo, hi = u - du, u + du
        if du: return sub(point(hi, v), point(lo, v))
        lo, hi = (v - dv, v + dv) if wrap_v else (max(0.0, v - dv), min(1.0, v + dv))
        return sub(point(u, hi), point(u, lo))

    for j in range(rows + 1):
        for i in range(columns + 1):
            u, v = i / columns, j / rows
            # The last column of a wrapped direction is the first, to the bit.
            at = point(u % 1.0 if wrap_u else u, v % 1.0 if wrap_v else v)
            mesh.vertex(at, cross(difference(u, v, h, 0), difference(u, v, 0, h)), (u, v))
    for j in range(rows):
        for i in range(columns):
            a = j * (columns + 1) + i
            mesh.quad(a, a + 1, a + columns + 2, a + columns + 1)
    return mesh


def lathe(runs, segments, uv_scale=(1.0, 1.0)):
    """Turns a profile around the y axis. `runs` are lists of (radius, y), each smooth in itself and with
    a crease to the next; going along the profile, the outside is on the right (so a cup goes from the
    bottom's middle out and up its outer wall, then down the inner one)."""
    mesh, travelled = Mesh(), 0.0
    for run in runs:
        base, distance = len(mesh.positions), travelled
        for k, (radius, y) in enumerate(run):
            before, after = run[max(k - 1, 0)], run[min(k + 1, len(run) - 1)]
            tangent = (after[0] - before[0], after[1] - before[1])
            if 0 < k < len(run) - 1:  # weigh by the inverse of the distance, as a circle through three points has it
                d0, d1 = math.dist(run[k], before), math.dist(after, run[k])
                tangent = tuple((run[k][c] - before[c]) / d0**2 + (after[c] - run[k][c]) / d1**2 for c in (0, 1))
            if k:
                distance += math.dist(run[k], before)
            # On the axis, a smooth profile has a vertical normal.
            nr, ny = (0.0, math.copysign(1.0, -tangent[0])) if radius == 0 else (tangent[1], -tangent[0])
            for i in range(segments + 1):
                angle = 2 * math.pi * (i % segments) / segments
                c, s = math.cos(angle), math.sin(angle)
                mesh.vertex((radius * c, y, -radius * s), (nr * c, ny, -nr * s),
                            (i / segments * uv_scale[0], distance * uv_scale[1]))
        for k in range(len(run) - 1):
            for i in range(segments):
                a = base + k * (segments + 1) + i
                mesh.quad(a, a + 1, a + segments + 2, a + segments + 1)
        travelled = distance
    return mesh


def arc(center, radius, start_degrees, end_degrees, steps):
    """Points of a circular arc of a profile."""
    angles = [math.radians(start_degrees + (end_degrees - start_degrees) * k / steps) for k in range(steps + 1)]
    return [(round(center[0] + radius * math.cos(a), 7), round(center[1] + radius * math.sin(a), 7)) for a in angles]


def spline(points, steps):
    """Catmull-Rom curve through `points`, `steps` to each stretch."""
    out = []
    for k in range(len(points) - 1):
        p = [points[max(0, min(len(points) - 1, k + d))] for d in (-1, 0, 1, 2)]
        for s in range(steps + (k == len(points) - 2)):
            t = s / steps
            out.append(tuple(0.5 * (2 * p[1][c] + (p[2][c] - p[0][c]) * t +
                                    (2 * p[0][c] - 5 * p[1][c] + 4 * p[2][c] - p[3][c]) * t * t +
                                    (3 * p[1][c] - p[0][c] - 3 * p[2][c] + p[3][c]) * t**3) for c in (0, 1)))
    return out


def sphere(radius, segments=48, rings=24, uv_scale=(1.0, 1.0)):
    profile = [(0.0, -radius)] + arc((0, 0), radius, -90 + 180 / rings, 90 - 180 / rings, rings - 2) + [(0.0, radius)]
    mesh = lathe([profile], segments, uv_scale)
    mesh.normals = [normalize(p) for p in mesh.positions]
    return mesh


def drum(radius, height, bevel, segments=72):
    """Cylinder on y = 0 with rounded rims."""
    return lathe([[(0.0, 0.0), (radius - bevel, 0.0)],
                  arc((radius - bevel, bevel), bevel, -90, 0, 5),
                  [(radius, bevel), (radius, height - bevel)],
                  arc((radius - bevel, height - bevel), bevel, 0, 90, 5),
                  [(radius - bevel, height), (0.0, height)]], segments)


def rounded_box(half, radius, steps=6):
    """Box of half extents `half` around the origin with edges rounded by `radius`."""
    mesh = Mesh()
    core = [h - radius for h in half]
    # Parameters of a face: rounded rim, flat middle, rounded rim.
    rim = [k / steps for k in range(steps + 1)]
    ticks = [(-1, math.tan(math.pi / 4 * (r - 1))) for r in rim] + [(1, math.tan(math.pi / 4 * r)) for r in rim]
    for axis in range(3):
        for side in (-1, 1):
            u_axis, v_axis = (axis + 1) % 3, (axis + 2) % 3
            if side < 0: u_axis, v_axis = v_axis, u_axis
            base = len(mesh.positions)
            for v_side, v in ticks:
                for u_side, u in ticks:
                    normal, corner = [0.0] * 3, [0.0] * 3
                    normal[axis], normal[u_axis], normal[v_axis] = side, u, v
                    corner[axis], corner[u_axis], corner[v_axis] = side * core[axis], u_side * core[u_axis], v_side * core[v_axis]
                    normal = normalize(normal)
                    at = add(corner, scale(normal, radius))
                    mesh.vertex(at, normal, (0.5 + 0.5 * at[u_axis] / half[u_axis], 0.5 + 0.5 * at[v_axis] / half[v_axis]))
            n = len(ticks)
            for j in range(n - 1):
                for i in range(n - 1):
                    a = base + j * n + i
                    mesh.quad(a, a + 1, a + n + 1, a + n)
    return mesh


def torus_knot(p, q, radius, depth, tube, columns, rows):
    """(p, q) knot around the z axis, standing upright. `depth` is how far it swings to either side."""
    def center(t):
        a = 2 * math.pi * t
        r = radius + depth * math.cos(q * a)
        return (r * math.cos(p * a), r * math.sin(p * a), depth * math.sin(q * a))

    def point(u, v):
        at, ahead = center(u), center(u + 1e-3)
        tangent = normalize(sub(ahead, at))
        outward = at[0], at[1], 0.0
        side = normalize(sub(outward, scale(tangent, dot(outward, tangent))))
        other = cross(side, tangent)
        a = 2 * math.pi * v
        return add(at, add(scale(side, tube * math.cos(a)), scale(other, tube * math.sin(a))))

    return surface(point, columns, rows, True, True)


def twisted_column(radius, height, lobes, depth, turns, columns, rows, taper=0.0):
    """Fluted column on y = 0 whose flutes wind around it; capped flat."""
    def outline(angle, v):
        r = (radius - taper * v) * (1 + depth * math.cos(lobes * (angle - 2 * math.pi * turns * v)))
        return (r * math.cos(angle), v * height, -r * math.sin(angle))

    mesh = surface(lambda u, v: outline(2 * math.pi * u, v), columns, rows, wrap_u=True)
    for v, up in ((0.0, -1.0), (1.0, 1.0)):
        middle = mesh.vertex((0, v * height, 0), (0, up, 0), (0.5, 0.5))
        rim = [mesh.vertex(outline(2 * math.pi * (i % columns) / columns, v), (0, up, 0)) for i in range(columns + 1)]
        for a, b in zip(rim, rim[1:]):
            mesh.triangle(middle, *((a, b) if up > 0 else (b, a)))
    return mesh


def faceted(points, faces):
    """Solid with flat faces, each a convex polygon in either direction around a body that holds the origin."""
    mesh = Mesh()
    for face in faces:
        corners = [points[i] for i in face]
        normal = cross(sub(corners[1], corners[0]), sub(corners[2], corners[0]))
        if dot(normal, corners[0]) < 0:
            corners.reverse()
            normal = scale(normal, -1)
        ids = [mesh.vertex(c, normal) for c in corners]
        for k in range(1, len(ids) - 1):
            mesh.triangle(ids[0], ids[k], ids[k + 1])
    return mesh


def gem(radius, sides=8):
    """Brilliant-like cut: table, two rows of crown facets, girdle, two rows of pavilion facets, culet at -y."""
    def ring(r, y, shift):
        return [(radius * r * math.cos(2 * math.pi * (i + shift) / sides), radius * y,
                 radius * r * math.sin(2 * math.pi * (i + shift) / sides)) for i in range(sides)]
    rings = [ring(0.56, 0.42, 0.0), ring(0.86, 0.24, 0.5), ring(1.0, 0.04, 0.0), ring(1.0, -0.04, 0.0), ring(0.55, -0.45, 0.5)]
    points = [p for r in rings for p in r] + [(0.0, -0.86 * radius, 0.0)]
    at = lambda k, i: k * sides + i % sides
    faces = [[at(0, i) for i in range(sides)]]
    for i in range(sides):
        faces += [[at(0, i), at(0, i + 1), at(1, i)], [at(1, i), at(1, i + 1), at(0, i + 1)],
                  [at(1, i), at(2, i), at(2, i + 1)], [at(1, i), at(1, i + 1), at(2, i + 1)],
                  [at(2, i), at(2, i + 1), at(3, i + 1), at(3, i)],
                  [at(3, i), at(3, i + 1), at(4, i)], [at(4, i), at(4, i + 1), at(3, i + 1)],
                  [at(4, i), at(4, i + 1), len(points) - 1]]
    return faceted(points, faces)


def plane(x0, x1, z0, z1, y=0.0, uv_scale=1.0):
    mesh = Mesh()
    ids = [mesh.vertex((x, y, z), (0, 1, 0), (x * uv_scale, z * uv_scale)) for x, z in
           ((x0, z1), (x1, z1), (x1, z0), (x0, z0))]
    mesh.quad(*ids)
    return mesh


def arch_wall(left, right, height, middle, half_opening, spring, thickness, bevel, uv_scale, steps=32):
    """Wall in the plane z = 0 (front at +thickness/2) with a round-arched opening whose edges are rounded."""
    mesh, front = Mesh(), thickness / 2
    # Outline of the opening, left foot to right foot, with the direction into the wall.
    outline = [((middle - half_opening, y), (-1.0, 0.0)) for y in (0.0, spring / 2)]
    for k in range(steps + 1):
        a = math.pi * (1 - k / steps)
        n = (math.cos(a), math.sin(a))
        outline.append(((middle + half_opening * n[0], spring + half_opening * n[1]), n))
    outline += [((middle + half_opening, y), (1.0, 0.0)) for y in (spring / 2, 0.0)]
    # Reveal with rounded edges: one strip from the front edge to the back one.
    section = [(1 - math.cos(a), front - bevel + bevel * math.sin(a), math.cos(a), math.sin(a))
               for a in (math.pi / 2 * (1 - k / 5) for k in range(6))]
    section += [(s, -z, c, -n) for s, z, c, n in reversed(section)]
    base, along, previous = 0, 0.0, outline[0][0]
    for p, n in outline:
        along, previous = along + math.dist(p, previous), p
        for inset, z, c, s in section:
            mesh.vertex((p[0] + n[0] * bevel * inset, p[1] + n[1] * bevel * inset, z),
                        (-n[0] * c, -n[1] * c, s), (z * uv_scale, along * uv_scale))
    w = len(section)
    for k in range(len(outline) - 1):
        for i in range(w - 1):
            a = base + k * w + i
            mesh.quad(a, a + 1, a + w + 1, a + w)
    # Faces: slabs beside the opening, and a column of wall above every step of the arch.
    rim = [(p[0] + n[0] * bevel, p[1] + n[1] * bevel) for p, n in outline]
    for z, side in ((front, 1.0), (-front, -1.0)):
        def face(*corners):
            ids = [mesh.vertex((x, y, z), (0, 0, side), (x * uv_scale, y * uv_scale)) for x, y in corners]
            mesh.quad(*(ids if side > 0 else reversed(ids)))
        for (x0, y0), (x1, y1) in zip(rim, rim[1:]):
            if x1 - x0 > 1e-6:
                face((x0, y0), (x1, y1), (x1, height), (x0, height))
        face((left, 0), (rim[0][0], 0), (rim[0][0], height), (left, height))
        face((rim[-1][0], 0), (right, 0), (right, height), (rim[-1][0], height))
    # Ends and top.
    for x, side in ((left, -1.0), (right, 1.0)):
        ids = [mesh.vertex((x, y, z), (side, 0, 0), (z * uv_scale, y * uv_scale)) for y, z in
               ((0, front), (0, -front), (height, -front), (height, front))]
        mesh.quad(*(ids if side > 0 else reversed(ids)))
    ids = [mesh.vertex((x, height, z), (0, 1, 0), (x * uv_scale, z * uv_scale)) for x, z in
           ((left, front), (right, front), (right, -front), (left, -front))]
    mesh.quad(*ids)
    return mesh
